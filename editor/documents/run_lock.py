"""Locks by which runs of the app know of each other: one of the system, and a heartbeat.

The system releases the lock at the moment a process ends, however it ends. It is only known to the
processes of one running system; of another machine that shares the folder the heartbeat tells.
"""

import contextlib
import os
import threading
import time
from pathlib import Path
from typing import Final, TextIO

try:
    import fcntl
except ImportError:  # not on Windows
    fcntl = None

BEAT: Final = 2.0
"""Interval of the heartbeat [s]."""
SILENCE: Final = 15.0
"""After so long without a beat a run on another system has ended [s]."""
_NAME: Final = "lock"


def _system() -> str:
    """Return a name of the running system, another one after every start of the machine."""
    with contextlib.suppress(OSError):
        return Path("/proc/sys/kernel/random/boot_id").read_text(encoding="ascii").strip()
    return ""


class RunLock:
    """The lock of this run; it holds until the process ends or releases it."""

    def __init__(self, run: Path) -> None:
        """Take the lock.

        Args:
            run: The folder of this run.

        Raises:
            OSError: Nothing can be written there.
        """
        self._path = run / _NAME
        # It gets its name only when it is locked: before, the run would seem to have ended.
        unnamed = run / f"{_NAME}.new"
        self._file: TextIO | None = unnamed.open("w", encoding="ascii")
        self._file.write(_system())
        self._file.flush()
        if fcntl is not None:
            with contextlib.suppress(OSError):  # some network folders know no locks
                fcntl.flock(self._file, fcntl.LOCK_EX)
        os.replace(unnamed, self._path)
        self._released = threading.Event()
        self._heart = threading.Thread(target=self._beat, name="heartbeat", daemon=True)
        self._heart.start()

    @property
    def stands(self) -> bool:
        """True if other runs can see it: nobody has removed its file."""
        return os.path.isfile(self._path)

    def _beat(self) -> None:
        while not self._released.wait(BEAT):
            with contextlib.suppress(OSError):
                os.utime(self._path)

    def release(self) -> None:
        """Let go of it and remove it."""
        self._released.set()
        self._heart.join(1.0)
        if self._file is not None:
            self._file.close()
            self._file = None
        self._path.unlink(missing_ok=True)

    @staticmethod
    def remove(run: Path) -> None:
        """Remove the lock of a run that has ended."""
        for name in (_NAME, f"{_NAME}.new"):
            (run / name).unlink(missing_ok=True)


def goes_on(run: Path) -> bool:
    """Return whether the run of a folder still goes on."""
    try:
        with (run / _NAME).open("r", encoding="ascii", errors="replace") as file:
            here = file.read(100) == _system() != ""
            beaten = time.time() - os.fstat(file.fileno()).st_mtime < SILENCE
            if fcntl is None:
                return beaten
            try:
                fcntl.flock(file, fcntl.LOCK_SH | fcntl.LOCK_NB)
            except BlockingIOError:
                return True
            except OSError:
                return beaten
            return beaten and not here
    except OSError:
        return False
