"""Compiled programs that are not needed any more are dropped before there is no room for others.

A program takes hundreds to thousands of memory maps, and Linux gives a process 65 530. Without one
left, LLVM reports that it cannot allocate memory, and a program that is read from the cache
crashes.
"""

import gc
import time
from collections.abc import Callable
from pathlib import Path
from typing import Final

_MOST: Final = 30_000
"""Programs are dropped above this many memory maps (about 60 levels, 2.5 GB)."""
_MORE: Final = 5_000
"""Programs in use cannot be dropped; after this many more maps dropping is tried again."""
_LOOK_SECONDS: Final = 5.0


class ProgramRoom:
    """Looks now and then whether the process has room for programs; costs next to nothing."""

    def __init__(
        self,
        process: Path = Path("/proc/self"),
        clock: Callable[[], float] = time.monotonic,
    ) -> None:
        self._process, self._clock = process, clock
        self._next_look = 0.0
        self._most = _MOST

    def make(self) -> bool:
        """Drop what JAX has compiled where there is hardly any room; True if it was dropped.

        What is needed again is compiled again.
        """
        if self._clock() < self._next_look:
            return False
        self._next_look = self._clock() + _LOOK_SECONDS
        if _maps(self._process) < self._most:
            return False
        _drop()
        self._most = max(_MOST, _maps(self._process) + _MORE)
        return True


make_room: Final = ProgramRoom().make
"""To be called before anything that may compile, as often as one likes."""


def _maps(process: Path) -> int:
    try:
        return (process / "maps").read_bytes().count(b"\n")
    except OSError:
        return 0


def _drop() -> None:
    import jax

    jax.clear_caches()
    gc.collect()
