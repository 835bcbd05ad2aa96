"""Time that a process had to itself: a busy machine is no fault of what is attacked."""

import contextlib
import os
import signal
import time
from collections.abc import Iterator
from pathlib import Path

PATIENCE = 3600.0
"""For waits inside what is attacked, which a clock of this module ends sooner [s]."""
_LOOK_SECONDS = 5


class Hang(BaseException):
    """Something took far too long."""


class OwnClock:
    """Wall-clock time of a process, less what its threads waited for a processor."""

    def __init__(self, process: int | None = None) -> None:
        """Start at zero.

        Args:
            process: Its id; this process by default.
        """
        self._process = process or os.getpid()
        self._began = self._now()

    @property
    def seconds(self) -> float:
        """Time since the clock was made."""
        return self._now() - self._began

    def _now(self) -> float:
        return time.monotonic() - waited(self._process)


def waited(process: int) -> float:
    """Return how long the thread of a process that waited most was kept from a processor [s].

    0 where the system does not say.
    """
    delays = [0.0]
    for path in Path(f"/proc/{process}/task").glob("*/schedstat"):
        with contextlib.suppress(OSError, ValueError, IndexError):  # threads end meanwhile
            delays.append(int(path.read_text().split()[1]) / 1e9)
    return max(delays)


def ended(child: int, seconds: float) -> bool:
    """Wait for a child to end, and tell whether it did so by its own clock; else it is killed."""
    clock = OwnClock(child)
    while not os.waitid(os.P_PID, child, os.WEXITED | os.WNOHANG | os.WNOWAIT):
        if clock.seconds > seconds:
            os.kill(child, signal.SIGKILL)
            return False
        time.sleep(0.002)
    return True


@contextlib.contextmanager
def no_hang(seconds: float) -> Iterator[None]:
    """Raise `Hang` in the main thread when what is inside takes longer by its own clock."""
    clock = OwnClock()

    def look(*_: object) -> None:
        if clock.seconds > seconds:
            raise Hang

    before = signal.signal(signal.SIGALRM, look)
    signal.setitimer(signal.ITIMER_REAL, _LOOK_SECONDS, _LOOK_SECONDS)
    try:
        yield
    finally:
        signal.setitimer(signal.ITIMER_REAL, 0)
        signal.signal(signal.SIGALRM, before)
