"""Levels: drawn at random, changed, checked."""

import dataclasses
from typing import Final

from kinetix.engine.names import DEFAULT_PHYSICS
from kinetix.environment.outcome import Outcome
from kinetix.level.model import Level

MUTATIONS: Final = (
    ("add_shape", "Add a shape"),
    ("add_connected_shape", "Add a jointed shape"),
    ("add_thruster", "Add a thruster"),
    ("remove_shape", "Remove a shape"),
    ("remove_joint", "Remove a joint"),
    ("remove_thruster", "Remove a thruster"),
    ("swap_role", "Swap two roles"),
    ("toggle_fixture", "Fix or free a shape"),
    ("change_gravity", "Change gravity"),
    ("change_size", "Change a size"),
    ("change_location", "Move a shape"),
    ("change_rotation", "Turn a shape"),
)
"""Names and labels of the mutations that the simulation offers."""


@dataclasses.dataclass(frozen=True, kw_only=True)
class RandomLevel:
    """Draw a random level. Gives a `Level`."""

    seed: int
    size: str
    machine: bool = False
    """True for a machine with a task, False for a heap of shapes."""


@dataclasses.dataclass(frozen=True, kw_only=True)
class Mutate:
    """Change a level at random; None takes a random mutation. Gives a `Level`."""

    level: Level
    mutation: str | None
    seed: int


@dataclasses.dataclass(frozen=True, kw_only=True)
class CheckDynamics:
    """Play the no-op and random actions in a level (I301, I302). Gives a `DynamicsReport`."""

    level: Level
    physics: str = DEFAULT_PHYSICS
    attempts: int = 64


@dataclasses.dataclass(frozen=True, kw_only=True)
class DynamicsReport:
    """Outcome of a level without a plan."""

    noop_outcome: Outcome
    """See `kinetix.environment.outcome.Outcome`."""
    noop_steps: int
    random_solved: float
    """Share of the attempts."""
    attempts: int
