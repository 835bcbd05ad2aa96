"""Changes of open files by another program."""

import os
from pathlib import Path

from editor.base.prompts import Choice, MenuQuestion
from editor.base.wording import describe
from editor.documents import files
from editor.documents.commands.level import ReplaceLevel
from editor.documents.document import Document, same_content
from editor.session import Session
from kinetix.errors import CommandError, LevelError
from kinetix.level.model import Level

_KINDS = (("bodies", "shapes"), ("joints", "joints"), ("thrusters", "thrusters"))


def check(session: Session) -> None:
    """Look at all files; the banner over the level in front says when that is another one."""
    for document in session.tabs.documents:
        _note_removed(session, document)
    if session.editing:
        _check_front(session)


def note_lost(session: Session, *documents: Document) -> None:
    """Make what is in no file unsaved: its file was replaced or removed since it was saved."""
    for document in documents:
        _note_removed(session, document)
        if files.nowhere(document):
            document.mark_unsaved()
            session.toast(
                f"{document.title} was changed by another program; this version is in no file.",
                "warning",
            )


def _note_removed(session: Session, document: Document) -> None:
    """Say so when a document's file is gone."""
    path = document.path
    if path is None or document.stamp is None or os.path.exists(path):
        return
    document.stamp, document.outside = None, ""
    document.mark_unsaved()
    why = "was removed" if _is_gone(path) else "cannot be reached any more"
    session.toast(f"{path.name} {why}; the level is only here now.", "warning")


def _check_front(session: Session) -> None:
    document = session.document
    if not files.changed_outside(document):
        document.outside = ""
        return
    path = document.path
    assert path is not None
    if document.stamp is None and _holds_the_same(session):
        document.stamp, document.outside = files.read_stamp(path), ""
        document.mark_saved()
        return
    try:
        summary, document.readable = _summary(session), True
    except LevelError as error:
        summary, document.readable = (
            f"It cannot be read now: {files.plain_reason(path, error)}",
            False,
        )
    document.outside = f"{path.name} was changed by another program. {summary}"


def _holds_the_same(session: Session) -> bool:
    """Return whether a file that is back holds the level in front."""
    try:
        return same_content(_theirs(session), session.document.level)
    except LevelError:
        return False


def _is_gone(path: Path) -> bool:
    """Return whether there is no such file, rather than one that nobody may look at."""
    try:
        path.stat()
    except OSError as error:
        return isinstance(error, (FileNotFoundError, NotADirectoryError))
    return False


def is_changed(session: Session) -> bool:
    """Return whether somebody else has changed the file in front."""
    return session.editing and bool(session.document.outside)


def is_readable(session: Session) -> bool:
    """Return whether somebody else has changed the file in front and it can be read."""
    return is_changed(session) and session.document.readable


def reload(session: Session) -> None:
    """Take the file's content over."""
    take(session, session.document)
    session.toast(f"Reloaded {session.document.title}", "success", action="edit.undo")


def take(session: Session, document: Document) -> None:
    """Take the content of a document's file over as one edit, so that it can be undone.

    Raises:
        CommandError: The file cannot be read.
    """
    path = document.path
    assert path is not None
    try:
        fresh = files.open_document(path, session.old_names)
    except LevelError as error:
        raise CommandError(f"{path.name}: {files.plain_reason(path, error)}") from error
    document.commit(ReplaceLevel(level=fresh.level, label="Reload"), time=session.time)
    document.source, document.stamp, document.outside = fresh.source, fresh.stamp, ""
    document.replaces_other = False
    document.mark_saved()


def keep(session: Session) -> None:
    """Go on with what is here; saving puts it in the place of the other."""
    document = session.document
    assert document.path is not None
    document.stamp, document.outside = files.read_stamp(document.path), ""
    document.replaces_other = True
    document.mark_unsaved()


def show_differences(session: Session) -> None:
    """List what differs; choosing something selects it."""
    mine, theirs = session.document.level, _theirs(session)
    choices = [
        Choice(
            id=str(number),
            label=describe(level, number),
            detail=word,
            ids=() if word == "new" else (number,),
        )
        for number, level, word in _differences(mine, theirs)
    ]
    if not choices:
        session.toast("No shape, joint or thruster differs, only settings of the level.")
        return

    def answer(choice: str | None) -> None:
        if choice is not None:
            session.selection = (int(choice),)

    title = "In the file"
    session.ask(MenuQuestion(title=title, choices=tuple(choices), at=None, answer=answer))


def _theirs(session: Session) -> Level:
    """Return the level in the file as it would be opened, with the old names that wait for it."""
    assert session.document.path is not None
    return files.open_document(session.document.path, session.old_names).level


def _differences(mine: Level, theirs: Level) -> list[tuple[int, Level, str]]:
    """Return the differences: id, the level that has it, and how the file differs from here."""
    here = {entity.id: entity for entity in mine.entities()}
    there = {entity.id: entity for entity in theirs.entities()}
    found = [(number, theirs, "new") for number in there if number not in here]
    found += [(number, mine, "gone") for number in here if number not in there]
    common = [number for number in here if number in there]
    return found + [(n, mine, "changed") for n in common if here[n] != there[n]]


def _summary(session: Session) -> str:
    """Count the differences of each kind.

    Raises:
        LevelError: The file cannot be read.
    """
    theirs = _theirs(session)
    differing = _differences(session.document.level, theirs)
    parts = []
    for kind, noun in _KINDS:
        ids = {e.id for level in (session.document.level, theirs) for e in getattr(level, kind)}
        words = [word for number, _, word in differing if number in ids]
        if words:
            counts = (f"{words.count(word)} {word}" for word in ("new", "gone", "changed"))
            parts.append(f"{noun}: {', '.join(counts)}")
    if not parts:
        return "Only settings of the level differ."
    if _settings(theirs) != _settings(session.document.level):
        parts.append("settings of the level")
    return f"Differences: {'; '.join(parts)}."


def _settings(level: Level) -> Level:
    """Return a level without its entities."""
    return level.replace(bodies=(), joints=(), thrusters=(), next_id=1)
