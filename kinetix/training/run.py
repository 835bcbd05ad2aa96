"""A training run: a directory that can be stopped at any moment and goes on where it was."""

import contextlib
import dataclasses
import importlib.metadata
import json
import math
import shutil
import time
from collections.abc import Callable, Mapping, Sequence
from pathlib import Path
from typing import Any, Protocol

import jax
import numpy as np

from kinetix.agents.agent import Agent
from kinetix.agents.card import AgentCard
from kinetix.agents.checkpoint import RUN_CHECKPOINTS, write_checkpoint
from kinetix.agents.networks.config import NetworkConfig
from kinetix.agents.normalisation import to_card
from kinetix.errors import KinetixError
from kinetix.files.lock import locked_folder
from kinetix.files.regular import read_text
from kinetix.level.atomic import write_atomically
from kinetix.training.config import RESUMABLE, PpoConfig, ReplayConfig, SflConfig
from kinetix.training.curricula.replay import Replay
from kinetix.training.curricula.sfl import Sfl
from kinetix.training.devices import is_leader, to_host, wait_for_all
from kinetix.training.evaluation import TrainingEvaluation
from kinetix.training.logging import STEPS, UPDATE, Sink, open_sinks
from kinetix.training.pace import Pace
from kinetix.training.ppo.train import Ppo
from kinetix.training.resume import (
    StoredProgress,
    forget_older,
    put_aside,
    read_newest,
    recover,
    write_state,
)
from kinetix.training.settings import CONFIG, dumps_config, loads_config, make_config
from kinetix.training.setup import Setup
from kinetix.training.stopping import StopRequest, stop_requests

Say = Callable[[str], None]
"""Takes a sentence for the terminal."""


class Trainer(Protocol):
    """An algorithm: a state and a function that improves it."""

    @property
    def setup(self) -> Setup:
        """Environment, network, optimiser."""
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
    if isinstance(config, SflConfig):
        return Sfl(config, teacher)
    if isinstance(config, ReplayConfig):
        return Replay(config, teacher)
    return Ppo(config, teacher)


def train(
    algorithm: str,
    config: PpoConfig,
    out: Path,
    *,
    teacher: Agent | None = None,
    report: Callable[[Report], None] | None = None,
    say: Say | None = None,
) -> Path:
    """Train until the configured number of steps, from the last checkpoint if there is one.

    Ctrl+C and SIGTERM end it after the update that is under way, with everything saved.

    Args:
        algorithm: Its name, for the records.
        config: The configuration, already checked.
        out: The run's directory.
        teacher: The agent to start from, in a run that has no checkpoint yet.
        report: Called after every update.
        say: Takes what there is to say besides: where the run resumes, what is damaged.

    Returns:
        The last checkpoint.

    Raises:
        KinetixError: The directory holds a run with another configuration (the sentence says where
            they differ), another training writes to it, or no stored state can be read.
        KeyboardInterrupt: The user ended the training; it is saved.
        Terminated: The system did; it is saved.
    """
    say = say if say is not None and is_leader() else _say_nothing
    if is_leader():
        out.mkdir(parents=True, exist_ok=True)
    wait_for_all("the directory is there")
    _check_same_run(out, algorithm, config)
    trainer = make_trainer(config, teacher)
    with contextlib.ExitStack() as stack:
        if is_leader():
            stack.enter_context(locked_folder(out, "another training"))
            recover(out)
        wait_for_all("what was moved is back")
        stop = stack.enter_context(stop_requests(say))
        state, progress, damaged = _begin(trainer, out, say)
        wait_for_all("everybody has read what is there")
        sinks: list[Sink] = []
        if is_leader():
            put_aside(damaged)
            _sweep(out)
            write_atomically(out / CONFIG, dumps_config(algorithm, config).encode())
            sinks = open_sinks(out, config, updates=progress.updates)
        for sink in sinks:
            stack.callback(sink.close)
        run = _Run(algorithm=algorithm, trainer=trainer, out=out, sinks=sinks, stop=stop)
        state, progress = _loop(run, state, progress, report, say)
        if progress.updates < config.num_updates:
            say(f"stopped after update {progress.updates}; saved, the same command resumes here")
            raise stop.error()
    return out / RUN_CHECKPOINTS / str(progress.updates * config.steps_per_update)


def _say_nothing(text: str) -> None:
    """Take a sentence that nobody wants."""


def _begin(trainer: Trainer, out: Path, say: Say) -> tuple[Any, StoredProgress, list[Path]]:
    """The state to go on from, and newer checkpoints that are damaged."""
    found = read_newest(out, lambda: jax.eval_shape(trainer.start), say)
    if found is None:
        if (out / CONFIG).is_file():
            say("no checkpoint was written yet: starting from the beginning")
        return trainer.start(), StoredProgress(updates=0, seconds=0.0), []
    state, progress, damaged = found
    say(f"resuming from update {progress.updates} of {trainer.setup.config.num_updates}")
    return state, progress, damaged


@dataclasses.dataclass(frozen=True, kw_only=True)
class _Run:
    """Constants of a training."""

    algorithm: str
    trainer: Trainer
    out: Path
    sinks: Sequence[Sink]
    stop: StopRequest


def _loop(
    run: _Run,
    state: Any,
    progress: StoredProgress,
    report: Callable[[Report], None] | None,
    say: Say,
) -> tuple[Any, StoredProgress]:
    """Update until the end, or until somebody asks to stop."""
    algorithm, trainer = run.algorithm, run.trainer
    config = trainer.setup.config
    evaluation = TrainingEvaluation(trainer.setup)
    updates = config.num_updates
    pace = Pace(updates=updates, eval_freq=config.eval_freq)
    stopping = False
    if progress.updates < updates:
        say("compiling the first update")
    while progress.updates < updates and not stopping:
        began = time.monotonic()
        state, metrics = trainer.update(state)
        numbers = {name: float(np.asarray(value)) for name, value in metrics.items()}
        took = time.monotonic() - began
        pace.updated(took)
        done = progress.updates + 1
        progress = StoredProgress(updates=done, seconds=progress.seconds + took)
        last = done == updates
        if config.eval_freq and (done % config.eval_freq == 0 or last):
            say(f"evaluating after update {done}")
            began = time.monotonic()
            numbers |= evaluation(_agent(algorithm, trainer, state, progress, {}))
            pace.evaluated(time.monotonic() - began)
        numbers |= _timing(config, progress, took)
        for sink in run.sinks:
            sink.write(numbers)
        stopping = run.stop.agreed
        if done % config.checkpoint_save_freq == 0 or last or stopping:
            _save(run, state, progress, numbers)
        if report is not None and is_leader():
            report(_report(config, progress, took, numbers, pace.seconds_left(done)))
    return state, progress


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
        "code_version": importlib.metadata.version("kinetix-editor"),
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
    steps = progress.updates * run.trainer.setup.config.steps_per_update

    def beside(directory: Path) -> None:
        write_state(directory, host, updates=progress.updates, seconds=progress.seconds)

    target = run.out / RUN_CHECKPOINTS / str(steps)
    write_checkpoint(target, agent.card, agent.params["params"], extra=beside)
    forget_older(run.out)


def _sweep(out: Path) -> None:
    """Remove what kills have left half written."""
    for folder in (out, out / RUN_CHECKPOINTS):
        for path in [*folder.glob(".*.tmp"), *folder.glob(".*.old")]:
            if path.is_dir():
                shutil.rmtree(path, ignore_errors=True)
            else:
                path.unlink(missing_ok=True)


def _check_same_run(out: Path, algorithm: str, config: PpoConfig) -> None:
    """Refuse to go on with a run under other hyper-parameters than it began with."""
    path = out / CONFIG
    if not path.is_file():
        if any(not entry.name.startswith(".") for entry in out.iterdir()):
            raise KinetixError(f"{out}: is not empty and holds no training run")
        return
    name, values = loads_config(read_text(path, "run"), str(path))
    before = make_config(name, values=values)
    if name != algorithm:
        raise KinetixError(f"{out}: this run was started with {name}, not {algorithm}")
    for field in dataclasses.fields(config):
        old, new = getattr(before, field.name), getattr(config, field.name)
        scheduled = config.anneal_lr or config.warmup_lr
        if field.name == "total_timesteps" and old != new and scheduled:
            raise KinetixError(
                f"{path}: total_timesteps = {old} sets the learning rate of this run, which would "
                f"jump under {new}; choose another directory, with --from {out} to start from its "
                "newest agent"
            )
        if field.name not in RESUMABLE and old != new:
            raise KinetixError(
                f"{path}: this run was started with {field.name} = {json.dumps(_plain(old))}, now "
                f"it is {json.dumps(_plain(new))}; choose another directory"
            )


def _plain(value: Any) -> Any:
    return dataclasses.asdict(value) if isinstance(value, NetworkConfig) else value
