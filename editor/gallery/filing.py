"""Level files of the gallery: rename, duplicate, move, throw away, bring back."""

import dataclasses
import datetime
import errno
import itertools
import os
import shutil
import sys
import urllib.parse
from collections.abc import Callable, Collection
from pathlib import Path
from typing import Final

from kinetix.errors import LevelError
from kinetix.files.names import first_free, shortened
from kinetix.level.codec import load_document, save_level
from kinetix.paths import levels_dir, state_dir, user_levels_dir


def bundled(path: Path) -> bool:
    """Return whether a file came with the app: such are left alone."""
    return path.resolve().is_relative_to(levels_dir().resolve())


def any_bundled(paths: Collection[Path]) -> bool:
    """Return whether one of many files came with the app; looks at each folder once."""
    app = levels_dir().resolve()
    if any(folder.resolve().is_relative_to(app) for folder in {path.parent for path in paths}):
        return True
    return any(path.is_symlink() and bundled(path) for path in paths)


_NOTE: Final = ".trashinfo"


def stem_of(name: str) -> str:
    """Return a file name without suffix for a level's name."""
    kept = "".join(c if c.isalnum() or c in "-_ " else "" for c in name).strip()
    return "_".join(kept.lower().split())[:80] or "level"


def free_path(path: Path, *, room: int = 0) -> Path:
    """The path, with a number when something is there already; a name that is too long is cut.

    Args:
        path: The wish.
        room: Bytes that the name has to leave, for an ending that will be added.
    """
    numbers = itertools.chain(("",), (f"_{number}" for number in itertools.count(2)))
    names = (shortened(path.stem, f"{number}{path.suffix}", room=room) for number in numbers)
    return first_free(map(path.with_name, names))


def rename(path: Path, name: str) -> Path:
    """Give a level another name: in the file (where its format has one) and as the file's name.

    Returns:
        The new path.

    Raises:
        LevelError: The name is empty or too long, or the file cannot be read or written.
    """
    words = " ".join(name.split())
    if not 1 <= len(words) <= 120:
        raise LevelError(f"The name {name!r} cannot be used: it needs 1 to 120 characters.")
    loaded = load_document(path.resolve())
    target = path.with_name(f"{stem_of(words)}{path.suffix}")
    target = path if target == path else free_path(target)
    if loaded.format == "kinetix-level":
        save_level(loaded.level.replace(name=words), path)
    try:
        os.rename(path, target)
    except OSError as error:
        raise LevelError(f"{path}: cannot be renamed: {error.strerror or error}") from error
    return target


def duplicate(path: Path) -> Path:
    """Return a copy beside the level, or in the user's folder when the level came with the app.

    Returns:
        The copy's path.

    Raises:
        LevelError: The file cannot be read or the copy not be written.
    """
    loaded = load_document(path.resolve())
    folder = user_levels_dir() if bundled(path) else path.parent
    target = free_path(folder / f"{path.stem}_copy{path.suffix}")
    level = loaded.level
    if loaded.format == "kinetix-level":
        level = level.replace(name=f"{level.name[:114]} copy")
    try:
        folder.mkdir(parents=True, exist_ok=True)
    except OSError as error:
        raise LevelError(f"{folder}: cannot be made: {error.strerror or error}") from error
    save_level(level, target, format=loaded.format, source=loaded.source)
    return target


def copy_into(path: Path, folder: Path) -> Path:
    """Return a copy of a level file in another folder, which is made where it is not there.

    Returns:
        The copy's path: with a number when something of this name is there already.

    Raises:
        LevelError: The file cannot be read or the copy not be written.
    """
    return _put_into(path, folder, shutil.copyfile, "copied")


def _put_into(path: Path, folder: Path, put: Callable[[Path, Path], object], done: str) -> Path:
    """Put a file into a folder, under its name or with a number behind it.

    Args:
        path: The file.
        folder: Made if it is not there.
        put: Copies or moves the file to the path it is given.
        done: Participle of that for the error: `copied`.
    """
    target = free_path(folder / path.name)
    try:
        folder.mkdir(parents=True, exist_ok=True)
        put(path, target)
    except OSError as error:
        raise LevelError(f"{path}: cannot be {done} to {folder}: {_reason(error)}") from error
    return target


@dataclasses.dataclass(frozen=True, kw_only=True)
class MovedFile:
    """A file in the trash or in another folder, and where it was."""

    origin: Path
    file: Path
    note: Path | None = None
    """The trash's own record of the origin, where the system has such."""


def move_into(path: Path, folder: Path) -> MovedFile:
    """Move a level file to another folder, which is made where it is not there.

    When something of this name is there already the file gets a number.

    Raises:
        LevelError: The file cannot be moved; it stays where it is.
    """
    return MovedFile(origin=path, file=_put_into(path, folder, _carry, "moved"))


def throw_away(path: Path) -> MovedFile:
    """Move a file to the system's trash.

    Source: the Trash specification of freedesktop.org, version 1.0 (the home trash).

    Raises:
        LevelError: The file cannot be moved.
    """
    folder, notes = _trash()
    try:
        folder.mkdir(parents=True, exist_ok=True)
        target = free_path(folder / path.name, room=len(_NOTE))
        note = None if notes is None else notes / f"{target.name}{_NOTE}"
        if note is not None:
            note.parent.mkdir(parents=True, exist_ok=True)
            when = datetime.datetime.now().replace(microsecond=0).isoformat()
            origin = urllib.parse.quote(str(path.resolve()))
            note.write_text(f"[Trash Info]\nPath={origin}\nDeletionDate={when}\n")
        _move(path, target, note)
    except OSError as error:
        raise LevelError(f"{path}: cannot be deleted: {_reason(error)}") from error
    return MovedFile(origin=path, file=target, note=note)


def _move(path: Path, target: Path, note: Path | None) -> None:
    """Move a file or a folder into the trash; when that fails nothing stays there."""
    try:
        _carry(path, target)
    except OSError:
        if note is not None:
            note.unlink(missing_ok=True)
        raise


def _carry(path: Path, target: Path) -> None:
    """Move a file or a folder; to another disk by a copy, and where that fails all is as before."""
    try:
        os.rename(path, target)
        return
    except OSError as error:
        if error.errno != errno.EXDEV:
            raise
    if os.path.isdir(path) and not os.path.islink(path):
        try:
            shutil.copytree(path, target, symlinks=True)
        except OSError:
            shutil.rmtree(target, ignore_errors=True)
            raise
        shutil.rmtree(path, ignore_errors=True)
        return
    try:
        shutil.copy2(path, target, follow_symlinks=False)
        path.unlink()
    except OSError:
        target.unlink(missing_ok=True)
        raise


def bring_back(thrown: MovedFile) -> None:
    """Put a file back to where it was.

    Raises:
        LevelError: Something else is there now, or the trash was emptied.
    """
    if os.path.exists(thrown.origin):
        raise LevelError(f"{thrown.origin}: another file of this name is there now.")
    try:
        _carry(thrown.file, thrown.origin)
    except OSError as error:
        stays = f"; it stays in {thrown.file}" if os.path.lexists(thrown.file) else ""
        raise LevelError(
            f"{thrown.origin}: cannot be brought back: {_reason(error)}{stays}"
        ) from error
    if thrown.note is not None:
        thrown.note.unlink(missing_ok=True)


def _reason(error: OSError) -> str:
    """Return why something cannot be moved; of a folder the reason of its first file."""
    told = error.args[0] if isinstance(error, shutil.Error) and error.args else None
    if isinstance(told, list) and told:
        _, _, first = told[0]
        return str(first).removeprefix("[Errno ").partition("] ")[2] or str(first)
    return error.strerror or str(error)


def _trash() -> tuple[Path, Path | None]:
    """Return the folder of thrown files, and that of their notes."""
    if sys.platform == "darwin":
        return Path.home() / ".Trash", None
    if os.name != "posix":
        return state_dir() / "trash", None
    base = Path(os.environ.get("XDG_DATA_HOME") or Path.home() / ".local" / "share") / "Trash"
    return base / "files", base / "info"
