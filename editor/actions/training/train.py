"""Train an agent on the level in front, or on levels of the gallery: one click, then it plays."""

import contextlib
import os
import re
import shutil
import time
from collections.abc import Callable
from functools import partial
from pathlib import Path
from typing import Final

from editor.actions.evaluation.measure import steps_in
from editor.actions.gallery.gallery import chosen_cards
from editor.actions.watching.agents import LONGEST_NAME, load_agent
from editor.actions.watching.watch import watch_run
from editor.agents.local_training import BUSY, LOG
from editor.base.wording import title_of
from editor.gallery.named_levels import set_name
from editor.session import Session
from editor.worker.requests import BUILT_IN
from kinetix.errors import CommandError
from kinetix.files.lock import locked_folder
from kinetix.files.regular import FileError
from kinetix.level.codec import save_level
from kinetix.level.controls import channels_in_use
from kinetix.level.model import Level
from kinetix.level.sets import LoadedSet, build_set, gather_levels, load_set, save_set
from kinetix.paths import user_agents_dir
from kinetix.wording import plural

MOST_LEVELS: Final = 100
"""More levels are not trained on from here: they are read while the window waits."""

_ABANDONED: Final = 600.0
"""A folder with nothing but a log is in use while the log is younger than this [s]."""


def train_here(session: Session) -> None:
    """Begin to train an agent on the level, in a folder of the user's agents.

    Raises:
        CommandError: The level leaves nothing to learn, or a training is running.
    """
    level = session.document.level
    _refuse_busy(session)
    _refuse_unlearnable(level)
    _train(session, level.name, title_of(level), partial(save_level, level))


def train_chosen(session: Session) -> None:
    """Begin to train one agent on the levels that are chosen in the gallery.

    Raises:
        KinetixError: None is chosen, or one cannot be learnt or read; or a training is on.
    """
    cards = chosen_cards(session)
    told = cards[0].name if len(cards) == 1 else plural(len(cards), "level")
    _refuse_busy(session)
    _refuse_many(len(cards))
    levels = gather_levels([card.path for card in cards])
    _train_on(session, told, build_set(levels, name=told, folder=user_agents_dir(), split=1.0))


def train_on_set(session: Session, path: Path) -> None:
    """Begin to train one agent on a level set, by its weights; its other part is evaluated on.

    Raises:
        KinetixError: The set is bad or has a level that cannot be learnt; or a training is on.
    """
    _refuse_busy(session)
    _train_on(session, set_name(path), load_set(path.resolve()))


def _train_on(session: Session, name: str, levels: LoadedSet) -> None:
    """Begin to train on a copy of a set, which what is done to its files does not change."""
    _refuse_many(len(levels.levels))
    for each in levels.levels:
        _refuse_unlearnable(each.level, f"{each.name}: ")
    _train(session, name, name, partial(save_set, levels, inline=True))
    session.gallery.open = False


def _refuse_busy(session: Session) -> None:
    """Raise the sentence that a training is on, if so."""
    if session.training.running:
        raise CommandError(BUSY)


def _refuse_many(count: int) -> None:
    """Raise the sentence that so many levels are too many, if so."""
    if count > MOST_LEVELS:
        raise CommandError(
            f"{count} levels are too many to train on from here: choose up to {MOST_LEVELS}, or "
            "use kinetix train."
        )


def _refuse_unlearnable(level: Level, before: str = "") -> None:
    """Raise what keeps a level from being learnt, if anything does."""
    arena = level.arena
    walls = (arena.floor, arena.left_wall, arena.right_wall, arena.ceiling)
    if not {"green", "blue"} <= {body.role for body in (*level.bodies, *walls)}:
        raise CommandError(
            f"{before}There is nothing to learn: the level needs a green and a blue shape."
        )
    if not channels_in_use(level):
        raise CommandError(
            f"{before}There is nothing to drive: the level needs a motor or a thruster."
        )


def _train(session: Session, name: str, told: str, write: Callable[[Path], object]) -> None:
    """Begin a training in a new folder, on what is written beside it."""
    run = _free_folder(name)
    try:
        run.parent.mkdir(parents=True, exist_ok=True)
    except OSError as error:
        reason = error.strerror or error
        raise CommandError(f"{run.parent}: cannot be made: {reason}") from error
    file = run.with_suffix(".json")
    write(file)
    session.training.begin(file, run, told)
    watch_run(session, str(run))
    session.viewer.follow_run = True
    session.messages.toast(
        f"Training on {told}: its newest attempt plays with F6 as soon as there is one.",
        "success",
        holds=lambda: session.training.running,
    )


def _free_folder(name: str) -> Path:
    """Return a new folder among the user's agents that is called after a level."""
    plain = re.sub(r"[^\w-]+", "_", name).strip("_")[:LONGEST_NAME] or "level"
    number, folder = 1, user_agents_dir() / plain
    while _taken(folder):
        number += 1
        folder = user_agents_dir() / f"{plain}_{number}"
    return folder


def _taken(run: Path) -> bool:
    """Return whether a name is in use; not by what a closed app has left before it learnt."""
    if _nothing_learnt(run):
        young = time.time() - (run / LOG).stat().st_mtime < _ABANDONED
        return young or _held(run)
    return os.path.exists(run) or os.path.exists(run.with_suffix(".json"))


def _held(run: Path) -> bool:
    """Return whether a training writes into a folder now, however long it has been compiling."""
    try:
        with locked_folder(run, "another training"):
            return False
    except FileError:
        return True


_BEFORE_UPDATES: Final = {LOG, "config.toml", "metrics.csv", "metrics.jsonl", "tensorboard"}
"""Names of the files that a training makes before its first update."""


def _nothing_learnt(run: Path) -> bool:
    """Return whether a run's folder holds no more than what a training has before it learns."""
    if not os.path.isdir(run) or not set(os.listdir(run)) <= _BEFORE_UPDATES:
        return False
    rows = run / "metrics.jsonl"
    return os.path.isfile(run / LOG) and not (os.path.isfile(rows) and rows.stat().st_size)


def _clear(run: Path) -> None:
    """Remove what is left of a training that was stopped before it learnt anything."""
    if _nothing_learnt(run):
        with contextlib.suppress(OSError):
            shutil.rmtree(run)
            run.with_suffix(".json").unlink(missing_ok=True)


def stop_training(session: Session) -> None:
    """End the training; what was learnt is kept."""
    session.training.stop()


def update_training(session: Session) -> None:
    """Advance by a frame: report how a training ended, and load its agent if that is wanted."""
    training = session.training
    ended = training.ended()
    if ended is None or training.run is None:
        return
    if ended:
        session.toast(f"The training ended: {ended}", "error")
        return
    if not steps_in(training.run):
        _clear(training.run)
        if session.viewer.run.path == str(training.run) and not os.path.exists(training.run):
            session.viewer.run.watch("")
        session.toast(f"Training on {training.told}: stopped before anything was learnt.")
        return
    taken = _wanted(session, training.run)
    name = training.run.name  # the agent's
    how = "F6 lets it play." if taken else "Choose it as agent A to see it play."
    if training.stopping:
        session.toast(f"{name}: stopped; its progress is saved. {how}", "success")
    else:
        session.toast(f"{name} is trained. {how}", "success")
    if taken:
        load_agent(session, training.run, "a")


def _wanted(session: Session, run: Path) -> bool:
    """Return whether slot A takes a run's agent: no other one was chosen to play."""
    viewer, place = session.viewer, session.viewer.slots["a"]
    if viewer.follow_run and viewer.run.path == str(run):
        return True
    path = place.path if place.passed_over is None else place.passed_over.ref.path
    return not path or path in BUILT_IN or Path(path).is_relative_to(run)
