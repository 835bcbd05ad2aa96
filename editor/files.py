"""Level files of the app: open, save with a backup, autosave and recover, changes from outside."""

import dataclasses
import datetime
import json
import os
from pathlib import Path
from typing import Any

from editor.document import Document, Format, same_content
from kinetix.errors import LevelError
from kinetix.level.atomic import write_atomically, write_with_backup
from kinetix.level.codec import dumps, load_document, loads, resolve_path
from kinetix.level.kinetix_env import lost_fields
from kinetix.level.model import Level
from kinetix.paths import state_dir


@dataclasses.dataclass(frozen=True, kw_only=True)
class Stamp:
    """What a file looked like: enough to notice that somebody else changed it."""

    modified_ns: int
    content: bytes


def open_document(path: str | Path) -> Document:
    """A document from a level file of either format.

    Args:
        path: A file, or the name of a bundled level such as `s/name`.

    Raises:
        LevelError: The file is missing or bad; one sentence with file and JSON path.
    """
    file = resolve_path(path)
    stamp = read_stamp(file)
    loaded = load_document(file)
    document = Document(
        loaded.level,
        path=file,
        format=loaded.format,
        warnings=loaded.warnings,
        source=loaded.source,
    )
    document.stamp = stamp
    return document


def lost_on_save(level: Level, path: Path, format: Format) -> tuple[str, ...]:
    """The fields that a save in this format would not carry."""
    return lost_fields(level, stem=path.stem) if format == "kinetix-env" else ()


def save_document(document: Document, path: Path, format: Format) -> None:
    """Write a document; the file's previous content stays beside it as `NAME.json.bak`.

    Args:
        document: What to save; afterwards it is clean and belongs to the file.
        path: The file.
        format: The format to write.

    Raises:
        LevelError: The file cannot be written; the old one is as it was.
    """
    if path.is_file() and not os.access(path, os.W_OK):
        raise LevelError(f"{path}: cannot be saved: the file is read-only")
    text = dumps(document.level, format=format, source=document.source)
    write_with_backup(path, text.encode())
    document.mark_saved(path, format)
    document.stamp, document.outside = read_stamp(path), ""
    forget_autosave(document)


def read_stamp(path: Path) -> Stamp | None:
    """What a file looks like now, or None when it cannot be read."""
    try:
        return Stamp(modified_ns=path.stat().st_mtime_ns, content=path.read_bytes())
    except OSError:
        return None


def changed_outside(document: Document) -> bool:
    """Whether somebody else has changed or removed the document's file since it was last read."""
    if document.path is None or not isinstance(document.stamp, Stamp):
        return False
    try:
        modified = document.path.stat().st_mtime_ns
    except OSError:
        return True
    if modified == document.stamp.modified_ns:
        return False
    now = read_stamp(document.path)
    if now is not None and now.content == document.stamp.content:
        document.stamp = now
        return False
    return True


@dataclasses.dataclass(frozen=True, kw_only=True)
class Recovery:
    """An autosave that a run left behind."""

    file: Path
    path: Path | None
    """The level's own file, or None when it never had one."""
    format: Format
    time: datetime.datetime
    level: Level

    def summary(self) -> str:
        """When it was made and how it differs from the file, for the question."""
        when = self.time.astimezone().strftime("%Y-%m-%d %H:%M")
        name = self.path.name if self.path else self.level.name
        return f"{name}, {when}: {self._differences()}"

    def _differences(self) -> str:
        mine = _counts(self.level)
        if self.path is None:
            return mine
        try:
            theirs = _counts(load_document(self.path).level)
        except LevelError:
            return f"{mine}; its file is gone"
        return f"{mine}; the file has {theirs}" if mine != theirs else f"{mine}, edited"


def _counts(level: Level) -> str:
    parts = (
        (len(level.bodies), "shape"),
        (len(level.joints), "joint"),
        (len(level.thrusters), "thruster"),
    )
    return ", ".join(f"{n} {noun}{'' if n == 1 else 's'}" for n, noun in parts)


def autosave_dir() -> Path:
    """Where autosaves are kept."""
    return state_dir() / "autosave"


def _autosave_file(document: Document) -> Path:
    return autosave_dir() / f"{os.getpid()}-{document.number}.json"


def autosave(document: Document) -> bool:
    """Keep a copy of unsaved changes in the user's state folder.

    Returns:
        Whether something was written; False when nothing changed since the last time.

    Raises:
        LevelError: The copy cannot be written.
    """
    level = document.level
    if not document.dirty or same_content(level, document.autosaved):
        return False
    record = {
        "path": str(document.path.resolve()) if document.path else None,
        "format": document.format,
        "time": datetime.datetime.now(datetime.UTC).isoformat(),
        "level": dumps(level),
    }
    file = _autosave_file(document)
    try:
        file.parent.mkdir(parents=True, exist_ok=True)
    except OSError as error:
        raise LevelError(f"{file}: cannot be saved: {error.strerror or error}") from error
    write_atomically(file, json.dumps(record).encode())
    document.autosaved, document.autosaved_at = level, datetime.datetime.now().astimezone()
    return True


def forget_autosave(document: Document) -> None:
    """Remove the copy of a document that was saved or given up."""
    document.autosaved, document.autosaved_at = document.level, None
    _autosave_file(document).unlink(missing_ok=True)


def recoveries() -> list[Recovery]:
    """What earlier runs left behind, newest first; runs that still go on are left alone."""
    found = []
    for file in sorted(autosave_dir().glob("*-*.json")):
        if _alive(file.name.partition("-")[0]):
            continue
        try:
            record: Any = json.loads(file.read_text(encoding="utf-8"))
            recovery = Recovery(
                file=file,
                path=Path(record["path"]) if record["path"] else None,
                format=record["format"],
                time=datetime.datetime.fromisoformat(record["time"]),
                level=loads(record["level"], str(file)),
            )
        except (OSError, ValueError, KeyError, TypeError, LevelError):
            continue
        found.append(recovery)
    return sorted(found, key=lambda recovery: recovery.time, reverse=True)


def recovered_document(recovery: Recovery) -> Document:
    """A document from an autosave; it counts as changed, and its copy is taken away."""
    document = Document(recovery.level, path=recovery.path, format=recovery.format)
    document.stamp = read_stamp(recovery.path) if recovery.path else None
    document.mark_unsaved()
    discard_recovery(recovery)
    return document


def discard_recovery(recovery: Recovery) -> None:
    """Take an autosave away."""
    recovery.file.unlink(missing_ok=True)


def _alive(process: str) -> bool:
    if not process.isdigit() or os.name != "posix":
        return False
    if int(process) == os.getpid():
        return True
    try:
        os.kill(int(process), 0)
    except ProcessLookupError:
        return False
    except OSError:
        return True
    return True
