"""Agents that were trained here: go on with their training, rename them, delete them."""

import functools
import os
import tomllib
from collections.abc import Callable
from pathlib import Path
from typing import Final

from editor.actions.agents import checkpoints_of, clear_slot, is_agent_folder, load_agent
from editor.actions.watch import watch_run
from editor.base.prompts import Choice, MenuQuestion, TextQuestion
from editor.gallery import filing
from editor.session import Session
from kinetix.errors import CommandError
from kinetix.paths import user_agents_dir
from kinetix.wording import plural

_CONFIG: Final = "config.toml"
_STEPS: Final = "total_timesteps"
_LONGEST: Final = 60


def own_agents() -> list[Path]:
    """Return the folders of all agents that were trained here, by name."""
    return sorted(folder for folder in user_agents_dir().glob("*") if is_agent_folder(folder))


def go_on(session: Session) -> None:
    """Ask which training to go on with; one that is through learns for as long again."""
    runs = [folder for folder in own_agents() if os.path.isfile(folder / _CONFIG)]
    _ask(session, "Go on training", runs, functools.partial(_go_on, session))


def _go_on(session: Session, run: Path) -> None:
    if session.training.running:
        raise CommandError("An agent is being trained already: stop it in the Training panel.")
    session.training.go_on(run, _steps_wanted(run))
    watch_run(session, str(run))
    session.toast(f"{run.name} goes on learning: F6 plays its newest attempt.", "success")


def _steps_wanted(run: Path) -> int | None:
    """Return how many steps a run shall have made in all; None: as many as it was begun for."""
    try:
        config = tomllib.loads((run / _CONFIG).read_text(encoding="utf-8"))
        total = int(config[_STEPS])
    except (OSError, ValueError, KeyError, TypeError) as error:
        raise CommandError(f"{run / _CONFIG}: cannot be read: {error}") from error
    checkpoints = checkpoints_of(run)
    made = int(checkpoints[-1].name) if checkpoints else 0
    return 2 * total if made >= total else None


def rename(session: Session) -> None:
    """Ask which agent to rename, then for its name."""

    def chosen(folder: Path) -> None:
        def answer(name: str | None) -> None:
            if name is not None:
                _rename(session, folder, name)

        title = f"New name of {folder.name}"
        session.ask(TextQuestion(title=title, text=folder.name, accept="Rename", answer=answer))

    _ask(session, "Rename an agent", own_agents(), chosen)


def _rename(session: Session, folder: Path, name: str) -> None:
    _refuse_while_training(session, folder)
    plain = " ".join(name.split())
    if not plain or len(plain) > _LONGEST or Path(plain).name != plain or plain.startswith("."):
        raise CommandError(
            f"The name {name!r} cannot be used: it needs 1 to {_LONGEST} characters, no slash "
            "and no dot at its beginning."
        )
    target = folder.with_name(plain)
    if target == folder:
        return
    if os.path.lexists(target):
        raise CommandError(f"{target}: there is an agent of this name already.")
    try:
        os.rename(folder, target)
    except OSError as error:
        raise CommandError(f"{folder}: cannot be renamed: {error.strerror or error}") from error
    _moved(session, folder, target)
    session.toast(f"{folder.name} is called {plain} now.", "success")


def delete(session: Session) -> None:
    """Ask which agent to delete, and move it to the trash."""
    _ask(session, "Delete an agent", own_agents(), functools.partial(_delete, session))


def _delete(session: Session, folder: Path) -> None:
    _refuse_while_training(session, folder)
    session.deleted_agents.append(filing.throw_away(folder))
    _moved(session, folder, None)
    session.toast(f"Moved {folder.name} to the trash", action="agent.restore")


def restore(session: Session) -> None:
    """Bring back the agent that was deleted last."""
    thrown = session.deleted_agents[-1]
    filing.bring_back(thrown)
    session.deleted_agents.pop()
    session.toast(f"{thrown.origin.name} is back.", "success")


def _moved(session: Session, before: Path, after: Path | None) -> None:
    """Follow an agent that is elsewhere now, or let go of one that is gone."""
    viewer, settings = session.viewer, session.settings
    for slot, place in viewer.slots.items():
        if place.path and Path(place.path).is_relative_to(before):
            if after is None:
                clear_slot(session, slot)
            else:
                load_agent(session, after / Path(place.path).relative_to(before), slot)
    if viewer.run.path == str(before):
        viewer.run.watch("" if after is None else str(after))
    kept = [path for path in settings.recent_agents if not Path(path).is_relative_to(before)]
    settings.recent_agents = kept if after is None else [str(after), *kept]


def _refuse_while_training(session: Session, folder: Path) -> None:
    if session.training.running and session.training.run == folder:
        raise CommandError(f"{folder.name} is learning just now: stop it in the Training panel.")


def _ask(session: Session, title: str, folders: list[Path], take: Callable[[Path], None]) -> None:
    """Ask which of some agents is meant."""
    if not folders:
        raise CommandError("No agent was trained here yet: Agent ▸ Train on This Level makes one.")

    def answer(choice: str | None) -> None:
        if choice is not None:
            take(Path(choice))

    choices = tuple(
        Choice(id=str(folder), label=folder.name, detail=_learnt(folder)) for folder in folders
    )
    session.ask(MenuQuestion(title=title, choices=choices, at=None, answer=answer))


def _learnt(folder: Path) -> str:
    checkpoints = checkpoints_of(folder)
    if not checkpoints:
        return "an agent"
    steps = f"{int(checkpoints[-1].name):,}".replace(",", " ")
    return f"{plural(len(checkpoints), 'checkpoint')}, {steps} steps"
