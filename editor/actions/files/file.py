"""Actions of the File menu: new, open, save, close, and the questions on the way."""

import functools
import os
from collections.abc import Callable
from pathlib import Path
from typing import Final

from editor.actions.files import external_change, folders, save_conflict
from editor.actions.playing import moment
from editor.base.prompts import Choice, FileQuestion, Question
from editor.base.wording import UNTITLED
from editor.documents import files
from editor.documents.document import Document, Format
from editor.gallery import filing
from editor.session import Session, Tab
from kinetix.errors import CommandError, LevelError
from kinetix.level.codec import level_hash, resolve_path
from kinetix.level.model import Level
from kinetix.paths import user_levels_dir

NEW_LEVEL: Final = Level(name=UNTITLED)
MESSAGE_LENGTH: Final = 600
"""Of a longer message the log has the rest [characters]."""


def new(session: Session) -> None:
    """An empty arena in a new tab."""
    session.open_tab(Document(NEW_LEVEL))


def open_path(
    session: Session, path: str | Path, *, replace: bool = False, anyway: bool = False
) -> bool:
    """Open a level file in a tab, or bring the tab that shows it to the front.

    Args:
        session: The app.
        path: A file, or the name of a bundled level.
        replace: Show it in the tab in front, when that one has no unsaved changes.
        anyway: Open it also when another window has it open; otherwise a question comes first.

    Returns:
        Whether it is open now, or asked about; otherwise a window shows why.
    """
    try:
        document = files.open_document(path, session.old_names)
    except LevelError as error:
        title, shown = "This cannot be opened", files.told_plainly(path, error)
        tell(session, title, shown, logged=files.why_not(path, error))
        return False
    with session.guard():
        assert document.path is not None
        index = session.tabs.locate(document.path)
        if index is not None:
            session.gallery.open = False
            session.show_tab(index)
            return True
        if not anyway and open_elsewhere(session, document.path):
            _ask_elsewhere(session, document, replace=replace)
            return True
        if replace and not session.document.dirty and not session.tab.document.dirty:
            session.leave_play()
            session.tab.document, session.tab.moment = document, None
        else:
            session.open_tab(document)
        session.settings.remember(document.path)
        if document.warnings:
            count = len(document.warnings)
            more = f" (and {count - 1} more, see the log)" if count > 1 else ""
            session.toast(f"{document.path.name}: {document.warnings[0]}{more}", "warning")
            for warning in document.warnings[1:]:
                session.log.add(warning)
        return True
    return False


def open_in_front(session: Session, path: str | Path, *, replace: bool = False) -> bool:
    """Open a level file; whether it is in front now, and not only asked about.

    Args:
        session: The app.
        path: A file, or the name of a bundled level.
        replace: Show it in the tab in front, when that one has no unsaved changes.
    """
    if not open_path(session, path, replace=replace):
        return False
    here = session.document.path
    return here is not None and here.resolve() == resolve_path(path).resolve()


def bring(session: Session, level: Level) -> None:
    """Show a level: in front, in another tab, or in a new one."""
    wanted = level_hash(level)
    if session.document.hash == wanted:
        return
    tabs = list(session.tabs)
    found = [tab for tab in tabs if tab.moment is None and tab.document.hash == wanted]
    found.sort(key=lambda tab: tab.document.path is None)  # one that has a file first
    if found:
        session.show_tab(tabs.index(found[0]))
    else:
        session.open_tab(Document(level))


def open_elsewhere(session: Session, path: Path) -> bool:
    """Return whether another window has a file open; the app's own are open to everybody."""
    return not filing.bundled(path) and session.autosaves.open_elsewhere(path)


def _ask_elsewhere(session: Session, document: Document, *, replace: bool) -> None:
    """Warn before two windows change one file."""
    path = document.path
    assert path is not None

    def answer(choice: str) -> None:
        if choice == "open":
            open_path(session, path, replace=replace, anyway=True)
        elif choice == "copy":
            session.open_tab(Document(document.level, format=document.format))

    session.ask(
        Question(
            title=f"{path.name} is open in another window",
            message="What both windows save goes to the same file.",
            choices=(
                Choice(id="copy", label="Open a Copy", detail="With a file name of its own."),
                Choice(id="open", label="Open Anyway"),
                Choice(id="cancel", label="Cancel"),
            ),
            default="copy",
            cancel="cancel",
            answer=answer,
        )
    )


def tell(session: Session, title: str, message: str, *, logged: str = "") -> None:
    """Show why something failed until it is read, several in one window; the log has `logged`."""
    session.log.add(logged or message)
    shown = message if len(message) <= MESSAGE_LENGTH else f"{message[:MESSAGE_LENGTH]}…"
    for prompt in session.prompts:
        if isinstance(prompt, Question) and prompt.title == title:
            session.prompts.remove(prompt)
            if len(prompt.message) < 3 * MESSAGE_LENGTH:
                shown = f"{prompt.message}\n\n{shown}"
            break
    session.ask(
        Question(
            title=title,
            message=shown,
            choices=(Choice(id="ok", label="OK"),),
            default="ok",
            cancel="ok",
            answer=lambda choice: None,
        )
    )


def ask_open(session: Session) -> None:
    """Choose a file and open it."""

    def answer(path: Path | None) -> None:
        if path is not None:
            open_path(session, path)

    session.ask(
        FileQuestion(
            purpose="open",
            title="Open level",
            folder=folders.to_open(session),
            suffixes=files.LEVEL_SUFFIXES,
            answer=answer,
        )
    )


def save(session: Session, then: Callable[[], None] | None = None) -> None:
    """Save in the tab's format; asks about losses, and for a name where there is none to use."""
    _no_moment(session)
    document = session.document
    if document.path is None or filing.bundled(document.path):
        save_as(session, then)
    else:
        elsewhere = functools.partial(save_as, session, then, document.path)
        save_with_care(session, document, document.path, document.format, then, failed=elsewhere)


def _no_moment(session: Session) -> None:
    """Refuse to save a paused episode over the level.

    Raises:
        CommandError: A paused episode is being changed.
    """
    if session.tab.moment is not None:
        raise CommandError(
            "This is a moment of an episode: keep it as the level's start or drop it, then save."
        )


def save_as(
    session: Session,
    then: Callable[[], None] | None = None,
    wish: Path | None = None,
    error: str = "",
) -> None:
    """Save under a name that the user chooses.

    Args:
        session: The app.
        then: What comes after it is saved.
        wish: The file to propose: one that could not be written.
        error: Why not.
    """
    _no_moment(session)
    document = session.document
    folder, title = folders.to_save(session), "Save level as"
    name = document.path.name if document.path else f"{_stem(document.level.name)}.json"
    if document.path is not None and filing.bundled(document.path):
        title = f"{name} came with the app: save a copy of your own"
        name = filing.free_path(folder / name).name
    if wish is not None and os.path.isdir(wish.parent):
        folder, name = wish.parent, wish.name
        if not os.access(folder, os.W_OK):
            folder = user_levels_dir()
            name = filing.free_path(folder / name).name
        elif os.path.isfile(wish) and not os.access(wish, os.W_OK):
            name = filing.free_path(wish).name

    def answer(path: Path | None) -> None:
        if path is not None:
            target = path if path.suffix else path.with_name(f"{path.name}.json")
            again = functools.partial(save_as, session, then, target)
            save_with_care(session, document, target, document.format, then, failed=again)

    session.ask(
        FileQuestion(
            purpose="save",
            title=title,
            folder=folder,
            name=name,
            suffixes=files.LEVEL_SUFFIXES,
            answer=answer,
            error=error.replace(str(wish), wish.name, 1) if wish is not None else "",
        )
    )


def _stem(name: str) -> str:
    kept = "".join(c if c.isalnum() or c in "-_ " else "" for c in name).strip()
    return kept.replace(" ", "_").lower() or "level"


def save_with_care(
    session: Session,
    document: Document,
    path: Path,
    format: Format,
    then: Callable[[], None] | None = None,
    *,
    failed: Callable[[str], None],
) -> None:
    """Save, after asking when that would lose another program's change or what the format lacks.

    Args:
        session: The app.
        document: What to save.
        path: The file.
        format: The format to write.
        then: What comes after it is saved.
        failed: Takes the reason where it could not be.
    """

    def save_to(target: Path) -> None:
        _save_in_format(session, document, target, format, then, failed)

    if files.conflicts(document, path):
        save_conflict.ask(session, document, path, save_to, then)
    else:
        save_to(path)


def _save_in_format(
    session: Session,
    document: Document,
    path: Path,
    format: Format,
    then: Callable[[], None] | None,
    failed: Callable[[str], None],
) -> None:
    """Save, after asking when the format cannot say everything (IO10)."""

    def save_as_format(chosen: Format) -> None:
        reason = save_now(session, document, path, chosen)
        if reason:
            session.log.add(reason)
            failed(reason)
        elif then is not None:
            then()

    lost = files.lost_on_save(document.level, path, format)
    if not lost:
        save_as_format(format)
        return

    def answer(choice: str) -> None:
        if choice != "cancel":
            save_as_format("kinetix-level" if choice == "native" else format)

    session.ask(
        Question(
            title="The file's format cannot hold everything",
            message=f"The format of {path.name} has no place for: {', '.join(lost)}.",
            choices=(
                Choice(id="native", label="Save as kinetix-level"),
                Choice(id="anyway", label="Save anyway"),
                Choice(id="cancel", label="Cancel"),
            ),
            default="native",
            cancel="cancel",
            answer=answer,
        )
    )


def save_now(session: Session, document: Document, path: Path, format: Format) -> str:
    """Save without asking; returns why it could not be saved, empty where it was."""
    named = document.level.size
    try:
        files.save_document(document, path, format)
    except LevelError as error:
        return str(error)
    if document.level.size != named:
        session.toast(f"The level does not fit size {named}: its size is automatic now.", "warning")
    session.settings.remember(path)
    if not filing.bundled(path):
        session.settings.save_folder = str(path.resolve().parent)
    if format == "kinetix-level":
        with session.guard():
            session.old_names.drop(path)
    session.toast(f"Saved {path.name}", "success")
    return ""


def if_settled(session: Session, tab: Tab, then: Callable[[], None]) -> None:
    """Go on with `then` once a tab's changes are saved or given up (IO4)."""
    document = tab.document
    if tab.moment is not None and tab.moment.changed:
        ask_moment(session, tab, lambda: if_settled(session, tab, then))
        return
    external_change.note_lost(session, document)
    if not document.dirty:
        if document.origin:  # restored, and all of it undone or saved: it is not offered again
            session.autosaves.forget(document)
        then()
        return

    def answer(choice: str) -> None:
        if choice != "cancel":
            session.leave_moment(tab)
        if choice == "save":
            session.show_tab(session.tabs.index(tab))
            save(session, then)
        elif choice == "discard":
            session.autosaves.forget(document)
            then()

    session.ask(
        Question(
            title="Unsaved changes",
            message=f"Save the changes to {document.title} before closing?",
            choices=(
                Choice(id="save", label="Save"),
                Choice(id="discard", label="Don't Save"),
                Choice(id="cancel", label="Cancel"),
            ),
            default="save",
            cancel="cancel",
            answer=answer,
        )
    )


def ask_moment(session: Session, tab: Tab, then: Callable[[], None]) -> None:
    """Ask what shall become of a paused episode that was changed, and go on unless cancelled."""

    def answer(choice: str) -> None:
        if choice == "cancel":
            return
        if choice == "keep":
            session.show_tab(session.tabs.index(tab))
            moment.keep(session)
        session.leave_moment(tab)
        then()

    session.ask(
        Question(
            title="A paused episode was changed",
            message=f"Shall {tab.document.title} start from what was changed in its episode?",
            choices=(
                Choice(id="keep", label="Keep as Start"),
                Choice(id="drop", label="Drop the Changes"),
                Choice(id="cancel", label="Cancel"),
            ),
            default="keep",
            cancel="cancel",
            answer=answer,
        )
    )


def close_tab(session: Session, tab: Tab | None = None) -> None:
    """Close a tab, the one in front by default; asks when it has unsaved changes."""
    closing = tab or session.tab
    if_settled(session, closing, lambda: session.close_tab(closing))
