"""Closing the app: nothing unsaved, and nothing that is being written, is lost without a word."""

import contextlib
from collections.abc import Iterator
from typing import Final

from editor.actions.evaluation.measure import keep_results
from editor.actions.files import export, external_change, recording
from editor.actions.files.file import ask_moment, if_settled, save
from editor.actions.gallery import many_files
from editor.base.prompts import Choice, Question
from editor.session import Session, Tab
from editor.worker.requests import AddEpisode
from kinetix.errors import LevelError
from kinetix.level.model import Level

MOST_NAMES: Final = 12
"""So many are listed in a question."""


def quit_app(session: Session) -> None:
    """End the app, after asking once about everything that has unsaved changes."""
    session.driver.cancel()
    if session.closing.question in session.prompts:
        return
    with _leaving(session):
        _settle(session)


@contextlib.contextmanager
def _leaving(session: Session) -> Iterator[None]:
    """Mark the question that is asked inside, so that closing twice does not ask it twice."""
    before = len(session.prompts)
    yield
    if len(session.prompts) > before:
        session.closing.question = session.prompts[-1]


def _settle(session: Session) -> None:
    """Ask about everything that has unsaved changes, then close the app."""
    changed = next((tab for tab in session.tabs if tab.moment and tab.moment.changed), None)
    if changed is not None:
        ask_moment(session, changed, lambda: quit_app(session))
        return
    external_change.note_lost(session, *session.tabs.documents)
    unsaved = [tab for tab in session.tabs if tab.document.dirty]
    if len(unsaved) < 2:
        if_settled(session, unsaved[0] if unsaved else session.tab, lambda: _quit(session))
        return

    def answer(choice: str) -> None:
        if choice == "save":
            _save_all(session, unsaved)
        elif choice == "discard":
            for tab in unsaved:
                session.autosaves.forget(tab.document)
            _quit(session)

    names = _listed([tab.document.title for tab in unsaved])
    session.ask(
        Question(
            title="Save before closing?",
            message=f"These have unsaved changes:\n{names}",
            choices=(
                Choice(id="save", label="Save All"),
                Choice(id="discard", label="Discard All"),
                Choice(id="cancel", label="Cancel"),
            ),
            default="save",
            cancel="cancel",
            answer=answer,
        )
    )


def update_leaving(session: Session) -> None:
    """Let a frame pass: the app closes once all files are written that it was to wait for.

    What was changed during the wait is asked about.
    """
    if session.closing.waits_with is None or _going_on(session):
        return
    unchanged, session.closing.waits_with = session.closing.waits_with == _levels(session), None
    if unchanged:
        _leave(session)
    else:
        quit_app(session)


def _levels(session: Session) -> tuple[Level, ...]:
    return tuple(tab.document.level for tab in session.tabs)


def _listed(names: list[str]) -> str:
    more = [f"{len(names) - MOST_NAMES} more"] * (len(names) > MOST_NAMES)
    return "\n".join([*names[:MOST_NAMES], *more])


def _save_all(session: Session, remaining: list[Tab]) -> None:
    """Save one after the other, asking what each needs; then quit."""
    remaining = [tab for tab in remaining if tab in session.tabs and tab.document.dirty]
    if not remaining:
        _quit(session)
        return
    session.leave_moment(remaining[0])
    session.show_tab(session.tabs.index(remaining[0]))
    save(session, lambda: _save_all(session, remaining[1:]))


def _quit(session: Session) -> None:
    """Close the app; a film under way is ended, and what is not complete is asked about."""
    with _leaving(session):
        _finish(session)


def _finish(session: Session) -> None:
    if session.films.recording is not None and session.films.recording.films():
        try:
            recording.end(session)
        except LevelError as error:
            recording.ask_to_drop(
                session,
                error,
                title="Close without the film?",
                drop=Choice(id="quit", label="Close Without It"),
                keep=Choice(id="cancel", label="Cancel"),
                then=lambda: _quit(session),
            )
            return
    going_on = _going_on(session)
    if not going_on:
        _leave(session)
        return

    def answer(choice: str) -> None:
        if choice == "wait":
            session.closing.waits_with = _levels(session)
            session.toast("Closing when that is done.")
        elif choice == "quit":
            _leave(session)

    session.ask(
        Question(
            title="Wait for unfinished work?",
            message=f"These are not complete yet:\n{_listed(going_on)}",
            choices=(
                Choice(id="wait", label="Wait, Then Close"),
                Choice(id="quit", label="Close Without Them"),
                Choice(id="cancel", label="Cancel"),
            ),
            default="wait",
            cancel="cancel",
            answer=answer,
        )
    )


def _going_on(session: Session) -> list[str]:
    """Return what would be lost: files that are not written yet, an evaluation."""
    evaluation = session.viewer.evaluation
    names = ["the evaluation"] if evaluation.running else []
    exporting = session.gallery.exporting
    names += [] if exporting is None else [exporting.name]
    names += [] if session.gallery.work is None else [session.gallery.work.title]
    names += [film.path.name for film in session.films.unwritten]
    for job in session.worker.jobs:
        path = export.file_of(job)
        if path is not None:
            names.append(path.name)
        elif isinstance(job.request, AddEpisode):
            names.append(job.request.folder.name)
    return names


def _leave(session: Session) -> None:
    with session.guard():
        session.autosaves.follow(session.tabs.documents)
    for tab in session.tabs:
        document = tab.document
        # While the app asked and waited, what is not to be saved was copied again.
        if document.dirty and document.given_up is document.committed:
            session.autosaves.forget(document)
    with session.guard():
        session.keeper.save(again=True)
    with session.guard():
        many_files.stop(session)
    session.viewer.evaluation.cancel()
    with session.guard():
        keep_results(session)
    with session.guard():
        session.results.flush()
    with session.guard():
        session.kept_set.keep(session.gallery.tray, again=True)
    session.training.stop()  # It saves; the command line can go on with it.
    session.closing.done = True
