"""A training run: a directory that can be stopped at any moment and goes on where it was."""

import contextlib
import dataclasses
import functools
import math
import os
import time
from collections.abc import Callable, Mapping, Sequence
from pathlib import Path
from typing import Any, Protocol

import jax
import numpy as np

from kinetix.agents.agent import Agent
from kinetix.agents.card import AgentCard
from kinetix.agents.checkpoint import RUN_CHECKPOINTS, write_checkpoint
from kinetix.agents.normalisation import to_card
from kinetix.errors import KinetixError
from kinetix.files.folders import made_folder
from kinetix.files.lock import locked_folder
from kinetix.level.atomic import write_atomically
from kinetix.training.averages import EpisodeAverages
from kinetix.training.config import BcConfig, PpoConfig, ReplayConfig, SflConfig
from kinetix.training.curricula.history import Course, History
from kinetix.training.curricula.replay import Replay
from kinetix.training.curricula.sfl import Sfl
from kinetix.training.devices import is_leader, to_host, wait_for_all
from kinetix.training.directory import (
    check_same_run,
    clear_leftovers,
    refuse_lost_checkpoints,
    unreadable_agent,
)
from kinetix.training.evaluation import TrainingEvaluation
from kinetix.training.films import Filming
from kinetix.training.imitation.clone import Clone
from kinetix.training.logging import (
    STEPS,
    UPDATE,
    Sink,
    keep_damaged_rows,
    open_sinks,
    read_metrics,
)
from kinetix.training.pace import Pace
from kinetix.training.ppo.rollout import as_updates_leave_it
from kinetix.training.ppo.train import Ppo
from kinetix.training.resume import (
    StoredProgress,
    forget_older,
    put_aside,
    read_newest,
    recover,
    write_state,
)
from kinetix.training.settings import CONFIG, dumps_config
from kinetix.training.setup import Setup
from kinetix.training.stopping import StopRequest, stop_requests
from kinetix.training.telling import Say, now_and_then, say_nothing
from kinetix.training.work import Work
from kinetix.version import __version__


class Trainer(Protocol):
    """An algorithm: a state and a function that improves it."""

    @property
    def setup(self) -> Setup:
        """Environment, network, optimiser."""
        ...

    @property
    def work(self) -> Work:
        """Runs and times the parts of updates."""
        ...

    @property
    def parts_per_update(self) -> Mapping[str, float]:
        """Mean number of parts of each name in an update."""
        ...

    def start(self) -> Any:
        """The state before the first update."""
        ...

    def update(self, state: Any) -> tuple[Any, Mapping[str, Any]]:
        """The next state, and metrics."""
        ...


@dataclasses.dataclass(frozen=True, kw_only=True)
class Report:
    """Progress of a training, for the terminal."""

    update: int
    updates: int
    env_steps: int
    steps_per_second: float
    seconds_left: float | None
    """Estimate of the remaining time, evaluations included [s]; None while it is not known."""
    metrics: Mapping[str, float]


def make_trainer(config: PpoConfig, teacher: Agent | None = None) -> Trainer:
    """The algorithm that a configuration is for.

    Args:
        config: The configuration, already checked.
        teacher: The agent to start from.
    """
    if isinstance(config, BcConfig):
        return Clone(config, teacher)
    if isinstance(config, SflConfig):
        return Sfl(config, teacher)
    if isinstance(config, ReplayConfig):
        return Replay(config, teacher)
    return Ppo(config, teacher)


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
        KinetixError: The directory holds a run with another configuration (the sentence says where
            they differ), another training writes to it, or no stored state can be read.
        KeyboardInterrupt: The user ended the training; it is saved.
        Terminated: The system did; it is saved.
    """
    say = say if say is not None and is_leader() else say_nothing
    status = status if status is not None and is_leader() else now_and_then(say)
    if is_leader():
        made_folder(out)
    wait_for_all("the directory is there")
    check_same_run(out, algorithm, config, say)
    if config.levels:
        status("preparing the levels")
    trainer = make_trainer(config, teacher)
    trainer.work.status = status
    if announce is not None and is_leader():
        announce(trainer.setup)
    _say_first(trainer, config, say)
    with contextlib.ExitStack() as stack:
        if is_leader():
            stack.enter_context(locked_folder(out, "another training"))
            recover(out)
        wait_for_all("what was moved is back")
        stop = stack.enter_context(stop_requests(say))
        state, progress, damaged = _begin(trainer, out, say, status, taught=teacher is not None)
        checkpoint = _checkpoint(out, config, progress)
        lost = unreadable_agent(checkpoint) if progress.updates else ""
        wait_for_all("everybody has read what is there")
        sinks: list[Sink] = []
        if is_leader():
            put_aside(damaged)
            clear_leftovers(out)
            write_atomically(out / CONFIG, dumps_config(algorithm, config).encode())
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
        run = _Run(
            algorithm=algorithm,
            trainer=trainer,
            out=out,
            sinks=sinks,
            stop=stop,
            say=say,
            status=status,
            history=history,
        )
        if lost:
            say(f"{lost}; it is made again from the training's state")
            _save(run, state, progress, {})
        state, progress = _loop(run, state, progress, report)
        if progress.updates < config.num_updates:
            say(f"stopped after update {progress.updates}; saved, the same command resumes here")
            raise stop.error()
    return _checkpoint(out, config, progress)


def _checkpoint(out: Path, config: PpoConfig, progress: StoredProgress) -> Path:
    return out / RUN_CHECKPOINTS / str(progress.updates * config.steps_per_update)


def _say_first(trainer: Trainer, config: PpoConfig, say: Say) -> None:
    """Say what a person may not expect of this training."""
    if config.rounded:
        say(config.rounded)
    if config.demo_starts and not config.levels:
        say(
            f"warning: demo_starts = {config.demo_starts:g} has no effect: no levels are named "
            "(--levels), and of random ones no way to a win is known"
        )
    if isinstance(trainer, Clone):
        say(trainer.told)
    if trainer.setup.cut_short():
        say(f"warning: {trainer.setup.cut_short()}")


def _begin(
    trainer: Trainer, out: Path, say: Say, status: Say, *, taught: bool
) -> tuple[Any, StoredProgress, list[Path]]:
    """The state to go on from, and newer checkpoints that are damaged."""
    found = read_newest(out, lambda: jax.eval_shape(trainer.start), say)
    config = trainer.setup.config
    if found is None:
        if not taught and (config.teacher_coef or config.critic_warmup):
            name = "teacher_coef" if config.teacher_coef else "critic_warmup"
            raise KinetixError(f"{name}: there is no agent to start from; name it with --from")
        if os.path.isfile(out / CONFIG):
            refuse_lost_checkpoints(out, trainer.setup.config)
            say("no checkpoint was written yet: starting from the beginning")
        status("compiling: start")
        return trainer.start(), StoredProgress(updates=0, seconds=0.0), []
    state, progress, damaged = found
    if progress.updates > config.num_updates:
        say(f"nothing is left to do: update {progress.updates} is done already")
    elif progress.updates == config.num_updates:
        say(f"all {config.num_updates} updates are done; more total_timesteps go on from here")
    else:
        say(f"resuming from update {progress.updates} of {config.num_updates}")
    if not isinstance(trainer, Clone):  # which learns on one device
        state = as_updates_leave_it(state)
    return state, progress, damaged


@dataclasses.dataclass(frozen=True, kw_only=True)
class _Run:
    """Constants of a training."""

    algorithm: str
    trainer: Trainer
    out: Path
    sinks: Sequence[Sink]
    stop: StopRequest
    say: Say
    status: Say
    history: History | None
    """Of the buffer, where the algorithm keeps levels."""


def _loop(
    run: _Run,
    state: Any,
    progress: StoredProgress,
    report: Callable[[Report], None] | None,
) -> tuple[Any, StoredProgress]:
    """Update until the end, or until somebody asks to stop."""
    trainer, config = run.trainer, run.trainer.setup.config
    view = _view(run, progress)
    stopping = False
    while progress.updates < config.num_updates and not stopping:
        began = time.monotonic()
        state, metrics = trainer.update(state)
        numbers = {name: float(np.asarray(value)) for name, value in metrics.items()}
        took = time.monotonic() - began
        view.pace.worked(trainer.work.taken())
        numbers |= view.averages.add(numbers)
        done = progress.updates + 1
        progress = StoredProgress(updates=done, seconds=progress.seconds + took)
        last = done == config.num_updates
        agent = functools.partial(_agent, run.algorithm, trainer, state, progress, {})
        if config.eval_freq and (done % config.eval_freq == 0 or last):
            numbers |= view.evaluation(agent(), run.status)
            if view.evaluation.seconds is not None:
                view.pace.evaluated(view.evaluation.seconds)
        numbers |= _timing(config, progress, took)
        for sink in run.sinks:
            sink.write(numbers)
        if view.camera.films_after(done, last=last):
            _film(run, view.camera, agent(), done * config.steps_per_update)
        stopping = run.stop.agreed
        saving = done % config.checkpoint_save_freq == 0 or last or stopping
        if run.history is not None:
            run.history.follow(done, state, page=saving)
        if saving:
            _save(run, state, progress, numbers)
        if report is not None and is_leader():
            report(_report(config, progress, took, numbers, view.pace.seconds_left(done)))
    return state, progress


@dataclasses.dataclass(frozen=True, kw_only=True)
class _View:
    """Evaluation, films, averages and pace of a training."""

    evaluation: TrainingEvaluation
    camera: Filming
    averages: EpisodeAverages
    pace: Pace


def _view(run: _Run, progress: StoredProgress) -> _View:
    """Prepare evaluation, films and pace; averages go on where the run stopped."""
    config = run.trainer.setup.config
    evaluation = TrainingEvaluation(run.trainer.setup)
    if evaluation.told:
        run.say(evaluation.told)
    averages = EpisodeAverages(config.num_train_envs)
    for row in read_metrics(run.out):
        if row[UPDATE] <= progress.updates:
            averages.add(row)
    pace = Pace(
        updates=config.num_updates,
        eval_freq=config.eval_freq,
        per_update=run.trainer.parts_per_update,
        evaluation_share=evaluation.steps / config.steps_per_update,
    )
    camera = Filming(run.out, config)
    return _View(evaluation=evaluation, camera=camera, averages=averages, pace=pace)


def _film(run: _Run, camera: Filming, agent: Agent, steps: int) -> None:
    """Film the agent and hand the films to whatever takes metrics."""
    if is_leader():
        for film in camera.film(agent, steps, run.status):
            for sink in run.sinks:
                sink.film(steps, film)


def _timing(config: PpoConfig, progress: StoredProgress, took: float) -> dict[str, float]:
    return {
        UPDATE: progress.updates,
        STEPS: progress.updates * config.steps_per_update,
        "timing/sps": config.steps_per_update / max(took, 1e-9),
        "timing/seconds": progress.seconds,
    }


def _report(
    config: PpoConfig,
    progress: StoredProgress,
    took: float,
    metrics: Mapping[str, float],
    seconds_left: float | None,
) -> Report:
    return Report(
        update=progress.updates,
        updates=config.num_updates,
        env_steps=progress.updates * config.steps_per_update,
        steps_per_second=config.steps_per_update / max(took, 1e-9),
        seconds_left=seconds_left,
        metrics=metrics,
    )


def _agent(
    algorithm: str,
    trainer: Trainer,
    state: Any,
    progress: StoredProgress,
    results: Mapping[str, float],
) -> Agent:
    """The agent that a training state holds, with its records."""
    config = trainer.setup.config
    steps = progress.updates * config.steps_per_update
    training = {
        "algorithm": algorithm,
        "configuration": dataclasses.asdict(config),
        "seed": config.seed,
        "environment_steps": steps,
        "wall_time": round(progress.seconds, 3),
        "code_version": __version__,
    }
    card: AgentCard = trainer.setup.card.replace(
        name=f"{algorithm}-{config.size}-{steps}",
        description=f"{algorithm} on {config.level_mode} levels of size {config.size}",
        training=training,
        normalisation=to_card(to_host(state.statistics)),
        results={k: v for k, v in results.items() if k.startswith("eval") and math.isfinite(v)},
    )
    return Agent(card, to_host(state.learner.params["params"]))


def _save(run: _Run, state: Any, progress: StoredProgress, results: Mapping[str, float]) -> None:
    agent = _agent(run.algorithm, run.trainer, state, progress, results)
    host = to_host(state)
    if not is_leader():
        return

    def beside(directory: Path) -> None:
        write_state(directory, host, updates=progress.updates, seconds=progress.seconds)

    target = _checkpoint(run.out, run.trainer.setup.config, progress)
    write_checkpoint(target, agent.card, agent.params["params"], extra=beside)
    forget_older(run.out)
