"""The updates of a training: one after the other, measured, told, saved."""

import dataclasses
import functools
import math
import time
from collections.abc import Callable, Mapping, Sequence
from pathlib import Path
from typing import Any

import msgspec
import numpy as np

from kinetix.agents.agent import Agent
from kinetix.agents.card import AgentCard
from kinetix.agents.checkpoint import RUN_CHECKPOINTS, write_checkpoint
from kinetix.agents.normalisation import to_card
from kinetix.errors import KinetixError
from kinetix.training.averages import EpisodeAverages
from kinetix.training.config import PpoConfig
from kinetix.training.curricula.history import History
from kinetix.training.devices import is_leader, to_host
from kinetix.training.evaluation import TrainingEvaluation
from kinetix.training.films import Filming
from kinetix.training.logging import STEPS, UPDATE, Sink, read_metrics
from kinetix.training.pace import Pace
from kinetix.training.ppo.update import GRADIENT
from kinetix.training.progress_text import Say
from kinetix.training.resume import StoredProgress, forget_older, write_state
from kinetix.training.stopping import StopRequest
from kinetix.training.trainer import Trainer
from kinetix.version import __version__


@dataclasses.dataclass(frozen=True, kw_only=True)
class Report:
    """Progress of a training, for the terminal."""

    update: int
    updates: int
    env_steps: int
    steps_per_second: float | None
    """None after an update in which something was compiled: mostly that takes its time."""
    seconds_left: float | None
    """Estimate of the remaining time, evaluations included [s]; None while it is not known."""
    metrics: Mapping[str, float]


@dataclasses.dataclass(frozen=True, kw_only=True)
class Training:
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
    start_from: Mapping[str, Any]
    """Name, digest and length of training of the agent that it began from; empty: of none."""


def checkpoint_of(out: Path, config: PpoConfig, progress: StoredProgress) -> Path:
    """Return where the agent is saved after so many updates."""
    return out / RUN_CHECKPOINTS / str(progress.updates * config.steps_per_update)


def loop(
    run: Training,
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
        _refuse_divergence(numbers, progress.updates + 1)
        took = time.monotonic() - began
        parts = trainer.work.taken()
        view.pace.worked(parts)
        numbers |= view.averages.add(numbers)
        done = progress.updates + 1
        seconds = progress.seconds + took
        progress = msgspec.structs.replace(progress, updates=done, seconds=seconds)
        last = done == config.num_updates
        agent = functools.partial(_agent, run, state, progress, {})
        # Who wants to stop need not wait for what can take long, but for the results of the end.
        stopping = run.stop.agreed
        watched = last or not stopping
        if watched and config.eval_freq and (done % config.eval_freq == 0 or last):
            stopped = _never if last else run.stop.alone
            numbers |= view.evaluation(agent(), run.status, stopped)
            if view.evaluation.seconds is not None:
                view.pace.evaluated(view.evaluation.seconds)
        numbers |= _timing(config, progress, took)
        for sink in run.sinks:
            sink.write(numbers)
        stopping = stopping or run.stop.agreed
        watched = last or not stopping
        if watched and view.camera.films_after(done, last=last):
            _film(run, view.camera, agent(), done * config.steps_per_update)
        stopping = stopping or run.stop.agreed
        saving = done % config.checkpoint_save_freq == 0 or last or stopping
        if run.history is not None:
            run.history.follow(done, state, page=saving)
        if saving:
            save(run, state, progress, numbers)
        if report is not None and is_leader():
            typical = None if any(part.compiled for part in parts) else took
            report(_report(config, progress, typical, numbers, view.pace.seconds_left(done)))
    return state, progress


def _never() -> bool:
    return False


def _refuse_divergence(numbers: Mapping[str, float], update: int) -> None:
    """Raise an error where the gradient became NaN or infinite."""
    if not math.isfinite(numbers.get(GRADIENT, 0.0)):
        raise KinetixError(
            f"update {update}: the gradient is not finite, the training has diverged; what is "
            "stored of the run is kept. Train again, or from a checkpoint (--from), with a smaller "
            "learning_rate or max_grad_norm"
        )


@dataclasses.dataclass(frozen=True, kw_only=True)
class _View:
    """Evaluation, films, averages and pace of a training."""

    evaluation: TrainingEvaluation
    camera: Filming
    averages: EpisodeAverages
    pace: Pace


def _view(run: Training, progress: StoredProgress) -> _View:
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
    camera = Filming(run.out, run.trainer.setup)
    return _View(evaluation=evaluation, camera=camera, averages=averages, pace=pace)


def _film(run: Training, camera: Filming, agent: Agent, steps: int) -> None:
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
    took: float | None,
    metrics: Mapping[str, float],
    seconds_left: float | None,
) -> Report:
    return Report(
        update=progress.updates,
        updates=config.num_updates,
        env_steps=progress.updates * config.steps_per_update,
        steps_per_second=None if took is None else config.steps_per_update / max(took, 1e-9),
        seconds_left=seconds_left,
        metrics=metrics,
    )


def _agent(
    run: Training, state: Any, progress: StoredProgress, results: Mapping[str, float]
) -> Agent:
    """Return the agent that a training state holds, with its records."""
    algorithm, trainer = run.algorithm, run.trainer
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
    if run.start_from:
        training["start_from"] = dict(run.start_from)
    card: AgentCard = trainer.setup.card.replace(
        name=f"{algorithm}-{config.size}-{steps}",
        description=f"{algorithm} on {config.level_mode} levels of size {config.size}",
        training=training,
        normalisation=to_card(to_host(state.statistics)),
        results={k: v for k, v in results.items() if k.startswith("eval") and math.isfinite(v)},
    )
    return Agent(card, to_host(state.learner.params["params"]))


def save(run: Training, state: Any, progress: StoredProgress, results: Mapping[str, float]) -> None:
    """Write a checkpoint: the agent, and beside it the state that a training goes on from."""
    agent = _agent(run, state, progress, results)
    host = to_host(state)
    if not is_leader():
        return

    def beside(directory: Path) -> None:
        write_state(directory, host, progress)

    target = checkpoint_of(run.out, run.trainer.setup.config, progress)
    try:
        # What lay there and was no checkpoint of this run was put aside when it went on.
        write_checkpoint(target, agent.card, agent.params["params"], extra=beside, replace=True)
    except KinetixError as error:
        told = f"{error}; once that is repaired, the same command continues"
        raise KinetixError(told) from None
    forget_older(run.out)
