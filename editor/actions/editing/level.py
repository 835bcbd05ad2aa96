"""Actions of the Level menu: random levels, mutations, neighbours in the folder, quick fixes."""

import os
from collections.abc import Callable
from pathlib import Path

from editor.actions.files.file import open_in_front
from editor.actions.watching.agents import play_agent
from editor.base.prompts import Choice, MenuQuestion
from editor.base.wording import title_of
from editor.documents.commands.base import Command
from editor.documents.commands.level import Permute, ReplaceLevel
from editor.documents.document import Document, same_simulation
from editor.session import Session
from editor.worker.jobs import Job, JobState
from editor.worker.requests import MUTATIONS, Mutate, RandomLevel, Request
from kinetix.errors import CommandError, LevelError
from kinetix.level.codec import load_document
from kinetix.level.model import Level
from kinetix.level.sets import is_set_file
from kinetix.level.sizes import AUTOMATIC, capacity_of, size_name
from kinetix.level.validate import has_errors


def random_level(session: Session) -> None:
    """Open a random level in a tab of its own; every call takes the next seed.

    One that nobody has changed gives its tab to the next.
    """
    size = size_name(capacity_of(session.document.level)) or "l"
    _draw(session, RandomLevel(seed=session.seed + 1, size=size), "Random")


def random_machine(session: Session) -> None:
    """Open a level with a random machine and a task for it, like `random_level`."""
    size = size_name(capacity_of(session.document.level))
    size = size if size in AUTOMATIC else "l"
    _draw(session, RandomLevel(seed=session.seed + 1, size=size, machine=True), "Machine")


def _draw(session: Session, request: RandomLevel, title: str) -> None:
    session.seed = request.seed

    def done(job: Job) -> None:
        if job.state is JobState.FAILED:
            session.toast(job.error, "error")
        elif job.state is JobState.DONE:
            level: Level = job.result
            document = Document(level.replace(name=f"{title} {request.seed}"))
            document.drawn = True
            if session.tab.untouched and session.tab.document.drawn:
                session.leave_play()
                session.tab.document = document
            else:
                session.open_tab(document)

    session.worker.submit(request, title="Drawing a random level", urgent=True, done=done)


def mutate(mutation: str | None) -> Callable[[Session], None]:
    """Return an action that changes the level at random; None takes any mutation."""

    def run(session: Session) -> None:
        session.seed += 1
        request = Mutate(level=session.document.level, mutation=mutation, seed=session.seed)
        name = "Mutate" if mutation is None else dict(MUTATIONS)[mutation]
        replace_later(
            session,
            request,
            title=name,
            command=lambda level: ReplaceLevel(level=level, label=name),
        )

    return run


def try_out(session: Session) -> None:
    """Find out in the background what happens without a plan (I301, I302)."""
    session.view.front = "problems"
    session.trial.start(session.document.level, session.playback.physics)


def can_try_out(session: Session) -> bool:
    """Return whether there is a level that the environment can play."""
    document = session.document
    return bool(document.level.bodies) and not has_errors(document.problems)


def permute(session: Session) -> None:
    """Put the entities in a random order of slots; every call takes the next seed."""
    session.seed += 1
    session.execute(Permute(seed=session.seed))


def mutate_menu(session: Session) -> None:
    """Choose a mutation from a list."""

    def answer(choice: str | None) -> None:
        if choice is not None:
            mutate(choice)(session)

    choices = tuple(Choice(id=name, label=label) for name, label in MUTATIONS)
    session.ask(MenuQuestion(title="Mutate", choices=choices, at=None, answer=answer))


def replace_later(
    session: Session, request: Request, *, title: str, command: Callable[[Level], Command]
) -> None:
    """Ask the worker for a level and put it in when it comes, unless the document has changed.

    It waits for the end of a gesture, and of play: what is seen there stays as it is.
    """
    document, before = session.document, session.document.level

    def put_in(level: Level, *, waited: bool = False) -> None:
        here = document is session.document
        if here and (session.driver.active or not session.editing):
            later = waited or not session.editing
            session.queue(lambda: put_in(level, waited=later))
        elif document not in session.tabs.documents:
            return
        elif document.level != before:
            session.complain(f"{title}: the level has changed meanwhile; try again.")
        elif same_simulation(level, before):
            session.complain(f"{title}: nothing was changed; try again.")
        elif session.execute(command(level), on=document).changed and (waited or not here):
            session.toast(f"{title}: {title_of(document.level)} was changed.")

    def done(job: Job) -> None:
        if job.state is JobState.FAILED:
            session.toast(job.error, "error")
        elif job.state is JobState.DONE:
            put_in(job.result)

    session.worker.submit(request, title=title, urgent=True, done=done)


def neighbour(step: int) -> Callable[[Session], None]:
    """An action that opens the next or previous level of the same folder; an agent plays on."""

    def run(session: Session) -> None:
        path = session.document.path
        if path is None:
            raise CommandError("Save the level first: it has no folder yet.")
        target, damaged = _nearest_level(path, step)
        if damaged:
            session.toast(
                f"{', '.join(damaged)}: cannot be opened, and was passed over.", "warning"
            )
        if target is None:
            raise CommandError("There is no other level in this folder.")
        playback = session.playback
        watched = playback.active and playback.casting is not None and not session.viewer.by_hand
        if open_in_front(session, target, replace=True) and watched:
            play_agent(session)

    return run


def _nearest_level(path: Path, step: int) -> tuple[Path | None, list[str]]:
    """Return the first other level of a folder in one direction, and the bad files before it."""
    files = sorted(each for each in path.parent.glob("*.json") if os.path.isfile(each))
    resolved = [each.resolve() for each in files]
    here = resolved.index(path.resolve()) if path.resolve() in resolved else 0
    damaged: list[str] = []
    for k in range(1, len(files)):
        target = files[(here + k * step) % len(files)]
        try:
            load_document(target)
        except LevelError:
            if not is_set_file(target):
                damaged.append(target.name)
        else:
            return target, damaged
    return None, damaged
