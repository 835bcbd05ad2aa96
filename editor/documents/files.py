"""Level files of the app: open, save with a backup, changes from outside."""

import contextlib
import os
from pathlib import Path
from typing import Final

from editor.documents.commands.fields import SetLevelField
from editor.documents.document import Document, Format, Stamp, same_content
from editor.documents.old_names import OldNames, named
from kinetix.errors import KinetixError, LevelError
from kinetix.files.atomic import free_backup, write_with_backup
from kinetix.files.names import is_text
from kinetix.files.regular import FileError, read_bytes
from kinetix.level.codec import dumps, load_document, resolve_path
from kinetix.level.kinetix_env.document import lost_fields
from kinetix.level.model import Level
from kinetix.level.sets import is_set_file
from kinetix.level.sizes import without_outgrown_size

LEVEL_SUFFIXES: Final = (".json",)


def open_document(path: str | Path, waiting: OldNames | None = None) -> Document:
    """Return a document from a level file of either format.

    Args:
        path: A file, or the name of a bundled level such as `s/name`.
        waiting: Names from earlier versions, which the level takes in.

    Raises:
        LevelError: The file is missing or bad; one sentence with file and JSON path.
    """
    file = resolve_path(path)
    if not is_text(file):
        raise LevelError(f"{file}: the file's name is no Unicode text; rename it, then open it")
    stamp = read_stamp(file)
    loaded = load_document(file)
    document = Document(
        named(loaded.level, waiting.of(file)) if waiting else loaded.level,
        path=file,
        format=loaded.format,
        warnings=loaded.warnings,
        source=loaded.source,
    )
    document.stamp = stamp
    return document


def lost_on_save(level: Level, path: Path, format: Format) -> tuple[str, ...]:
    """Return the fields that a save in this format would not carry."""
    return lost_fields(level, stem=path.stem) if format == "kinetix-env" else ()


def save_document(document: Document, path: Path, format: Format) -> None:
    """Write a document; the file's previous content stays beside it as `NAME.json.bak`.

    What another program has put there gets a name that no later save uses: `NAME.json.bak2`.

    A level that does not fit the size it names could not be read again: its size becomes automatic.

    Args:
        document: What to save; afterwards it is clean and belongs to the file.
        path: The file.
        format: The format to write.

    Raises:
        LevelError: The file cannot be written; the old one is as it was.
    """
    if not os.path.isdir(path.parent):
        raise LevelError(f"{path}: cannot be saved: its folder is gone")
    level = document.level
    fitting = without_outgrown_size(level)
    if fitting is not level:
        fitting = fitting.replace(solution=None)  # as any change of what is played
    data = dumps(fitting, format=format, source=document.source).encode()
    foreign = document.replaces_other or conflicts(document, path)
    write_with_backup(path, data, backup=free_backup(path) if foreign else None)
    if fitting is not level:  # after the write, which may fail and then changes nothing
        document.commit(SetLevelField(field="size", value=None))
    document.mark_saved(path, format)
    # What another program writes from here on is a change from outside.
    written = read_stamp(path)
    modified = 0 if written is None or written.content != data else written.modified_ns
    document.stamp, document.outside = Stamp(modified_ns=modified, content=data), ""
    document.replaces_other = False


def conflicts(document: Document, path: Path) -> bool:
    """Return whether a save would replace what another program has put into the document's file."""
    if document.path is None or path.resolve() != document.path.resolve():
        return False
    now = read_stamp(path)
    return now is not None and (document.stamp is None or now.content != document.stamp.content)


def read_stamp(path: Path) -> Stamp | None:
    """Return the present state of a file, or None when it cannot be read."""
    try:
        return Stamp(modified_ns=path.stat().st_mtime_ns, content=read_bytes(path, "level"))
    except (OSError, FileError):
        return None


def changed_outside(document: Document) -> bool:
    """Return whether the document's file was changed or removed since it was last read."""
    if document.path is None:
        return False
    if document.stamp is None:  # it was gone, and may be back
        return os.path.isfile(document.path)
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


def nowhere(document: Document) -> bool:
    """Return whether a level that seems saved is in no file: that was damaged, replaced or removed.

    What was opened and never edited may be replaced by another version, but not by none.
    """
    if document.dirty or not changed_outside(document):
        return False
    assert document.path is not None
    try:
        theirs = load_document(document.path).level
    except KinetixError:
        return True
    return document.edited and not same_content(theirs, document.level)


def why_not(path: str | Path, error: LevelError) -> str:
    """Return why a file cannot be opened, and what it is instead where that is known.

    Returns:
        A sentence with the whole path.
    """
    other = _what_else(Path(path))
    return f"{path}: {other}" if other else str(error)


def told_plainly(path: str | Path, error: LevelError) -> str:
    """Return why a file cannot be opened: its name first, its folder in a line of its own."""
    file = _resolved(path)
    return f"{file.name}: {plain_reason(path, error)}\n{file.parent.absolute()}"


def plain_reason(path: str | Path, error: LevelError) -> str:
    """Return why a file cannot be opened, in plain words and without its name."""
    file = _resolved(path)
    reason = _what_else(file) or str(error).removeprefix(f"{path}: ").removeprefix(f"{file}: ")
    reason = reason.removeprefix("$: ").replace("; $: ", "; ")
    if file.is_absolute():
        reason = reason.replace(", nor a bundled level of this name", "")
    if reason.startswith("expected UTF-8 text"):
        return "this is no text; a level is a text file in JSON"
    if reason.startswith("expected a level:"):
        return "this is JSON, but no level"
    if reason.startswith("not JSON"):
        return f"this is no level, or a damaged one: {reason}"
    return reason


def _resolved(path: str | Path) -> Path:
    """Return the file that a path or the name of a bundled level means."""
    with contextlib.suppress(LevelError):
        return resolve_path(path)
    return Path(path)


def _what_else(path: Path) -> str:
    """Return what a file is that is no level; empty where it may be one."""
    if path.suffix.lower() not in ("", *LEVEL_SUFFIXES) and os.path.isfile(path):
        return "this is no level; a level is a file that ends in .json"
    if is_set_file(path):
        return "this is a level set; drop it on the window, and the gallery takes it"
    with contextlib.suppress(OSError):
        if os.path.isfile(path) and path.stat().st_size == 0:
            return "this file is empty"
    return ""
