"""Work on many files of the gallery: some of it in every frame, with a way to stop it."""

import time
from collections.abc import Generator
from typing import Final

from editor.gallery.view import FileWork
from editor.session import Session
from kinetix.errors import CommandError

AT_ONCE: Final = 50
"""So few files are done with in the frame that asks for it."""
BUSY: Final = "Wait until the files before are done with, or stop that: Esc."
"""Refusal while other files are being worked on."""
_SLICE: Final = 0.03
"""The part of a frame that the work may take [s]."""


def begin(session: Session, title: str, total: int, steps: Generator[None]) -> None:
    """Do something to files: at once if they are few, else a part in every frame.

    Args:
        session: The app.
        title: What is done, for the line at the bottom.
        total: How many files there are.
        steps: Does one file a step; its `finally` tells what was done, also where it is stopped.

    Raises:
        CommandError: Other files are still worked on.
    """
    if session.gallery.work is not None:
        raise CommandError(BUSY)
    session.gallery.work = FileWork(title=title, total=total, steps=steps)
    _go_on(session, float("inf") if total <= AT_ONCE else _SLICE)


def go_on(session: Session) -> None:
    """Do the part of a frame, if there is something to do."""
    _go_on(session, _SLICE)


def _go_on(session: Session, seconds: float) -> None:
    work = session.gallery.work
    if work is None:
        return
    until = time.monotonic() + seconds
    session.gallery.work = None  # What it raises ends it.
    for _ in work.steps:
        work.done += 1
        if time.monotonic() >= until:
            session.gallery.work = work
            return


def working(session: Session) -> bool:
    """Return whether files are worked on."""
    return session.gallery.work is not None


def stop(session: Session) -> None:
    """Leave the other files as they are."""
    work, session.gallery.work = session.gallery.work, None
    if work is not None:
        work.steps.close()
