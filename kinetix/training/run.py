"""A training run: a directory that can be stopped at any moment and goes on where it was."""

import contextlib
import os
from collections.abc import Callable
from pathlib import Path
from typing import Any

import jax
import msgspec

from kinetix.agents.agent import Agent
from kinetix.errors import KinetixError
from kinetix.files.atomic import write_atomically
from kinetix.files.folders import made_folder
from kinetix.files.lock import locked_folder
from kinetix.programs import make_room
from kinetix.training.config import PpoConfig
from kinetix.training.config_warnings import cut_short, learns_nothing
from kinetix.training.curricula.history import Course, History
from kinetix.training.curricula.replay import Replay
from kinetix.training.curricula.sfl import Sfl
from kinetix.training.devices import is_leader, wait_for_all
from kinetix.training.directory import (
    check_same_run,
    clear_leftovers,
    refuse_lost_checkpoints,
    unnamed_fields,
    unreadable_agent,
)
from kinetix.training.imitation.clone import Clone
from kinetix.training.logging import Sink, keep_damaged_rows, open_sinks
from kinetix.training.loop import Report, Training, checkpoint_of, loop, save
from kinetix.training.origin import check_origin, dumps_origin, origin_of, read_origin
from kinetix.training.ppo.rollout import as_updates_leave_it
from kinetix.training.progress_text import Say, now_and_then, say_nothing
from kinetix.training.resume import StoredProgress, put_aside, read_newest, recover
from kinetix.training.settings import CONFIG, dumps_config
from kinetix.training.setup import Setup
from kinetix.training.stopping import stop_requests
from kinetix.training.trainer import Trainer, make_trainer
from kinetix.training.wandb import check_package


def train(  # noqa: PLR0913 (whom to tell what, besides what is trained)
    algorithm: str,
    config: PpoConfig,
    out: Path,
    *,
    teacher: Agent | None = None,
    announce: Callable[[Setup], None] | None = None,
    report: Callable[[Report], None] | None = None,
    say: Say | None = None,
    status: Say | None = None,
) -> Path:
    """Train until the configured number of steps, from the last checkpoint if there is one.

    Ctrl+C, SIGTERM and a closed terminal end it after the update that is under way, with everything
    saved.

    Args:
        algorithm: Its name, for the records.
        config: The configuration, already checked.
        out: The run's directory.
        teacher: The agent to start from, in a run that has no checkpoint yet.
        announce: Called before anything compiles, with the parts of the training.
        report: Called after every update.
        say: Takes what there is to say besides: where the run resumes, what is damaged.
        status: Takes words for what is under way (compiling, scoring, evaluating), which the next
            ones may replace; None: some of them go to `say`.

    Returns:
        The last checkpoint.

    Raises:
        KinetixError: The directory holds a run with another configuration (the message says where
            they differ), another training writes to it, or no stored state can be read.
        KeyboardInterrupt: The user ended the training; it is saved.
        Terminated: The system did; it is saved.
    """
    say = say if say is not None and is_leader() else say_nothing
    status = status if status is not None and is_leader() else now_and_then(say)
    if is_leader():
        check_package(config)
        made_folder(out)
    wait_for_all("the directory is there")
    length = check_same_run(out, algorithm, config)
    if config.levels:
        status("preparing the levels")
    make_room()
    trainer = make_trainer(config, teacher)
    trainer.work.status = status
    if announce is not None and is_leader():
        announce(trainer.setup)
    _say_first(trainer, out, say)
    with contextlib.ExitStack() as stack:
        if is_leader():
            stack.enter_context(locked_folder(out, "another training"))
            recover(out)
        wait_for_all("what was moved is back")
        stop = stack.enter_context(stop_requests(say))
        state, progress, damaged = _begin(trainer, out, say, status, teacher)
        _say_length(length, progress, config, say)
        origin = read_origin(out) if progress.updates else origin_of(teacher)
        checkpoint = checkpoint_of(out, config, progress)
        lost = unreadable_agent(checkpoint) if progress.updates else ""
        wait_for_all("everybody has read what is there")
        sinks: list[Sink] = []
        if is_leader():
            put_aside(damaged)
            clear_leftovers(out)
            text = dumps_config(algorithm, config) + dumps_origin(origin)
            _keep_config(out, text, config, progress)
            keep_damaged_rows(out, progress.updates, say)
            sinks = open_sinks(out, config, updates=progress.updates)
        for sink in sinks:
            stack.callback(sink.close)
        history = None
        if isinstance(trainer, Sfl | Replay):
            history = History(
                out,
                trainer,
                state,
                Course(
                    algorithm=algorithm,
                    update=progress.updates,
                    updates=config.num_updates,
                    steps_per_update=config.steps_per_update,
                ),
                say,
            )
        run = Training(
            algorithm=algorithm,
            trainer=trainer,
            out=out,
            sinks=sinks,
            stop=stop,
            say=say,
            status=status,
            history=history,
            start_from=origin,
        )
        if lost:
            say(f"{lost}; it is made again from the training's state")
            save(run, state, progress, {})
        state, progress = loop(run, state, progress, report)
        if progress.updates < config.num_updates:
            say(f"stopped after update {progress.updates}; saved, the same command resumes here")
            raise stop.error()
    return checkpoint_of(out, config, progress)


def _say_first(trainer: Trainer, out: Path, say: Say) -> None:
    """Report what a person may not expect of this training."""
    config = trainer.setup.config
    if config.rounded:
        say(config.rounded)
    if config.demo_starts and not config.levels:
        say(
            f"warning: demo_starts = {config.demo_starts:g} has no effect: no levels are named "
            "(--levels), and of random ones no way to a win is known"
        )
    if trainer.setup.without_starts:
        say(
            f"warning: no episode of {', '.join(trainer.setup.without_starts)} begins on the way "
            "of a win: the one that was found is lost when it is played again"
        )
    if isinstance(trainer, Clone):
        say(trainer.told)
    setup = trainer.setup
    for warning in (unnamed_fields(out, config), cut_short(setup), learns_nothing(setup)):
        if warning:
            say(f"warning: {warning}")


def _say_length(length: str, progress: StoredProgress, config: PpoConfig, say: Say) -> None:
    """Report that a run goes on with another length, if it does."""
    if length and progress.updates < config.num_updates:
        say(length)


def _keep_config(out: Path, text: str, config: PpoConfig, progress: StoredProgress) -> None:
    """Write what is trained with, unless it is a length that is behind the run already."""
    if progress.updates <= config.num_updates:
        write_atomically(out / CONFIG, text.encode())


def _on_these_levels(progress: StoredProgress, trainer: Trainer, say: Say) -> StoredProgress:
    """Progress that goes on on the levels of now; what differs is said."""
    levels = trainer.setup.levels
    if progress.on_others(levels) and isinstance(trainer, Clone):
        say(
            "warning: the demonstrations have changed since the last checkpoint: what is held out "
            "now may have been learnt from"
        )
    elif progress.on_others(levels):
        say(
            "warning: the files of the levels have changed since the last checkpoint: what has "
            "been learnt so far was learnt on others"
        )
    return msgspec.structs.replace(progress, levels=levels)


def _begin(
    trainer: Trainer, out: Path, say: Say, status: Say, teacher: Agent | None
) -> tuple[Any, StoredProgress, list[Path]]:
    """The state to go on from, and newer checkpoints that are damaged."""
    config, levels = trainer.setup.config, trainer.setup.levels
    found = read_newest(out, lambda: jax.eval_shape(trainer.start), say, levels=levels)
    if found is None:
        if teacher is None and (config.teacher_coef or config.critic_warmup):
            name = "teacher_coef" if config.teacher_coef else "critic_warmup"
            raise KinetixError(f"{name}: there is no agent to start from; name it with --from")
        check_origin(out, teacher)
        if os.path.isfile(out / CONFIG):
            refuse_lost_checkpoints(out, trainer.setup.config)
            say("no checkpoint was written yet: starting from the beginning")
        status("compiling: start")
        return trainer.start(), StoredProgress(updates=0, seconds=0.0, levels=levels), []
    state, progress, damaged = found
    progress = _on_these_levels(progress, trainer, say)
    if progress.updates > config.num_updates:
        say(
            f"nothing is left to do: update {progress.updates} is done already; the length in "
            f"{CONFIG} stays"
        )
    elif progress.updates == config.num_updates:
        say(f"all {config.num_updates} updates are done; more total_timesteps go on from here")
    else:
        say(f"resuming from update {progress.updates} of {config.num_updates}")
    if not isinstance(trainer, Clone):  # which learns on one device
        state = as_updates_leave_it(state)
    return state, progress, damaged
