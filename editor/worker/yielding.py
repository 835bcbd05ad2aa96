"""Working without holding the other threads up: the window goes on drawing meanwhile.

What a worker does in Python, importing and tracing above all, gives way every millisecond, and XLA
compiles without the interpreter. Two things stop every thread at once for 0.1 to 0.4 s: a full
garbage collection, of which both provoke several and which finds next to nothing, and writing a
compiled program to the cache on disk (`editor.worker.simulation.quiet`).
"""

import gc
from collections.abc import Callable
from typing import Final

from kinetix.shared_setting import Meanwhile

_NEVER: Final = 2**30
"""As many collections of the middle generation have to come before a full one."""


def _no_full_collections() -> Callable[[], None]:
    young, middle, old = gc.get_threshold()
    gc.set_threshold(young, middle, _NEVER)

    def undo() -> None:
        # What is left makes up the compiled step: later collections need not walk through it.
        gc.freeze()
        gc.set_threshold(young, middle, old)

    return undo


without_pauses: Final = Meanwhile(_no_full_collections)
"""Leave full collections out; the small ones go on and find what tracing leaves behind."""
