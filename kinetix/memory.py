"""The memory of this process, as the system sees it."""

import contextlib
import ctypes


def give_back_memory() -> None:
    """Return free memory to the system: after compiling it was a quarter of an idle editor.

    Does something where the C library is glibc alone.
    """
    with contextlib.suppress(OSError, AttributeError):
        ctypes.CDLL("libc.so.6").malloc_trim(0)
