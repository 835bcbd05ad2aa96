"""The one writer of files: a file always holds the old or the new content, whatever happens."""

import contextlib
import errno
import itertools
import os
import secrets
import shutil
import stat
import time
from collections.abc import Iterator
from pathlib import Path
from typing import Final

from kinetix.errors import LevelError
from kinetix.files.names import first_free, shortened

_PREFIX: Final = ".kinetix-"
_ENDING: Final = ".tmp"
_BACKUP: Final = ".bak"
_MOST_LINKS: Final = 40
"""Links that lead to links: systems follow no more."""
_STALE: Final = 3600.0
"""Age at which a temporary file counts as left behind by a run that was killed [s]."""
_SWEPT: Final[set[Path]] = set()
"""Folders that this process has looked through for such files: once, as they may be large."""


def write_atomically(path: Path, data: bytes) -> os.stat_result:
    """Write a whole file, or leave the old one as it is.

    The bytes go to a new file in the same folder, reach the disk, take over the old file's
    permissions and then its name. A symbolic link keeps pointing to the file that is written.

    Args:
        path: The file; its folder must exist.
        data: Its new content.

    Returns:
        The state of the new file before it got its name: no other program has changed it.

    Raises:
        LevelError: The system refused, the old file is read-only, or the path is a device or a
            named pipe; the sentence has the path and the reason.
    """
    with replacing(path) as temporary:
        _write_new(temporary, data)
        return temporary.stat()


def check_target(path: Path) -> None:
    """Refuse what could not be written, before the work whose result it is.

    Args:
        path: The file; its folder may be made later.

    Raises:
        LevelError: See `write_atomically`.
    """
    with _naming(path):
        there = next(filter(os.path.lexists, path.absolute().parents), path)
        if os.path.isfile(there):
            raise OSError(0, f"expected a folder, got the file {there}")
        if not os.path.exists(there):
            raise OSError(0, f"the link {there} leads nowhere")
        target, _ = _regular(path)
        folder = target.parent if os.path.exists(target.parent) else there
        if not os.access(folder, os.W_OK):
            raise OSError(errno.EACCES, os.strerror(errno.EACCES))


def write_with_backup(
    path: Path, data: bytes, *, keep_all: bool = False, backup: Path | None = None
) -> bool:
    """Write a whole file; another content that it had stays beside it as `NAME.bak`.

    Args:
        path: The file; its folder must exist.
        data: Its new content.
        keep_all: Whether an older backup stays too, as `NAME.bak2`, `NAME.bak3` and so on.
        backup: Another file that takes the old content, instead of `NAME.bak`.

    Returns:
        Whether it had another content.

    Raises:
        LevelError: See `write_atomically`; also when the old content cannot be read.
    """
    with _naming(path):
        target, before = _regular(path)
        previous = data if before is None else target.read_bytes()
    if previous != data:
        keep_all = keep_all and backup is None
        backup = backup or backup_of(path)
        told = f"{path}: cannot be saved: its backup {backup.name}"
        with replacing(backup, told=told) as temporary:
            _write_new(temporary, previous)
            if keep_all:
                # Nothing of the older backup is touched before the disk has the new one.
                _sync(temporary, os.O_RDWR)
                _make_room(path, previous)
    write_atomically(path, data)
    return previous != data


def backup_of(path: Path) -> Path:
    """Return the path of a file's backup; a name that would be too long is cut."""
    return _beside(path, _BACKUP)


def free_backup(path: Path) -> Path:
    """Return the first of `NAME.bak2`, `NAME.bak3` and so on that is free."""
    return first_free(_beside(path, f"{_BACKUP}{number}") for number in itertools.count(2))


def _beside(path: Path, ending: str) -> Path:
    return path.with_name(shortened(path.name, ending))


def _make_room(path: Path, data: bytes) -> None:
    """Give an older backup of a file the first free number, unless it holds the same."""
    backup = backup_of(path)
    if not os.path.isfile(backup) or backup.read_bytes() == data:
        return
    # What a link leads to is moved: the new backup takes its place, and the link stays.
    shutil.move(os.path.realpath(backup), free_backup(path))


@contextlib.contextmanager
def replacing(path: Path, *, told: str = "") -> Iterator[Path]:
    """Give a temporary file to write that takes the place of `path` when the block ends well.

    Args:
        path: The file; its folder must exist.
        told: Beginning of the message about a failure; by default that `path` cannot be saved.

    Yields:
        Path of a file that does not exist yet, in the same folder. After an exception it is
        removed and the old file is as it was.

    Raises:
        LevelError: See `write_atomically`.
    """
    with _naming(path, told):
        target, before = _regular(path)
        temporary = target.with_name(f"{_PREFIX}{secrets.token_hex(8)}{_ENDING}")
        try:
            yield temporary
            _sync(temporary, os.O_RDWR)
            if before is not None:
                temporary.chmod(stat.S_IMODE(before.st_mode))
                _give_to_owner(temporary, before)
            os.replace(temporary, target)
        except BaseException:
            with contextlib.suppress(OSError):
                temporary.unlink(missing_ok=True)
            raise
    # The new content has the name by now. Some file systems cannot sync a folder, which makes the
    # change of name a little less durable, but is no failure.
    with contextlib.suppress(OSError):
        _sync_folder(target.parent)
    with contextlib.suppress(OSError):
        if target.parent not in _SWEPT:
            _SWEPT.add(target.parent)
            _sweep(target.parent)


@contextlib.contextmanager
def _naming(path: Path, told: str = "") -> Iterator[None]:
    """Turn what the system refuses into a sentence that names the file."""
    try:
        yield
    except OSError as error:
        told = told or f"{path}: cannot be saved"
        raise LevelError(f"{told}: {error.strerror or error}") from error


def _regular(path: Path) -> tuple[Path, os.stat_result | None]:
    """Return the file that links lead to and what is there now, or None.

    Raises:
        OSError: The path leads to something that must not be replaced: a read-only file, or a
            device.
    """
    try:
        target = Path(os.path.realpath(path))
    except ValueError as error:
        raise OSError(0, str(error)) from error
    if _is_open_already(path):
        raise OSError(0, "it is where this program's own output goes; choose another name")
    try:
        found = target.stat()
    except FileNotFoundError:
        return target, None
    if stat.S_ISDIR(found.st_mode):
        raise OSError(0, "it is a folder; choose another name")
    if not stat.S_ISREG(found.st_mode):
        kind = "a named pipe" if stat.S_ISFIFO(found.st_mode) else "a device or a socket"
        raise OSError(0, f"it is {kind}, not a file; choose another name")
    if not os.access(target, os.W_OK):
        raise OSError(0, "the file is read-only")
    return target, found


def _is_open_already(path: Path) -> bool:
    """Return whether the path is a file descriptor of a process, such as `/dev/stdout`.

    Links there seem to lead to a file, or to a missing one; replacing it would cut off its writer.
    """
    step = Path(os.path.abspath(path))
    for _ in range(_MOST_LINKS):
        if os.path.realpath(step.parent).startswith("/proc/"):
            return True
        try:
            step = Path(os.path.abspath(step.parent / os.readlink(step)))
        except OSError:
            return False
    return False


def _write_new(path: Path, data: bytes) -> None:
    descriptor = os.open(path, os.O_WRONLY | os.O_CREAT | os.O_EXCL, 0o666)
    with os.fdopen(descriptor, "wb") as file:
        file.write(data)


def _give_to_owner(path: Path, before: os.stat_result) -> None:
    """Let a file of another user stay that user's where we may decide that (as root)."""
    now = path.stat()
    if (now.st_uid, now.st_gid) != (before.st_uid, before.st_gid) and hasattr(os, "chown"):
        with contextlib.suppress(OSError):
            os.chown(path, before.st_uid, before.st_gid)


def _sync_folder(folder: Path) -> None:
    if os.name == "posix":
        _sync(folder, os.O_RDONLY)


def _sync(path: Path, flags: int) -> None:
    """Have a file or a folder reach the disk; the flags open it."""
    descriptor = os.open(path, flags)
    try:
        os.fsync(descriptor)
    finally:
        os.close(descriptor)


def _sweep(folder: Path) -> None:
    """Remove what runs that were killed within a save have left in a folder."""
    with os.scandir(folder) as entries:
        left = [
            entry.path
            for entry in entries
            if entry.name.startswith(_PREFIX)
            and entry.name.endswith(_ENDING)
            and entry.stat(follow_symlinks=False).st_mtime < time.time() - _STALE
        ]
    for path in left:
        with contextlib.suppress(OSError):
            os.unlink(path)
