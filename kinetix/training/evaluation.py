"""Evaluation during training, under the published metric names."""

import statistics
import time
from collections.abc import Callable, Iterator, Sequence
from pathlib import Path
from typing import Any, Final

import jax
import numpy as np

from kinetix.agents.agent import Agent
from kinetix.agents.evaluate import NamedLevel, Progress, Settings, capacity_and_key, evaluate
from kinetix.agents.results import LevelResult, summarise
from kinetix.environment.generators.filters import EVALUATION_SEED
from kinetix.environment.params import static_env_params_from_size
from kinetix.errors import CheckpointError, KinetixError
from kinetix.level.codec import LoadedLevel, load_document
from kinetix.level.model import Level
from kinetix.level.sets import SetLevel, evaluation_part, gather_levels
from kinetix.level.sizes import capacity_of, describe_capacity
from kinetix.paths import levels_dir
from kinetix.training.config import PpoConfig
from kinetix.training.progress_text import Say, say_nothing
from kinetix.training.setup import Setup
from kinetix.wording import plural

_ENOUGH_WAITS: Final = 8
"""In so many waits those that compile are a minority."""


class TrainingEvaluation:
    """Plays fixed levels now and then."""

    def __init__(self, setup: Setup) -> None:
        """Choose the levels.

        Args:
            setup: The training.

        Raises:
            KinetixError: The agent could not play one of them.
        """
        config = setup.config
        self._config = config
        self._settings = Settings(
            attempts=config.eval_num_attempts, seed=config.seed, physics=config.physics
        )
        self._hand_designed = levels_to_watch(setup) if config.eval_freq else []
        self._sampled = _sampled(setup)
        self._longest = setup.longest_episode
        self._evaluated = False
        self.seconds: float | None = None
        """Duration of the last one, without compilation [s]; None: unknown."""

    @property
    def told(self) -> str:
        """A sentence about when and what it plays; empty where there is nothing to play."""
        config = self._config
        listed, sampled = len(self._hand_designed), len(self._sampled)
        if config.eval_levels or config.levels:
            field = "eval_levels" if config.eval_levels else "levels"
            parts = [f"{plural(listed, 'level')} that {field} names"] if listed else []
        else:
            parts = [f"{plural(listed, 'bundled level')} that fit {config.size}"] if listed else []
        if sampled:
            parts.append(plural(sampled, "random level"))
        if not parts:
            return ""
        return (
            f"evaluation every {plural(config.eval_freq, 'update')} and at the end: "
            f"{plural(config.eval_num_attempts, 'attempt')} each at {' and '.join(parts)}; "
            "eval_levels names others, with eval_freq 0 there is none"
        )

    @property
    def steps(self) -> int:
        """Environment steps of an evaluation in which no episode ends early."""
        levels = len(self._hand_designed) + len(self._sampled)
        return levels * self._settings.attempts * self._longest

    def __call__(
        self,
        agent: Agent,
        status: Say = say_nothing,
        stopped: Callable[[], bool] = lambda: False,
    ) -> dict[str, float]:
        """Metrics of an agent; none where somebody asks to stop meanwhile.

        Args:
            agent: With its present parameters.
            status: Takes words for how far it is.
            stopped: Whether somebody does; asked now and then.
        """
        metrics: dict[str, float] = {}
        waits: list[float] = []
        for kind, levels in (("hand_designed", self._hand_designed), ("sampled", self._sampled)):
            if levels:
                last: Progress | None = None
                for stage in _told(evaluate(agent, levels, self._settings), status, waits):
                    if stopped():
                        return {}
                    last = stage
                assert last is not None
                if last.failures:
                    raise CheckpointError(last.failures[0].error)
                metrics |= _means(kind, last.results)
                if kind == "hand_designed":
                    metrics |= _each(last.results)
        # All waits are for equally many steps, but the first ones of the first time compile too.
        if self._evaluated:
            self.seconds = sum(waits)
        elif len(waits) >= _ENOUGH_WAITS:
            self.seconds = statistics.median(waits) * len(waits)
        self._evaluated = True
        return metrics


def _told(stages: Iterator[Progress], status: Say, waits: list[float]) -> Iterator[Progress]:
    """Pass the stages of an evaluation on; note how long each took to come."""
    began = time.monotonic()
    for stage in stages:
        waits.append(time.monotonic() - began)
        status(f"evaluating {stage.done}/{plural(stage.total, 'episode')}")
        yield stage
        began = time.monotonic()


def _means(kind: str, results: Sequence[LevelResult]) -> dict[str, float]:
    summary = summarise(results)
    prefix = f"eval/{kind}_episode"
    return {
        f"{prefix}_return": float(np.mean([result.mean_return for result in results])),
        f"{prefix}_length": float(np.mean([result.mean_length for result in results])),
        f"{prefix}_solve_rate": summary["mean_solve_rate"],
        f"{prefix}_best_of_k_solve_rate": summary["best_of_k"],
    }


def _each(results: Sequence[LevelResult]) -> dict[str, float]:
    metrics: dict[str, float] = {}
    for result in results:
        metrics |= {
            f"eval_avg/hand_designed_episode_return_{result.level}": result.mean_return,
            f"eval_avg/hand_designed_episode_length_{result.level}": result.mean_length,
            f"eval_avg/hand_designed_episode_solve_rate_{result.level}": result.solve_rate,
        }
    groups = summarise(results)["groups"]
    return metrics | {f"eval_aggregate/solve_rate_{name}": rate for name, rate in groups.items()}


def evaluation_levels(config: PpoConfig) -> list[NamedLevel]:
    """The levels asked for, else the evaluation part of those trained on, else the bundled ones.

    Their files are read here and no more: a training outlasts moves and edits.

    Args:
        config: The configuration.
    """
    sources = config.eval_levels or config.levels
    levels = gather_levels(sources or [levels_dir()])
    if not config.eval_levels:
        # Of a set that is trained on, the part that is kept back for this.
        levels = evaluation_part(levels)
    room = static_env_params_from_size(config.size).capacity
    fitting = [level for level in levels if sources or room.covers(capacity_of(level.level))]
    return [NamedLevel(name=level.name, source=_as_read(level)) for level in fitting]


def levels_to_watch(setup: Setup, most: int | None = None) -> list[NamedLevel]:
    """Return the first of the levels that an agent is evaluated on.

    Args:
        setup: The training.
        most: How many at most; None: all.

    Raises:
        KinetixError: The agent could not play one of them.
    """
    levels = evaluation_levels(setup.config)[:most]
    for level in levels:
        _check_fit(level, setup)
    return levels


def _as_read(level: SetLevel) -> Level | LoadedLevel:
    """Return the level as in its file; kinetix-env's files hold more than a document."""
    return load_document(level.played) if isinstance(level.played, Path) else level.played


def _check_fit(level: NamedLevel, setup: Setup) -> None:
    """Refuse a level that the agent has no room for: in an evaluation it would be too late."""
    capacity, _ = capacity_and_key(level.source)
    if not setup.card.sees(capacity):
        named = "eval_levels" if setup.config.eval_levels else "levels"
        raise KinetixError(
            f"{named}: {level.name} has {describe_capacity(capacity)} (polygons, circles, joints, "
            f"thrusters), more than the agent of size {setup.config.size} sees: leave it out, or "
            "choose a larger size"
        )


def _sampled(setup: Setup) -> list[NamedLevel]:
    count = setup.config.eval_sampled_levels
    if setup.config.eval_freq == 0 or count == 0:
        return []
    levels: Any = setup.random_levels(jax.random.PRNGKey(EVALUATION_SEED), count)
    return [
        NamedLevel(
            name=f"random {index}", source=jax.tree.map(lambda x, i=index: np.asarray(x[i]), levels)
        )
        for index in range(count)
    ]
