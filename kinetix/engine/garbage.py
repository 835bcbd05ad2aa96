"""The collector of garbage, held back while a program is traced and lowered.

Both make hundreds of thousands of objects and next to no garbage; looking for it takes a third of
their time.
"""

import contextlib
import gc
import threading
from collections.abc import Iterator


class _Held:
    """How many threads hold the collector back, and whether it shall go on after the last."""

    def __init__(self) -> None:
        self.lock = threading.Lock()
        self.count = 0
        self.enabled = False


_HELD = _Held()


@contextlib.contextmanager
def uncollected() -> Iterator[None]:
    """Collect no garbage meanwhile: the first thread switches it off, the last one on again."""
    entered = False
    try:
        with _HELD.lock:
            if _HELD.count == 0:
                _HELD.enabled = gc.isenabled()
            _HELD.count += 1
            entered = True
            gc.disable()
        yield
    finally:
        if entered:
            with _HELD.lock:
                _HELD.count -= 1
                if _HELD.count == 0 and _HELD.enabled:
                    gc.enable()
