"""One JSON object in the user's state folder: what the editor keeps from one run to the next."""

import contextlib
import json
import os
from collections.abc import Iterator, Mapping
from pathlib import Path
from typing import Any, ClassVar

from kinetix.errors import LevelError
from kinetix.files.atomic import write_atomically, write_with_backup
from kinetix.files.json_text import parse
from kinetix.files.lock import held_briefly
from kinetix.files.regular import FileError, read_text
from kinetix.paths import state_dir


class Kept:
    """A file of the user's state folder and its owner; scripted runs have no such file."""

    FILE: ClassVar[str]
    """Name of the file."""

    def __init__(self, path: Path | None = None, *, stored: bool = True) -> None:
        """Begin; nothing is read yet.

        Args:
            path: The file; by default the user's own.
            stored: Whether there is a file at all; scripted runs leave no traces.
        """
        self._path = path
        self._stored = stored

    @property
    def path(self) -> Path:
        """The file."""
        return self._path or state_dir() / self.FILE


@contextlib.contextmanager
def alone(path: Path) -> Iterator[None]:
    """Keep other windows from a file while it is read, changed and written."""
    with contextlib.suppress(OSError):
        path.parent.mkdir(parents=True, exist_ok=True)
    with held_briefly(path.parent):
        yield


def read_state(path: Path, *, broken: Mapping[str, Any] | None = None) -> dict[str, Any]:
    """Return the content of a file; nothing where it is absent.

    Args:
        path: The file.
        broken: Value to return if the file is not a JSON object; an empty one by default.
    """
    try:
        return _object(path)
    except FileError:
        return dict(broken or {}) if os.path.lexists(path) else {}


def state_fault(path: Path) -> str:
    """Return why a file cannot be read; empty if it can, or if it does not exist."""
    try:
        _object(path)
    except FileError as error:
        return str(error) if os.path.lexists(path) else ""
    return ""


def _object(path: Path) -> dict[str, Any]:
    tree = parse(read_text(path, "kept"), path)
    if not isinstance(tree, dict):
        raise FileError(path, "expected one JSON object")
    return tree


def write_state(
    path: Path, tree: Mapping[str, Any], *, sound: bool = False, indent: int | None = 1
) -> os.stat_result | None:
    """Write a file atomically, making its folder if needed; a broken one stays as a backup.

    Args:
        path: The file.
        tree: What it is to hold.
        sound: True if the file has just been read and is not broken: it is not read again.
        indent: See `json.dumps`; None is quickest for what nobody reads.

    Returns:
        The state of the new file as `write_atomically` does; None if it replaced a broken one.

    Raises:
        LevelError: The file cannot be written.
    """
    try:
        path.parent.mkdir(parents=True, exist_ok=True)
    except OSError as error:
        raise LevelError(f"{path}: cannot be saved: {error.strerror or error}") from error
    data = json.dumps(tree, indent=indent).encode()
    if not sound and state_fault(path):
        write_with_backup(path, data, keep_all=True)
        return None
    return write_atomically(path, data)
