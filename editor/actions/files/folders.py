"""Folders that file dialogs begin in."""

import os
from pathlib import Path

from editor.gallery import filing
from editor.session import Session
from kinetix.paths import levels_dir, user_levels_dir, working_dir


def to_open(session: Session) -> Path:
    """Return that of the level in front, or of the newest that is still there."""
    if session.document.path is not None:
        return session.document.path.parent
    recent = next((Path(p).parent for p in session.settings.recents if os.path.exists(p)), None)
    return recent or levels_dir()


def to_save(session: Session) -> Path:
    """Return the proposed folder for a level: one of the user's own that is there."""
    path = session.document.path
    if path is not None and not filing.bundled(path) and os.path.isdir(path.parent):
        return path.parent
    last = Path(session.settings.save_folder)
    own = last.is_absolute() and os.path.isdir(last) and not filing.bundled(last)
    return last if own else user_levels_dir()


def to_export(session: Session) -> Path:
    """Return the proposed folder for what is made of a level: the level's, else the last one used.

    A folder that is gone, with a disk that was removed, is not made again.

    A script's is the one that it was started from.
    """
    path = session.document.path
    if path is not None and not filing.bundled(path) and os.path.isdir(path.parent):
        return path.parent.absolute()
    if not session.attended:
        return working_dir()
    last = Path(session.settings.export_folder)
    return last if last.is_absolute() and os.path.isdir(last) else user_levels_dir()
