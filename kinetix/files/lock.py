"""A folder that one process at a time may write: the system frees it when that process dies."""

import contextlib
import errno
import os
import time
from collections.abc import Iterator
from pathlib import Path
from typing import Final

from kinetix.files.regular import FileError

try:
    import fcntl
except ImportError:  # no POSIX system; folders are not locked there
    fcntl = None

_TAKEN = (errno.EWOULDBLOCK, errno.EAGAIN, errno.EACCES)
_LONGEST_WAIT: Final = 1.0
"""Longest wait for a lock that is held briefly [s]."""
_LOOK_EVERY: Final = 0.005
"""Interval between two tries [s]."""


@contextlib.contextmanager
def held_briefly(folder: Path) -> Iterator[None]:
    """Hold a folder's lock for as long as a small file in it takes to be read and written.

    Others wait for it: a second at most, and not at all if nothing can be locked.
    """
    descriptor = None
    with contextlib.suppress(OSError):
        descriptor = os.open(folder, os.O_RDONLY)
    if descriptor is None:
        yield
        return
    try:
        _wait_for(descriptor)
        yield
    finally:
        os.close(descriptor)


def _wait_for(descriptor: int) -> None:
    if fcntl is None:
        return
    end = time.monotonic() + _LONGEST_WAIT
    while time.monotonic() < end:
        try:
            fcntl.flock(descriptor, fcntl.LOCK_EX | fcntl.LOCK_NB)
        except OSError as error:
            if error.errno not in _TAKEN:
                return
            time.sleep(_LOOK_EVERY)
        else:
            return


@contextlib.contextmanager
def locked_folder(folder: Path, owner: str) -> Iterator[None]:
    """Hold a folder's lock; nothing is left behind in it.

    Where the file system knows no locks (some network drives), nothing is locked.

    Args:
        folder: The folder, which must exist.
        owner: Who else may hold it, for the sentence: "another training".

    Raises:
        FileError: Somebody else holds it, or has removed it.
    """
    if fcntl is None:
        yield
        return
    try:
        descriptor = os.open(folder, os.O_RDONLY)
    except OSError as error:
        raise FileError(folder, f"cannot be locked: {error.strerror or error}") from None
    try:
        try:
            fcntl.flock(descriptor, fcntl.LOCK_EX | fcntl.LOCK_NB)
        except OSError as error:
            if error.errno in _TAKEN:
                raise FileError(
                    folder, f"{owner} writes here now; wait for it, or choose another folder"
                ) from None
        if not _is_at(folder, descriptor):
            raise FileError(folder, f"{owner} has removed this folder just now; try again")
        yield
    finally:
        os.close(descriptor)


def _is_at(folder: Path, descriptor: int) -> bool:
    try:
        return os.path.samestat(os.stat(folder), os.fstat(descriptor))
    except OSError:
        return False
