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
from typing import Any, Final, Protocol

import jax
import msgspec
import numpy as np

from kinetix.agents.agent import Agent
from kinetix.agents.card import AgentCard
from kinetix.agents.checkpoint import RUN_CHECKPOINTS, steps_of_run, write_checkpoint
from kinetix.agents.networks.config import NetworkConfig
from kinetix.agents.normalisation import to_card
from kinetix.errors import KinetixError
from kinetix.level.atomic import write_atomically
from kinetix.training.config import RESUMABLE, PpoConfig, ReplayConfig, SflConfig
from kinetix.training.curricula.replay import Replay
from kinetix.training.curricula.sfl import Sfl
from kinetix.training.devices import is_leader, to_host, wait_for_all
from kinetix.training.evaluation import TrainingEvaluation
from kinetix.training.logging import STEPS, UPDATE, Sink, open_sinks
from kinetix.training.ppo.train import Ppo
from kinetix.training.settings import CONFIG, dumps_config, loads_config, make_config
from kinetix.training.setup import Setup
from kinetix.training.state import STATE, load_state, save_state

PROGRESS: Final = "progress.json"
"""Beside `state/`: how many updates are done, and how long they took."""


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
    """Where a training stands, for the terminal."""

    update: int
    updates: int
    env_steps: int
    steps_per_second: float
    seconds_left: float
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
) -> Path:
    """Train until the configured number of steps, from the last checkpoint if there is one.

    Args:
        algorithm: Its name, for the records.
        config: The configuration, already checked.
        out: The run's directory.
        teacher: The agent to start from, in a run that has no checkpoint yet.
        report: Called after every update.

    Returns:
        The last checkpoint.

    Raises:
        KinetixError: The directory holds a run with another configuration; the sentence says where
            they differ.
    """
    if is_leader():
        out.mkdir(parents=True, exist_ok=True)
    wait_for_all("the directory is there")
    _check_same_run(out, algorithm, config)
    trainer = make_trainer(config, teacher)
    progress = _Progress(updates=0, seconds=0.0)
    newest = _newest_with_state(out)
    if newest is None:
        state = trainer.start()
    else:
        state = load_state(newest, jax.eval_shape(trainer.start))
        progress = msgspec.json.decode((newest / PROGRESS).read_bytes(), type=_Progress)
    wait_for_all("everybody has read what is there")
    with contextlib.ExitStack() as stack:
        sinks: list[Sink] = []
        if is_leader():
            _sweep(out)
            write_atomically(out / CONFIG, dumps_config(algorithm, config).encode())
            sinks = open_sinks(out, config, updates=progress.updates)
        for sink in sinks:
            stack.callback(sink.close)
        state, progress = _loop(algorithm, trainer, state, progress, out, sinks, report)
    return out / RUN_CHECKPOINTS / str(progress.updates * config.steps_per_update)


class _Progress(msgspec.Struct, frozen=True, kw_only=True):
    """What `progress.json` holds."""

    updates: int
    seconds: float


def _loop(
    algorithm: str,
    trainer: Trainer,
    state: Any,
    progress: _Progress,
    out: Path,
    sinks: Sequence[Sink],
    report: Callable[[Report], None] | None,
) -> tuple[Any, _Progress]:
    config = trainer.setup.config
    evaluation = TrainingEvaluation(trainer.setup)
    updates = config.num_updates
    while progress.updates < updates:
        began = time.monotonic()
        state, metrics = trainer.update(state)
        numbers = {name: float(np.asarray(value)) for name, value in metrics.items()}
        took = time.monotonic() - began
        done = progress.updates + 1
        progress = _Progress(updates=done, seconds=progress.seconds + took)
        last = done == updates
        if config.eval_freq and (done % config.eval_freq == 0 or last):
            numbers |= evaluation(_agent(algorithm, trainer, state, progress, {}))
        numbers |= _timing(config, progress, took)
        for sink in sinks:
            sink.write(numbers)
        if done % config.checkpoint_save_freq == 0 or last:
            _save(algorithm, trainer, state, progress, out, numbers)
        if report is not None and is_leader():
            report(_report(config, progress, took, numbers))
    return state, progress


def _timing(config: PpoConfig, progress: _Progress, took: float) -> dict[str, float]:
    return {
        UPDATE: progress.updates,
        STEPS: progress.updates * config.steps_per_update,
        "timing/sps": config.steps_per_update / max(took, 1e-9),
        "timing/seconds": progress.seconds,
    }


def _report(
    config: PpoConfig, progress: _Progress, took: float, metrics: Mapping[str, float]
) -> Report:
    return Report(
        update=progress.updates,
        updates=config.num_updates,
        env_steps=progress.updates * config.steps_per_update,
        steps_per_second=config.steps_per_update / max(took, 1e-9),
        seconds_left=(config.num_updates - progress.updates) * took,
        metrics=metrics,
    )


def _agent(
    algorithm: str,
    trainer: Trainer,
    state: Any,
    progress: _Progress,
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


def _save(
    algorithm: str,
    trainer: Trainer,
    state: Any,
    progress: _Progress,
    out: Path,
    results: Mapping[str, float],
) -> None:
    agent = _agent(algorithm, trainer, state, progress, results)
    host = to_host(state)
    if not is_leader():
        return
    steps = progress.updates * trainer.setup.config.steps_per_update

    def beside(directory: Path) -> None:
        save_state(directory, host)
        (directory / PROGRESS).write_bytes(msgspec.json.encode(progress))

    target = out / RUN_CHECKPOINTS / str(steps)
    write_checkpoint(target, agent.card, agent.params["params"], extra=beside)
    # Only the newest state can be gone on from; the agents themselves are kept.
    for older in steps_of_run(out)[:-1]:
        shutil.rmtree(out / RUN_CHECKPOINTS / str(older) / STATE, ignore_errors=True)


def _newest_with_state(out: Path) -> Path | None:
    for step in reversed(steps_of_run(out)):
        directory = out / RUN_CHECKPOINTS / str(step)
        if (directory / STATE).is_dir() and (directory / PROGRESS).is_file():
            return directory
    return None


def _sweep(out: Path) -> None:
    """Remove what kills have left half written."""
    for folder in (out, out / RUN_CHECKPOINTS):
        for path in folder.glob(".*.tmp"):
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
    name, values = loads_config(path.read_text(encoding="utf-8"), str(path))
    before = make_config(name, values=values)
    if name != algorithm:
        raise KinetixError(f"{out}: this run was started with {name}, not {algorithm}")
    for field in dataclasses.fields(config):
        old, new = getattr(before, field.name), getattr(config, field.name)
        if field.name not in RESUMABLE and old != new:
            raise KinetixError(
                f"{path}: this run was started with {field.name} = {json.dumps(_plain(old))}, now "
                f"it is {json.dumps(_plain(new))}; choose another directory"
            )


def _plain(value: Any) -> Any:
    return dataclasses.asdict(value) if isinstance(value, NetworkConfig) else value
