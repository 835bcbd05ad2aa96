"""Memory, as the system sees it: what is free, and what this process gives back."""

import contextlib
import ctypes
import os
from pathlib import Path


def available_memory(told: Path = Path("/proc/meminfo")) -> int:
    """Return what programs may still take without swapping [bytes].

    If the system does not report it, as on macOS: all memory of the machine.

    Args:
        told: Linux's table of its memory.
    """
    with contextlib.suppress(OSError):
        for line in told.read_text().splitlines():
            if line.startswith("MemAvailable:"):
                return int(line.split()[1]) * 1024
    return os.sysconf("SC_PHYS_PAGES") * os.sysconf("SC_PAGE_SIZE")


def give_back_memory() -> None:
    """Return free memory to the system: after compiling it was a quarter of an idle editor.

    Does something where the C library is glibc alone.
    """
    with contextlib.suppress(OSError, AttributeError):
        ctypes.CDLL("libc.so.6").malloc_trim(0)
