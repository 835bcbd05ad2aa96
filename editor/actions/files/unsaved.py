"""Open levels with unsaved changes, where what happens is done with their files."""

import os
from collections.abc import Collection
from typing import Final

from editor.session import Session
from kinetix import wording

_NAMED: Final = 4
"""So many levels are named in a message."""


def unsaved_among(session: Session, paths: Collection[str]) -> list[str]:
    """Return the names of the levels that are open with unsaved changes.

    Args:
        session: The app.
        paths: The files that are asked about.
    """
    documents = [tab.document for tab in session.tabs if tab.document.dirty]
    if not documents:
        return []
    asked = {os.path.abspath(path) for path in paths}
    return [
        document.level.name or document.title
        for document in documents
        if document.path is not None
        and asked & {os.path.abspath(document.path), os.path.realpath(document.path)}
    ]


def listed(names: list[str]) -> str:
    """Return the first names, and how many more there are."""
    return wording.listed(names, _NAMED)


def tell_unsaved(session: Session, paths: Collection[str]) -> None:
    """Report which levels are measured as their files have them, not as they are on the screen."""
    names = unsaved_among(session, paths)
    if names:
        session.toast(f"Measured without their unsaved changes: {listed(names)}", "warning")
