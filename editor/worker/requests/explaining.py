"""An agent's observations, and the reasons for its actions."""

import dataclasses
from typing import Any, Literal, TypeAlias

import numpy as np
from jaxtyping import Float, UInt8

from editor.worker.requests.agents import AgentRef
from kinetix.level.model import Level

About: TypeAlias = Literal["value", "action"]
"""Target of a gradient (a test keeps it that of `kinetix.agents.explain`)."""


@dataclasses.dataclass(frozen=True, kw_only=True)
class Observe:
    """Ask for an agent's observation of a moment. Gives an `AgentView`."""

    level: Level
    state: Any
    """A snapshot's `state`, or None for the first state of the level."""
    agent: AgentRef | None
    """Agent whose form of observation is used; None: the entity form."""


@dataclasses.dataclass(frozen=True, kw_only=True)
class ViewTable:
    """One array of an observation with named columns."""

    name: str
    columns: tuple[tuple[str, str, str], ...]
    """Name, unit, meaning."""
    rows: tuple[str, ...]
    """Subject of each row."""
    values: Float[np.ndarray, "r c"]
    active: tuple[bool, ...]


@dataclasses.dataclass(frozen=True, kw_only=True)
class AgentView:
    """The picture and the numbers that an agent could see."""

    pixels: UInt8[np.ndarray, "h w 3"]
    """Rows from the top."""
    observation: str
    tables: tuple[ViewTable, ...]


@dataclasses.dataclass(frozen=True, kw_only=True)
class Explain:
    """Explain an agent's action at a moment. Gives an `Explained`."""

    level: Level
    state: Any
    """A snapshot's `state`, or None for the first state of the level."""
    memory: Any
    """The agent's at that moment; None: it has just begun."""
    agent: AgentRef
    physics: str
    about: About = "value"
    """Target of the gradient: the value, or the likeliest action's log-probability."""
    body: int | None = None
    """Id of a body for whose places the value is computed; None: of no body."""


@dataclasses.dataclass(frozen=True, kw_only=True, eq=False)
class Explained:
    """Reasons for an agent's action; rows in the order of the level's entities."""

    attention: Float[np.ndarray, " b"] | None
    """Each body's share; None for networks without attention."""
    bodies: Float[np.ndarray, " b"]
    """Importance of each body: see `kinetix.agents.explain.Saliency`."""
    joints: Float[np.ndarray, " j"]
    thrusters: Float[np.ndarray, " t"]
    value: float
    """Value of the present state."""
    body: int | None = None
    places: Float[np.ndarray, "h w"] | None = None
    """Value with the body's origin in the middle of each cell; rows from below."""
    low: tuple[float, float] = (0.0, 0.0)
    """Lower left corner of the places [m]."""
    cell: float = 0.0
    """Side of a cell [m]."""
