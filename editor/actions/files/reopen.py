"""The levels that were open when the app closed last: noted at an orderly end, opened again."""

from pathlib import Path

from editor.actions.files.file import open_elsewhere
from editor.documents import files
from editor.session import Session
from kinetix.errors import LevelError
from kinetix.files.names import is_text


def note(session: Session) -> None:
    """Keep in the settings which level files are open, and which of them is in front."""
    paths = [tab.document.path for tab in session.tabs]
    names = [str(path.resolve()) for path in paths if path is not None and is_text(path)]
    front = session.tab.document.path
    front_file = "" if front is None else str(front.resolve())
    session.settings.open_files = names
    session.settings.front_file = front_file if front_file in names else ""


def reopen(session: Session) -> bool:
    """Open what was open at the last end; whether anything is.

    What is noted is forgotten first: where the app crashes, the next start opens none of it.
    """
    settings = session.settings
    names, front = settings.open_files, settings.front_file
    settings.open_files, settings.front_file = [], ""
    with session.guard():
        session.keeper.save()
    lost = []
    for name in dict.fromkeys(names):
        with session.guard():
            path = Path(name)
            try:
                if not open_elsewhere(session, path):
                    open_quietly(session, path)
            except LevelError as error:
                session.log.add(str(error))
                lost.append(path.name)
    if lost:
        told = ", ".join(lost)
        session.toast(f"Open last time, but gone or no longer readable: {told}", "warning")
    with session.guard():
        index = session.tabs.locate(Path(front)) if front else None
        if index is not None:
            session.show_tab(index)
    return any(tab.document.path is not None for tab in session.tabs)


def open_quietly(session: Session, path: Path) -> None:
    """Open a level that nobody chose just now: the recent files stay as they are.

    Raises:
        LevelError: The file is gone or bad.
    """
    document = files.open_document(path, session.old_names)
    for warning in document.warnings:
        session.log.add(warning)
    session.open_tab(document)
