"""The states of playback, each with its data, and the episode that most of them share."""

import dataclasses
from typing import TypeAlias

from editor.worker.requests import Casting
from editor.worker.snapshots import (
    ENGINE_STEPS_PER_SECOND,
    FRAME_SKIP,
    Action,
    Ring,
    Snapshot,
    Trace,
)
from kinetix.level.model import Level

_RATE_SECONDS = 1.0
"""The speed is measured over so much wall time [s]."""


@dataclasses.dataclass(kw_only=True)
class Episode:
    """An episode: level, player, and all that has happened."""

    level: Level
    casting: Casting | None
    """The agent that plays, or None when a person does."""
    player: str
    """Name of the agent."""
    physics: str = ""
    """Physics preset that it is played under; empty until it begins."""
    own_physics: str = ""
    """Preset that it restarts under, as an attempt of an evaluation; empty: the chosen one."""
    since: Snapshot | None = None
    """The moment whose level was changed: it begins there; None: at the level's first state."""
    snapshot: Snapshot | None = None
    """Snapshot on the screen."""
    ring: Ring = dataclasses.field(default_factory=Ring)
    actions: list[Action] = dataclasses.field(default_factory=list)
    """Actions of the steps that have arrived."""
    sent: list[Action | None] = dataclasses.field(default_factory=list)
    """Actions that were asked for and have not arrived; None: the agent's choice."""
    perturbed: bool = False
    """True if the mouse pulled at a body, or a person drove instead of the agent."""
    rate: list[tuple[float, int]] = dataclasses.field(default_factory=list)
    """Times [s] and steps that arrived in the last second."""

    @property
    def trace(self) -> Trace | None:
        """The episode so far; None before its first moment."""
        snapshots = self.ring.snapshots
        if not snapshots:
            return None
        casting = self.casting
        return Trace(
            physics=self.physics,
            perturbed=self.perturbed,
            snapshots=snapshots,
            actions=tuple(self.actions),
            player=self.player,
            seed=casting.seed if casting else 0,
            attempt=casting.attempt if casting else 0,
            deterministic=casting.deterministic if casting else False,
            digest=casting.digest if casting else "",
        )

    def measure(self, clock: float, step: int | None) -> None:
        """Note that a step has arrived (None: none has), and forget what is long ago."""
        if step is not None and step >= (self.rate[-1][1] if self.rate else 0):
            self.rate.append((clock, step))
        self.rate = [(t, n) for t, n in self.rate if t >= clock - _RATE_SECONDS]

    @property
    def real_time_factor(self) -> float:
        """Simulated time over wall time of the last second."""
        if len(self.rate) < 2:
            return 0.0
        (first, low), (last, high) = self.rate[0], self.rate[-1]
        skip = self.snapshot.frame_skip if self.snapshot else FRAME_SKIP
        simulated = (high - low) * skip / ENGINE_STEPS_PER_SECOND
        return simulated / (last - first) if last > first else 0.0


@dataclasses.dataclass(frozen=True, kw_only=True)
class Editing:
    """The document can be changed."""

    aside: Episode | None = None
    """A paused episode that waits while its level is changed."""


@dataclasses.dataclass(kw_only=True)
class Starting:
    """An episode was asked for, and its first state has not come (compiling)."""

    episode: Episode
    paused: bool = False
    """True if it is to stand still once it is there."""
    moment: Snapshot | None = None
    """The moment of a recording that it goes on from; None: its own first state."""


@dataclasses.dataclass(kw_only=True)
class Live:
    """The episode moves."""

    episode: Episode
    owed: float = 0.0
    """Time that has passed and was not yet simulated [s]."""


@dataclasses.dataclass(frozen=True, kw_only=True)
class Paused:
    """The episode stands still, and can be stepped."""

    episode: Episode


@dataclasses.dataclass(kw_only=True)
class Ended:
    """The episode has been won or lost, or its time is over."""

    episode: Episode
    seconds: float = 0.0
    """Time since the end [s]."""


@dataclasses.dataclass(kw_only=True)
class Replaying:
    """A recorded episode is looked at: one from a file, or the one that was under way."""

    episode: Episode
    trace: Trace
    index: int = 0
    """Index of the moment on the screen."""
    under_way: bool = False
    """True if the simulation still has the episode, so that it can go on at once."""
    running: bool = False
    """True if it moves on by itself."""
    loop: tuple[int, int] | None = None
    """The part that is shown again and again, first and last index."""
    owed: float = 0.0
    """Time that has passed and was not yet shown [s]."""


State: TypeAlias = Editing | Starting | Live | Paused | Ended | Replaying
