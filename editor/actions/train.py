"""Train an agent on the level in front: one click, then it shows what it has learnt."""

import contextlib
import os
import re
import shutil
import time
from pathlib import Path
from typing import Final

from editor.actions.agents import LONGEST_NAME, load_agent
from editor.actions.measure import steps_in
from editor.actions.watch import watch_run
from editor.agents.local_training import BUSY, LOG
from editor.base.wording import title_of
from editor.session import Session
from editor.worker.requests import BUILT_IN
from kinetix.errors import CommandError
from kinetix.files.lock import locked_folder
from kinetix.files.regular import FileError
from kinetix.level.codec import save_level
from kinetix.level.controls import channels_in_use
from kinetix.paths import user_agents_dir

_ABANDONED: Final = 600.0
"""A folder with nothing but a log is in use while the log is younger than this [s]."""


def train_here(session: Session) -> None:
    """Begin to train an agent on the level, in a folder of the user's agents.

    Raises:
        CommandError: The level leaves nothing to learn, or a training is running.
    """
    training, level = session.training, session.document.level
    if training.running:
        raise CommandError(BUSY)
    arena = level.arena
    walls = (arena.floor, arena.left_wall, arena.right_wall, arena.ceiling)
    if not {"green", "blue"} <= {body.role for body in (*level.bodies, *walls)}:
        raise CommandError("There is nothing to learn: the level needs a green and a blue shape.")
    if not channels_in_use(level):
        raise CommandError("There is nothing to drive: the level needs a motor or a thruster.")
    run = _free_folder(level.name)
    try:
        run.parent.mkdir(parents=True, exist_ok=True)
    except OSError as error:
        reason = error.strerror or error
        raise CommandError(f"{run.parent}: cannot be made: {reason}") from error
    file = run.with_suffix(".json")
    save_level(level, file)
    training.begin(file, run)
    watch_run(session, str(run))
    session.viewer.follow_run = True
    session.toast(
        f"Training on {title_of(level)}: its newest attempt plays with F6 as soon as there is one.",
        "success",
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
    name = training.run.name
    if not steps_in(training.run):
        _clear(training.run)
        if session.viewer.run.path == str(training.run) and not os.path.exists(training.run):
            session.viewer.run.watch("")
        session.toast(f"{name}: stopped before anything was learnt.")
        return
    taken = _wanted(session, training.run)
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
