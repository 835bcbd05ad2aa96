"""Kind of machine that a step is made for: the one place that distinguishes CPU and GPU.

A processor wants few worlds at a time, intermediate results stored once and loops over short
tables. An accelerator wants the whole batch as one program of few and large operations, so there
nothing is tiled, a store is the identity, and tables are looked up at once.
"""

import contextlib
import contextvars
from collections.abc import Iterator
from typing import Final

_WHOLE: Final = contextvars.ContextVar("whole", default=False)


def takes_whole_batches() -> bool:
    """Return whether the code being traced is meant for an accelerator."""
    return _WHOLE.get()


@contextlib.contextmanager
def whole_batches() -> Iterator[None]:
    """Trace the enclosed code for an accelerator, even if it runs on a CPU."""
    token = _WHOLE.set(True)
    try:
        yield
    finally:
        _WHOLE.reset(token)
