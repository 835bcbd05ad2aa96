"""Unsaved work of earlier runs: read from their copies, to be offered to the user."""

import contextlib
import dataclasses
import datetime
import os
from collections.abc import Iterable, Iterator
from pathlib import Path
from typing import Any

from editor.base.wording import title_of
from editor.documents import autosaves
from editor.documents.document import Format, same_content
from kinetix.errors import KinetixError
from kinetix.files.json_text import parse
from kinetix.files.regular import FileError, read_text
from kinetix.level.codec import load_document, loads
from kinetix.level.model import Level


@dataclasses.dataclass(frozen=True, kw_only=True)
class Recovery:
    """Unsaved work of a run that has ended."""

    file: Path
    """The copy."""
    path: Path | None
    """The level's own file, or None when it never had one."""
    format: Format
    time: datetime.datetime
    level: Level
    base: str | None = None
    """Digest of the level's own file when the work on it began, where it is known."""
    origin: tuple[Path, ...] = ()
    """Copies of still earlier runs that this one began with."""

    def summary(self) -> str:
        """Return its time and its differences from the file, for the question."""
        when = self.time.astimezone().strftime("%Y-%m-%d %H:%M")
        name = self.path.name if self.path else title_of(self.level)
        return f"{name}, {when}: {self._differences()}"

    def _differences(self) -> str:
        mine = _counts(self.level)
        if self.path is None:
            return f"{mine}, never saved"
        try:
            theirs = _counts(load_document(self.path).level)
        except KinetixError:
            return f"{mine}; its file is gone or cannot be read"
        return f"{mine}; the file has {theirs}" if mine != theirs else f"{mine}, edited"


@dataclasses.dataclass(frozen=True, kw_only=True)
class Found:
    """Everything that earlier runs left behind."""

    recoveries: tuple[Recovery, ...]
    """Newest first."""
    unreadable: tuple[str, ...]
    """A sentence for each copy that cannot be read; it stays where it is."""


def find(base: Path | None = None) -> Found:
    """Read what earlier runs left behind; runs that still go on are left alone.

    A copy that says nothing but what its file says by now is removed. One that a later copy began
    with is not offered beside it; both go together. Nor is one that another window has restored.

    Args:
        base: Where runs have their folders; by default in the user's state folder.
    """
    read, unreadable = [], []
    for file in autosaves.left_behind(base):
        try:
            read.append(_read(file))
        except KinetixError as error:
            if os.path.exists(file):  # else another run that starts has removed it
                unreadable.append(f"A copy of unsaved work cannot be read. {error}")
    saved = [recovery for recovery in read if _saved(recovery)]
    gone = {file for recovery in saved for file in (recovery.file, *recovery.origin)}
    read = [recovery for recovery in read if recovery.file not in gone]
    for recovery in saved:
        discard(recovery)
    begun_with = {file for recovery in (*read, *_elsewhere(base)) for file in recovery.origin}
    offered = [recovery for recovery in read if recovery.file not in begun_with]
    offered.sort(key=lambda recovery: recovery.time, reverse=True)
    return Found(recoveries=tuple(offered), unreadable=tuple(unreadable))


def _elsewhere(base: Path | None) -> Iterator[Recovery]:
    """Yield the copies of runs that go on, but those being written."""
    for file in autosaves.being_kept(base):
        with contextlib.suppress(KinetixError):
            yield _read(file)


def discard(recovery: Recovery) -> None:
    """Remove a copy for good, and those that it began with."""
    autosaves.discard_all((recovery.file, *recovery.origin))


def tidy(recovery: Recovery) -> None:
    """Remove the folders of runs that a copy, and those that it began with, were the last of."""
    for file in (recovery.file, *recovery.origin):
        if not os.path.lexists(file):
            autosaves.discard(file)


def _read(file: Path) -> Recovery:
    """Read a copy.

    Raises:
        KinetixError: The copy cannot be read, or is damaged.
    """
    record: Any = parse(read_text(file, "level"), file)
    try:
        path, format, base = record["path"], record["format"], record.get("base")
        if format not in ("kinetix-level", "kinetix-env"):
            raise ValueError(f"unknown format {format!r}")
        time = datetime.datetime.fromisoformat(record["time"])
        return Recovery(
            file=file,
            path=Path(path) if path else None,
            format=format,
            time=time if time.tzinfo else time.astimezone(),
            level=loads(record["level"], str(file)),
            base=base if isinstance(base, str) else None,
            origin=tuple(_copies(record.get("origin", ()), file)),
        )
    except (KeyError, TypeError, ValueError, AttributeError) as error:
        raise FileError(file, f"expected a copy of a level: {error}") from error


def _copies(names: Iterable[str], file: Path) -> Iterator[Path]:
    """Yield the paths that are copies; a damaged record must not have other files removed."""
    runs = file.parent.parent
    for name in names:
        path = Path(os.path.normpath(name))
        if path.suffix == ".json" and runs in (path.parent, path.parent.parent):
            yield path


def _saved(recovery: Recovery) -> bool:
    """Return whether the level's own file holds the same by now."""
    if recovery.path is None:
        return False
    try:
        return same_content(load_document(recovery.path).level, recovery.level)
    except KinetixError:
        return False


def _counts(level: Level) -> str:
    parts = (
        (len(level.bodies), "shape"),
        (len(level.joints), "joint"),
        (len(level.thrusters), "thruster"),
    )
    return ", ".join(f"{n} {noun}{'' if n == 1 else 's'}" for n, noun in parts)
