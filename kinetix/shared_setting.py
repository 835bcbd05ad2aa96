"""A process-wide setting that several threads change for a while."""

import contextlib
import threading
from collections.abc import Callable, Iterator


class Meanwhile:
    """A change that is applied when the first thread enters and undone when the last leaves."""

    def __init__(self, change: Callable[[], Callable[[], None]]) -> None:
        """Prepare the change without making it.

        Args:
            change: Makes the change, and returns what takes it back.
        """
        self._change = change
        self._lock = threading.Lock()
        self._count = 0
        self._undo: Callable[[], None] = lambda: None

    @contextlib.contextmanager
    def __call__(self) -> Iterator[None]:
        """Have it changed within a `with` block."""
        entered = False
        try:
            with self._lock:
                if self._count == 0:
                    self._undo = self._change()
                self._count += 1
                entered = True
            yield
        finally:
            if entered:
                with self._lock:
                    self._count -= 1
                    if self._count == 0:
                        self._undo()
