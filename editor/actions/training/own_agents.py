"""Agents that were trained here: go on with their training, rename them, delete them."""

import contextlib
import functools
import os
import tomllib
import unicodedata
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any, Final

from editor.actions.evaluation.measure import add_contender
from editor.actions.watching.agents import (
    LONGEST_NAME,
    RECENT_AGENTS,
    clear_slot,
    load_agent,
)
from editor.actions.watching.watch import watch_run
from editor.agents.folders import agents_in, checkpoints_of
from editor.agents.local_training import BUSY
from editor.base.prompts import Choice, MenuQuestion, TextQuestion
from editor.gallery import filing
from editor.session import Session
from kinetix.errors import CommandError, LevelError
from kinetix.files.lock import locked_folder
from kinetix.paths import user_agents_dir
from kinetix.wording import plural, thousands

_CONFIG: Final = "config.toml"
_STEPS: Final = "total_timesteps"


def own_agents() -> list[Path]:
    """Return the folders of all agents that were trained here, by name."""
    return agents_in(user_agents_dir())


def go_on(session: Session) -> None:
    """Ask which training to go on with; one that is through learns for as long again."""
    runs = [folder for folder in own_agents() if os.path.isfile(folder / _CONFIG)]
    _ask(session, "Go on training", runs, functools.partial(_go_on, session))


def _go_on(session: Session, run: Path) -> None:
    if session.training.running:
        raise CommandError(BUSY)
    with _held(session, run):
        config = _config(run)
    algorithm, steps = str(config.get("algorithm", "ppo")), _steps_wanted(run, config)
    session.training.go_on(run, algorithm, steps)
    watch_run(session, str(run))
    session.messages.toast(
        f"{run.name} goes on learning: F6 plays its newest attempt.",
        holds=lambda: session.training.running,
    )


def _config(run: Path) -> dict[str, Any]:
    try:
        return tomllib.loads((run / _CONFIG).read_text(encoding="utf-8"))
    except (OSError, ValueError) as error:
        raise CommandError(f"{run / _CONFIG}: cannot be read: {error}") from error


def _steps_wanted(run: Path, config: dict[str, Any]) -> int | None:
    """Return how many steps a run shall have made in all; None: as many as it was begun for.

    A run ends with its last whole update, which may be short of the steps that were asked for.
    """
    values = [config.get(name) for name in (_STEPS, "num_train_envs", "num_steps")]
    total, worlds, steps = (value if isinstance(value, int) else 0 for value in values)
    if not total:
        raise CommandError(f"{run / _CONFIG}: {_STEPS}: expected a whole number above 0")
    checkpoints = checkpoints_of(run)
    made = int(checkpoints[-1].name) if checkpoints else 0
    return 2 * total if made > total - max(worlds * steps, 1) else None


def rename(session: Session) -> None:
    """Ask which agent to rename, then for its name."""

    def chosen(folder: Path) -> None:
        def answer(name: str | None) -> None:
            if name is None:
                return
            try:
                target = _renamed(folder, name)
            except CommandError as error:  # what was typed is still there to be mended
                session.toast(str(error), "error")
                ask(name)
            else:
                _rename(session, folder, target)

        def ask(text: str) -> None:
            title = f"New name of {folder.name}"
            session.ask(TextQuestion(title=title, text=text, accept="Rename", answer=answer))

        ask(folder.name)

    _ask(session, "Rename an agent", own_agents(), chosen)


def _renamed(folder: Path, name: str) -> Path:
    """Return where a folder of this name is.

    Raises:
        CommandError: No folder can have it, or another has it.
    """
    target = folder.with_name(_checked(name))
    if target != folder and os.path.lexists(target) and not os.path.samefile(target, folder):
        raise CommandError(f"{target}: something of this name is there already.")
    return target


def _rename(session: Session, folder: Path, target: Path) -> None:
    if target == folder:
        return
    with _held(session, folder):
        try:
            os.rename(folder, target)
        except OSError as error:
            raise CommandError(f"{folder}: cannot be renamed: {error.strerror or error}") from error
    _moved(session, folder, target)
    session.toast(f"{folder.name} is called {target.name} now.", "success")


def _checked(name: str) -> str:
    """Return a name as a folder has it."""
    plain = unicodedata.normalize("NFC", " ".join(name.split()))
    odd = {"/", "\\", ":"}.intersection(plain) or not plain.isprintable()
    if not 1 <= len(plain) <= LONGEST_NAME or odd or plain[0] == "." or plain[-1] == ".":
        raise CommandError(
            f"The name {name!r} cannot be used: it needs 1 to {LONGEST_NAME} characters that can "
            "be seen, none of them / \\ or a colon, and no dot at either end."
        )
    return plain


def delete(session: Session) -> None:
    """Ask which agent to delete, and move it to the trash."""
    _ask(session, "Delete an agent", own_agents(), functools.partial(_delete, session))


def _delete(session: Session, folder: Path) -> None:
    with _held(session, folder):
        session.viewer.deleted.append(filing.throw_away(folder))
    _moved(session, folder, None)
    session.toast(f"Moved {folder.name} to the trash", action="agent.restore")


def restore(session: Session) -> None:
    """Bring back the agent that was deleted last; one that cannot come back waits behind others."""
    thrown = session.viewer.deleted.pop()
    try:
        filing.bring_back(thrown)
    except LevelError:
        session.viewer.deleted.insert(0, thrown)
        raise
    session.toast(f"{thrown.origin.name} is back.", "success")


def _moved(session: Session, before: Path, after: Path | None) -> None:
    """Follow an agent that is elsewhere now, or let go of one that is gone."""
    viewer, settings = session.viewer, session.settings
    old = before.resolve()

    def now(path: str) -> str | None:
        """Return where a path leads now; None where it leads nowhere."""
        whole = Path(path).resolve()
        if not path or not whole.is_relative_to(old):
            return path
        return None if after is None else str(after / whole.relative_to(old))

    for slot, place in viewer.slots.items():
        path = now(place.path)
        if path is None:
            clear_slot(session, slot)
            viewer.compare = "off" if slot == "b" else viewer.compare
        elif path != place.path:
            load_agent(session, path, slot)
    for watched in (viewer.run, *viewer.other_runs):
        path = now(watched.path)
        if path != watched.path:
            watched.watch(path or "")
    viewer.other_runs = tuple(other for other in viewer.other_runs if other.path)
    measured = [(one, now(one.ref.path)) for one in viewer.contenders]
    viewer.contenders = tuple(one for one, path in measured if path == one.ref.path)
    for one, path in measured:
        if path is not None and path != one.ref.path:
            add_contender(session, path)
    recents = [now(path) for path in settings.recent_agents]
    settings.recent_agents = [path for path in recents if path is not None][:RECENT_AGENTS]


@contextlib.contextmanager
def _held(session: Session, folder: Path) -> Iterator[None]:
    """Hold the lock of a folder in which nobody trains: neither this app nor another process."""
    busy = f"{folder.name} is learning just now: stop it in the Training panel."
    if session.training.running and session.training.run == folder:
        raise CommandError(busy)
    try:
        with locked_folder(folder, "another training"):
            yield
    except OSError as error:
        raise CommandError(f"{folder}: {error.strerror or error}") from error


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
    steps = thousands(int(checkpoints[-1].name))
    return f"{plural(len(checkpoints), 'checkpoint')}, {steps} steps"
