"""One recorded episode: a level, what was driven in every step, and how it ended."""

import dataclasses
import functools
import hashlib
from collections.abc import Iterable
from typing import Final, Literal, TypeAlias, get_args

import numpy as np
from jaxtyping import Bool, Float, Int

from kinetix.engine.spec import Capacity
from kinetix.environment.outcome import Outcome
from kinetix.level.codec import level_hash
from kinetix.level.controls import channels_in_use
from kinetix.level.model import MOTOR_BINDINGS, THRUSTER_BINDINGS, Level
from kinetix.level.sizes import capacity_of

Source: TypeAlias = Literal["person", "agent", "solver"]
"""Player: hands, a policy, the search of `kinetix solve`."""
SOURCES: Final[tuple[Source, ...]] = get_args(Source)
CONTROLS: Final = MOTOR_BINDINGS + THRUSTER_BINDINGS
"""Entries of a unified action: −1 … 1 per motor binding, then 0 … 1 per thruster binding."""


@dataclasses.dataclass(frozen=True, kw_only=True)
class Origin:
    """Size and physics that an episode was played in."""

    capacity: Capacity
    physics: str
    """Preset or solver."""
    frame_skip: int
    """Engine steps (1/60 s) in one environment step."""


@dataclasses.dataclass(frozen=True, kw_only=True, eq=False)
class RecordedEpisode:
    """An episode; axis `k` is environment steps."""

    level: Level
    control: Float[np.ndarray, "k 6"]
    """The unified action of every step: −1 … 1 per motor binding, 0 … 1 per thruster binding."""
    reward: Float[np.ndarray, " k"]
    """Of every step, the distance reward included."""
    outcome: Outcome
    physics: str
    """Physics preset or solver that it was played under."""
    frame_skip: int
    """Engine steps (1/60 s) in one environment step."""
    source: Source
    player: str = ""
    """The agent's name; empty for people."""
    digest: str = ""
    """SHA-256 of the agent's parameters; empty where there are none."""
    seed: int = 0
    attempt: int = 0
    deterministic: bool = False
    replays: bool = True
    """True if the controls alone, played from the start in the step that all levels of the size
    share, end the same way in the same step."""

    @property
    def length(self) -> int:
        """Environment steps."""
        return len(self.control)

    @property
    def origin(self) -> Origin:
        """Size and physics that it was played in."""
        return Origin(
            capacity=capacity_of(self.level), physics=self.physics, frame_skip=self.frame_skip
        )

    @property
    def action(self) -> Int[np.ndarray, "k 6"]:
        """The multi-discrete action nearest to each control: 1 forward, 2 backward; 1 burning."""
        motors, thrusters = np.split(self.control, [MOTOR_BINDINGS], axis=1)
        signs = np.where(motors > 0.5, 1, np.where(motors < -0.5, 2, 0))
        return np.concatenate([signs, thrusters > 0.5], axis=1).astype(np.int8)

    @property
    def action_mask(self) -> Bool[np.ndarray, "6"]:
        """True for entries of an action that drive anything in the level."""
        return np.isin(np.arange(CONTROLS), channels_in_use(self.level))

    @functools.cached_property
    def identity(self) -> str:
        """16 hexadecimal digits of what determines the episode: equal ones are the same data."""
        facts = f"{level_hash(self.level)}|{self.physics}|{self.frame_skip}|"
        control = np.ascontiguousarray(self.control, "<f4").tobytes()
        return hashlib.sha256(facts.encode() + control).hexdigest()[:16]


def solution_episode(level: Level) -> RecordedEpisode | None:
    """Return a level's recorded solution as an episode; None where it has none.

    Rewards are 0 but for the last step's 1: a solution records its controls alone.

    Args:
        level: The level.
    """
    solution = level.solution
    if solution is None:
        return None
    return winning_plan(
        level,
        solution.unrolled(),
        physics=solution.physics,
        frame_skip=solution.frame_skip,
    )


def winning_plan(
    level: Level,
    actions: Iterable[Iterable[int]],
    *,
    physics: str,
    frame_skip: int,
    seed: int = 0,
    attempt: int = 0,
) -> RecordedEpisode:
    """Return a plan of multi-discrete actions that wins a level as an episode.

    Args:
        level: The level.
        actions: Six numbers per environment step; the last one wins.
        physics: Preset or solver under which it does.
        frame_skip: Engine steps per environment step.
        seed: Of the search.
        attempt: Number of the search or of its result.
    """
    rows = np.array([tuple(row) for row in actions], np.int8).reshape(-1, CONTROLS)
    motors, thrusters = np.split(rows, [MOTOR_BINDINGS], axis=1)
    signs = np.array([0.0, 1.0, -1.0], np.float32)[motors]
    reward = np.zeros(len(rows), np.float32)
    reward[-1:] = 1.0
    return RecordedEpisode(
        level=level,
        control=np.concatenate([signs, thrusters.astype(np.float32)], axis=1),
        reward=reward,
        outcome="won",
        physics=physics,
        frame_skip=frame_skip,
        source="solver",
        seed=seed,
        attempt=attempt,
    )
