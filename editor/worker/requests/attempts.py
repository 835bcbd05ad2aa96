"""Paths of the attempts of an evaluation, and the steps at which they part."""

import dataclasses

import numpy as np
from jaxtyping import Float, Int

from editor.worker.requests.agents import Casting, EvaluatedLevel
from kinetix.environment.outcome import Outcome


@dataclasses.dataclass(frozen=True, kw_only=True)
class TracePaths:
    """Note where the green shape is in all attempts on a level. Gives `AttemptPaths`."""

    level: EvaluatedLevel
    casting: Casting
    """With any attempt."""
    attempts: int
    physics: str


@dataclasses.dataclass(frozen=True, kw_only=True)
class Ending:
    """Attempts that end alike; the fields of `kinetix.agents.trajectories.Ending`."""

    outcome: Outcome
    attempts: tuple[int, ...]
    place: tuple[float, float]
    length: int
    parting: int | None


@dataclasses.dataclass(frozen=True, kw_only=True, eq=False)
class AttemptPaths:
    """The ways of all attempts on a level; axis `n` attempts, `k` places in time."""

    level_hash: str
    step: Int[np.ndarray, " k"]
    """Environment steps since the start."""
    position: Float[np.ndarray, "n k 2"]
    """Of the first green shape [m]."""
    outcomes: tuple[Outcome, ...]
    parting: int | None
    """Step at which attempts that are won leave the others; None where they do not."""
    endings: tuple[Ending, ...] = ()
    """The attempts grouped by how they end, the largest group first."""
