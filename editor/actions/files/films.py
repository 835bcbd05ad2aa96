"""Writing films: one that cannot be written is kept until it is saved elsewhere or dropped."""

import dataclasses
from collections.abc import Callable
from pathlib import Path
from typing import Final

from editor.base.prompts import Choice, FileQuestion, Question
from editor.session import Session
from editor.worker.jobs import Job, JobState
from editor.worker.requests import ExportFilm

SUFFIXES: Final = (".gif", ".mp4")


def write(session: Session, request: ExportFilm, told: Callable[[Job], None]) -> None:
    """Ask the worker for a film.

    Args:
        session: The app.
        request: The film.
        told: Says what became of it.
    """

    def done(job: Job) -> None:
        if job.state is JobState.FAILED:
            session.films.unwritten.append(request)
            _ask(session, request, job.error, told)
        else:
            told(job)

    session.worker.submit(request, title=f"Writing {request.path.name}", done=done)


def _ask(session: Session, request: ExportFilm, reason: str, told: Callable[[Job], None]) -> None:
    """Ask what shall become of a film that could not be written."""
    session.log.add(reason)

    def answer(choice: str) -> None:
        if choice == "elsewhere":
            _ask_path(session, request, reason, told)
            return
        _settled(session, request)
        if choice == "again":
            write(session, request, told)

    session.ask(
        Question(
            title="The film is not written yet",
            message=reason,
            choices=(
                Choice(id="elsewhere", label="Save Elsewhere…"),
                Choice(id="again", label="Try Again"),
                Choice(id="drop", label="Drop the Film"),
            ),
            default="elsewhere",
            cancel="elsewhere",
            answer=answer,
        )
    )


def _settled(session: Session, request: ExportFilm) -> None:
    session.films.unwritten = [film for film in session.films.unwritten if film is not request]


def _ask_path(
    session: Session, request: ExportFilm, reason: str, told: Callable[[Job], None]
) -> None:
    """Ask for another file; without an answer the film is still there."""

    def answer(path: Path | None) -> None:
        if path is None:
            _ask(session, request, reason, told)
            return
        _settled(session, request)
        write(session, dataclasses.replace(request, path=path, numbered=False), told)

    session.ask(
        FileQuestion(
            purpose="save",
            title="Export the clip as .gif or .mp4",
            folder=request.path.parent,
            name=request.path.name,
            suffixes=SUFFIXES,
            answer=answer,
        )
    )
