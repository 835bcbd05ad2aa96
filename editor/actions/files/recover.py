"""Recovery of unsaved work of earlier runs: offered at the start, restored as one edit."""

import os
from collections.abc import Sequence

from editor.base.prompts import Choice, Question
from editor.documents import files, recovery
from editor.documents.commands.level import ReplaceLevel
from editor.documents.document import Document, Stamp
from editor.documents.old_names import named
from editor.documents.recovery import Recovery
from editor.gallery import filing
from editor.session import Session
from kinetix.errors import LevelError
from kinetix.wording import plural

SHOWN = 8
"""Of more copies the question names only so many."""


def offer(session: Session) -> None:
    """Ask about what earlier runs could not save (IO3)."""
    found = recovery.find()
    for sentence in found.unreadable:
        session.toast(sentence, "warning")
    if not found.recoveries:
        return

    def answer(choice: str) -> None:
        if choice == "restore":
            for each in _as_tabs(found.recoveries):
                with session.guard():
                    restore(session, each)
            _show(session, found.recoveries[0])
        elif choice == "discard":
            _discard(session, found.recoveries)

    count = len(found.recoveries)
    lines = [each.summary() for each in found.recoveries[:SHOWN]]
    lines += [f"… and {count - SHOWN} more"] if count > SHOWN else []
    several = count > 1
    session.ask(
        Question(
            title="Restore unsaved work?",
            message="The app ended without saving\n" + "\n".join(lines),
            choices=(
                Choice(id="restore", label="Restore All" if several else "Restore"),
                Choice(id="discard", label="Discard All" if several else "Discard"),
                Choice(id="later", label="Ask again next time"),
            ),
            default="restore",
            cancel="later",
            answer=answer,
        )
    )


def _as_tabs(recoveries: Sequence[Recovery]) -> list[Recovery]:
    """Return copies as their tabs stood: of each run by their numbers, the newest run last."""
    runs = {each.file.parent: each.time for each in reversed(recoveries)}
    # A longer number is a greater one.
    names = {each.file: each.file.stem for each in recoveries}
    return sorted(
        recoveries,
        key=lambda each: (runs[each.file.parent], len(names[each.file]), names[each.file]),
    )


def _show(session: Session, found: Recovery) -> None:
    """Bring the tab of what was restored to the front: of what was worked on last."""
    for index, tab in enumerate(session.tabs):
        if found.file in tab.document.origin:
            session.show_tab(index)
            return


def _discard(session: Session, recoveries: Sequence[Recovery]) -> None:
    """Move copies to the trash, each with those that it began with."""
    thrown = []
    for each in recoveries:
        # The oldest goes first: see `autosaves.discard_all`.
        for file in filter(os.path.lexists, reversed((each.file, *each.origin))):
            with session.guard():
                thrown.append(filing.throw_away(file))
        recovery.tidy(each)
    if thrown:
        session.discarded = tuple(thrown)
        count = plural(len(recoveries), "copy", "copies")
        session.toast(f"Moved {count} of unsaved work to the trash", action="file.undiscard")


def can_bring_back(session: Session) -> bool:
    """Return whether copies were discarded that can come back."""
    return bool(session.discarded)


def bring_back(session: Session) -> None:
    """Take the discarded copies out of the trash, and ask about them again."""
    thrown, session.discarded = session.discarded, ()
    for one in reversed(thrown):
        with session.guard():
            one.origin.parent.mkdir(parents=True, exist_ok=True)
            filing.bring_back(one)
    offer(session)


def restore(session: Session, found: Recovery) -> None:
    """Show what was not saved: as an edit of the level's file, or in a tab of its own.

    The copy stays until the level is saved or given up.
    """
    document = _document_of(session, found)
    if document is None:
        document = Document(found.level, path=found.path, format=found.format)
        document.mark_unsaved()
        session.open_tab(document)
    else:
        names = session.old_names.of(found.path) if found.path else {}
        command = ReplaceLevel(level=named(found.level, names), label="Restore unsaved work")
        document.commit(command, time=session.time)
        stamp = document.stamp
        if stamp is not None and found.base not in (None, stamp.digest):
            # Saving will ask: the file has changed since the work on it began.
            document.stamp = Stamp(modified_ns=0, content=b"")
    document.origin = (*document.origin, found.file, *found.origin)
    # Now, so that no other window that starts offers the same.
    session.autosaves.keep(document)


def _document_of(session: Session, found: Recovery) -> Document | None:
    """Return the open document of the level's file; opens it where that can be done."""
    if found.path is None:
        return None
    index = session.tabs.locate(found.path)
    if index is not None:
        document = session.tabs[index].document
        if document.dirty:
            return None
        session.show_tab(index)
        session.leave_play()
        return document
    try:
        document = files.open_document(found.path, session.old_names)
    except LevelError:
        return None
    session.open_tab(document)
    return document
