"""Saving a file so that it always holds the old or the new content, whatever happens."""

import contextlib
import itertools
import os
import stat
from pathlib import Path
from typing import Final

from kinetix.errors import LevelError

_COUNTER: Final = itertools.count()


def write_atomically(path: Path, data: bytes) -> None:
    """Write a whole file, or leave the old one as it is.

    The bytes go to a new file in the same folder, reach the disk, take over the old file's
    permissions and then its name. A symbolic link keeps pointing to the file that is written.

    Args:
        path: The file; its folder must exist.
        data: Its new content.

    Raises:
        LevelError: The system refused; the sentence has the path and the reason.
    """
    target = Path(os.path.realpath(path))
    temporary = target.with_name(f".{target.name}.{os.getpid()}.{next(_COUNTER)}.tmp")
    try:
        try:
            _write_new(temporary, data)
            if target.exists():
                temporary.chmod(stat.S_IMODE(target.stat().st_mode))
            os.replace(temporary, target)
        except BaseException:
            with contextlib.suppress(OSError):
                temporary.unlink(missing_ok=True)
            raise
    except OSError as error:
        raise LevelError(f"{path}: cannot be saved: {error.strerror or error}") from error
    # The new content has the name by now. Some file systems cannot sync a folder, which makes the
    # change of name a little less durable, but is no failure.
    with contextlib.suppress(OSError):
        _sync_folder(target.parent)


def _write_new(path: Path, data: bytes) -> None:
    descriptor = os.open(path, os.O_WRONLY | os.O_CREAT | os.O_EXCL, 0o666)
    with os.fdopen(descriptor, "wb") as file:
        file.write(data)
        file.flush()
        os.fsync(file.fileno())


def _sync_folder(folder: Path) -> None:
    if os.name != "posix":
        return
    descriptor = os.open(folder, os.O_RDONLY)
    try:
        os.fsync(descriptor)
    finally:
        os.close(descriptor)
