"""Agents: loaded, rehearsed, evaluated."""

import dataclasses
from typing import Final

from kinetix.agents.results import LevelFailure, LevelResult
from kinetix.level.model import Level

PLANNER: Final = "planner"


BUILT_IN: Final = (PLANNER, "noop", "random")
"""Agents that need no folder (a test keeps them those of `kinetix.agents`)."""


@dataclasses.dataclass(frozen=True, kw_only=True)
class AgentRef:
    """Reference to an agent."""

    path: str
    """Its folder or training run, or the name of a scripted one."""
    stamp: str = ""
    """State of the folder that was loaded; another stamp is another agent."""


@dataclasses.dataclass(frozen=True, kw_only=True)
class Casting:
    """An agent and the draws that it gets: the same casting gives the same episode."""

    agent: AgentRef
    seed: int = 0
    attempt: int = 0
    """As in an evaluation: attempt k under a seed has the same draws in both."""
    deterministic: bool = False
    """Take the likeliest action instead of drawing one."""
    digest: str = ""
    """SHA-256 of the agent's parameters, for what is kept of the episode."""


@dataclasses.dataclass(frozen=True, kw_only=True)
class AgentSummary:
    """Facts about an agent for the window."""

    ref: AgentRef
    name: str
    description: str
    observation: str
    action: str
    network: str
    """In words: `entity transformer, 2 layers of 128, actor 5 × 128`."""
    parameters: int
    recurrent: bool
    capacity: tuple[int, int, int, int] | None
    """Polygons with the arena, circles, joints, thrusters that it was trained with."""
    any_size: bool
    """True if it plays levels of any size."""
    physics: str
    """Physics it was trained under."""
    frame_skip: int
    steps: int | None
    """Environment steps of training, where it says."""
    training: str
    """Algorithm and the like, one line."""
    folder: str
    """Folder of its arrays: of a training run the newest checkpoint."""
    digest: str = ""
    """SHA-256 of its parameters; empty for scripted ones."""
    dense_reward_scale: float | None = None
    """Weight of the distance reward; None where it is not known."""
    card_digest: str = ""
    """Digest of the rest of its card that affects how it plays; empty for scripted ones."""


@dataclasses.dataclass(frozen=True, kw_only=True)
class LoadAgent:
    """Read an agent from its folder. Gives an `AgentSummary`."""

    path: str


@dataclasses.dataclass(frozen=True, kw_only=True)
class Rehearse:
    """Compile what an agent needs to play a level, so that Play starts at once. Gives nothing."""

    level: Level
    physics: str
    casting: Casting
    quick: bool = False
    """Compile it quickly, unless there is a better one."""


@dataclasses.dataclass(frozen=True, kw_only=True)
class EvaluatedLevel:
    """A level of an evaluation."""

    name: str
    source: str | Level
    """A file, or the document as it stands."""


@dataclasses.dataclass(frozen=True, kw_only=True)
class Evaluate:
    """Play every agent on every level; shares each `Standing`, gives the last one."""

    agents: tuple[AgentRef, ...]
    levels: tuple[EvaluatedLevel, ...]
    attempts: int
    seed: int
    physics: str
    """Empty: each agent's own."""
    deterministic: bool


@dataclasses.dataclass(frozen=True, kw_only=True)
class Score:
    """Result of an agent on a level."""

    agent: int
    """Index into the agents that were asked for."""
    result: LevelResult


@dataclasses.dataclass(frozen=True, kw_only=True)
class Standing:
    """Progress of an evaluation."""

    done: int
    """Episodes that have ended."""
    total: int
    scores: tuple[Score, ...]
    errors: tuple[tuple[int, str], ...] = ()
    """Agents that could not play at all, and why."""
    failures: tuple[tuple[int, LevelFailure], ...] = ()
    """Agents and levels that they could not play."""
