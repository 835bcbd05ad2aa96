"""The collector of garbage, held back while a program is traced and lowered.

Both make hundreds of thousands of objects and next to no garbage; looking for it takes a third of
their time.
"""

import contextlib
import gc
from collections.abc import Iterator


@contextlib.contextmanager
def uncollected() -> Iterator[None]:
    """Collect no garbage meanwhile."""
    before = gc.isenabled()
    gc.disable()
    try:
        yield
    finally:
        if before:
            gc.enable()
