"""Records of a simulation: snapshots, a ring to step back in, traces of episodes."""

import dataclasses
from collections.abc import Sequence
from typing import Any, Final, TypeAlias

import numpy as np
from jaxtyping import Float

from kinetix.environment.outcome import Outcome

Action: TypeAlias = tuple[int, ...]
"""Multi-discrete: four motor channels in {0, 1, 2}, two thruster channels in {0, 1}."""

ENGINE_STEPS_PER_SECOND: Final = 60
"""Real time."""
FRAME_SKIP: Final = 2
"""Engine steps in one environment step when a person plays."""
RING_STATES: Final = 1024
"""Environment steps that can be stepped back; older ones can be looked at."""


@dataclasses.dataclass(frozen=True, kw_only=True)
class ContactPoint:
    """A place where two bodies touch; for debug drawing."""

    at: tuple[float, float]
    """Place of the contact [m]."""
    normal: tuple[float, float]
    """Unit vector from body a to body b."""
    separation: float
    """[m]; negative when the bodies overlap."""
    body_a: int | str
    body_b: int | str
    """Ids, or names of arena bodies."""


@dataclasses.dataclass(frozen=True, kw_only=True, eq=False)
class Futures:
    """Futures of a planner's last search; the plan that it follows comes first."""

    ways: Float[np.ndarray, "n k 2"]
    """Positions of the first green body [m]."""
    ends: tuple[str, ...]
    """`won`, `lost`, or nothing where the episode goes on."""
    steps: tuple[int, ...]
    """Environment steps until it ends, or as far as it was tried."""


@dataclasses.dataclass(frozen=True, kw_only=True)
class Mind:
    """Outputs of an agent in the step before."""

    intention: tuple[float, ...]
    """Expected action: −1 … 1 per motor binding, 0 … 1 per thruster binding."""
    own_action: tuple[float, ...]
    """Action that it chose, whether or not a person drove."""
    value: float
    """Expected return."""
    entropy: float
    """Of its policy over the controls that the level has [nat]."""
    chances: tuple[tuple[float, float, float], ...] = ()
    """Each control's probabilities of −1, 0 and +1; empty where they are not known."""
    by_hand: bool = False
    """True if a person drove instead."""
    scripted: bool = False
    """True if there is no network: value and entropy mean nothing."""
    futures: Futures | None = None
    """Futures of the last search, for a planner."""


@dataclasses.dataclass(frozen=True, kw_only=True)
class Snapshot:
    """One moment of an episode; rows are in the order of `level.bodies`, joints, thrusters."""

    step: int
    """Environment steps since the reset."""
    position: Float[np.ndarray, "b 2"]
    """Positions of the bodies [m]."""
    angle: Float[np.ndarray, " b"]
    """Angles of the bodies [rad]."""
    velocity: Float[np.ndarray, "b 2"]
    """Velocities of the bodies [m/s]."""
    angular_velocity: Float[np.ndarray, " b"]
    """Angular velocities of the bodies [rad/s]."""
    motor: Float[np.ndarray, " j"]
    """Drives of the motors in the step before, −1 … 1."""
    thruster: Float[np.ndarray, " t"]
    """Drives of the thrusters, 0 … 1."""
    touching: tuple[tuple[int | str, int | str], ...] = ()
    """Pairs of bodies that touch (ids, arena names); only where somebody asked."""
    contacts: tuple[ContactPoint, ...] = ()
    reward: float = 0.0
    """Reward of the step before."""
    total_reward: float = 0.0
    """Sum since the reset."""
    distance: float = 0.0
    """Green–blue distance that the dense reward measures [m]."""
    kinetic_energy: float = 0.0
    """[J]"""
    potential_energy: float = 0.0
    """Against gravity, from the level's origin [J]."""
    momentum: tuple[float, float] = (0.0, 0.0)
    """[kg m/s]"""
    penetration: float = 0.0
    """Deepest overlap of bodies that may touch [m]."""
    dropped: int = 0
    """Environment steps so far that met more contacts than physics has room for."""
    outcome: Outcome | None = None
    """Outcome of the episode, or None while it runs."""
    milliseconds: float = 0.0
    """Duration of the step's computation."""
    tailored: bool = False
    """True if that was the step compiled for this level alone, not the one of its size."""
    quick: bool = False
    """True if that step was compiled quickly: the other tier rounds differently."""
    action: tuple[float, ...] = ()
    """Action of the step before: −1 … 1 per motor binding, 0 … 1 per thruster binding."""
    mind: Mind | None = None
    """Outputs of the agent; None where none plays, and at the start."""
    frame_skip: int = FRAME_SKIP
    """Engine steps in one environment step of this episode."""
    state: Any = None
    """The simulator's own state as numpy arrays: only the simulator reads it."""
    memory: Any = None
    """The agent's memory after the step before, also as one row."""


class Ring:
    """The moments of an episode; the last ones with the simulator's state, for stepping back."""

    def __init__(self, states: int = RING_STATES) -> None:
        self._moments: list[Snapshot] = []
        self._states = states
        self.bare = 0
        """Number of the oldest moments that have lost their state: nobody can play on from them."""

    def __len__(self) -> int:
        return len(self._moments)

    @property
    def last(self) -> Snapshot | None:
        """The newest snapshot."""
        return self._moments[-1] if self._moments else None

    @property
    def snapshots(self) -> tuple[Snapshot, ...]:
        """All moments, oldest first."""
        return tuple(self._moments)

    def newest(self, count: int) -> tuple[Snapshot, ...]:
        """Return the last `count` snapshots, or all where there are fewer, oldest first."""
        return tuple(self._moments[max(len(self._moments) - count, 0) :])

    def clear(self) -> None:
        """Forget everything."""
        self._moments, self.bare = [], 0

    def push(self, snapshot: Snapshot) -> None:
        """Keep one more; the oldest state goes when there are too many."""
        self._moments.append(snapshot)
        if len(self._moments) - self.bare > self._states:
            oldest = self._moments[self.bare]
            self._moments[self.bare] = dataclasses.replace(oldest, state=None, memory=None)
            self.bare += 1

    def back(self) -> Snapshot | None:
        """Drop the newest and return the one before it, or None where that has no state."""
        if len(self._moments) - self.bare < 2:
            return None
        self._moments.pop()
        return self._moments[-1]

    def keep(self, snapshots: Sequence["Snapshot"]) -> None:
        """Hold exactly these, oldest first: those from the start to a moment that has its state."""
        self._moments = list(snapshots)
        self.bare = min(self.bare, max(len(snapshots) - 1, 0))


@dataclasses.dataclass(frozen=True, kw_only=True)
class Trace:
    """A whole episode: what was played under which physics."""

    physics: str
    perturbed: bool
    """True if the mouse pulled at a body, or a person drove instead of the agent; such episodes
    count in no statistics."""
    snapshots: tuple[Snapshot, ...]
    actions: tuple[Action, ...]
    """One a step: `actions[k]` led from `snapshots[k]` to `snapshots[k + 1]`."""
    player: str = ""
    """Name of the agent, or empty for a person."""
    seed: int = 0
    """Of the agent's draws, with `attempt` and `deterministic`."""
    attempt: int = 0
    deterministic: bool = False
    digest: str = ""
    """SHA-256 of the agent's parameters; empty for people and scripted agents."""
    from_file: bool = False
    """True if it was read from a file: then it can be looked at, and not be played on from."""

    def part(self, first: int, last: int) -> "Trace":
        """Return moments `first` to `last`, both included."""
        return dataclasses.replace(
            self,
            snapshots=self.snapshots[first : last + 1],
            actions=self.actions[first:last],
        )

    def arrays(self) -> dict[str, np.ndarray]:
        """Return the trace as arrays with time first, as an `.npz` file holds it."""
        stack = {
            name: np.stack([getattr(s, name) for s in self.snapshots])
            for name in ("position", "angle", "velocity", "angular_velocity", "motor", "thruster")
        }
        stack |= {
            name: np.array([getattr(s, name) for s in self.snapshots], np.float32)
            for name in ("total_reward", "kinetic_energy", "potential_energy", "momentum")
        }
        minds = [None if s.mind is None or s.mind.scripted else s.mind for s in self.snapshots]
        acted = [s.action for s in self.snapshots]
        intended = [() if mind is None else mind.intention for mind in minds]
        width = max(map(len, (*acted, *intended)), default=0)
        stack |= {
            "unified": _rows(acted, width),
            "intention": _rows(intended, width),
            "value": np.array([np.nan if mind is None else mind.value for mind in minds]),
            "entropy": np.array([np.nan if mind is None else mind.entropy for mind in minds]),
        }
        return stack | {
            "step": np.array([s.step for s in self.snapshots], np.int32),
            "reward": np.array([s.reward for s in self.snapshots], np.float32),
            "distance": np.array([s.distance for s in self.snapshots], np.float32),
            "action": np.array(self.actions, np.int32).reshape(
                len(self.actions), len(self.actions[0]) if self.actions else 0
            ),
            "outcome": np.array(self.snapshots[-1].outcome or ""),
            "physics": np.array(self.physics),
            "perturbed": np.array(self.perturbed),
            "player": np.array(self.player),
            "seed": np.array(self.seed, np.int64),
            "attempt": np.array(self.attempt, np.int64),
            "deterministic": np.array(self.deterministic),
            "digest": np.array(self.digest),
            "frame_skip": np.array(self.snapshots[0].frame_skip, np.int32),
        }


def _rows(rows: Sequence[tuple[float, ...]], width: int) -> Float[np.ndarray, "n w"]:
    """Tuples as rows of an array; NaN where there is nothing."""
    nothing = (np.nan,) * width
    return np.array([row or nothing for row in rows], np.float32).reshape(len(rows), width)


def channels_of(unified: Sequence[float]) -> Action:
    """Return the multi-discrete action nearest to a unified one.

    Args:
        unified: −1 … 1 per motor binding, 0 … 1 per thruster binding; the last two are thrusters'.
    """
    motors, thrusters = unified[:-2], unified[-2:]
    signs = [1 if value > 0 else 2 if value < 0 else 0 for value in motors]
    return (*signs, *(int(value > 0.5) for value in thrusters))
