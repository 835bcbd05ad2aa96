"""The episode on show: its level, its player, its moments, read from the state of playback."""

from editor.play.mode import Mode, mode_of
from editor.play.states import Editing, Episode, Live, Replaying, Starting, State
from editor.worker.requests import Casting
from editor.worker.snapshots import (
    ENGINE_STEPS_PER_SECOND,
    FRAME_SKIP,
    Action,
    Ring,
    Snapshot,
    Trace,
)
from kinetix.environment.outcome import Outcome
from kinetix.level.model import Level


class Show:
    """Read-only view of the state of playback."""

    state: State
    physics: str
    """Physics preset that the person has chosen."""
    speed: float
    episode: int
    """Rises with every episode that starts."""

    @property
    def mode(self) -> Mode:
        """Mode of the app."""
        return mode_of(self.state)

    @property
    def current(self) -> Episode | None:
        """The episode on show or set aside; None while nothing is played."""
        state = self.state
        return state.aside if isinstance(state, Editing) else state.episode

    @property
    def active(self) -> bool:
        """True if the app plays or replays (the document is not being edited)."""
        return not isinstance(self.state, Editing)

    @property
    def suspended(self) -> bool:
        """True if a paused episode waits while its level is changed."""
        return isinstance(self.state, Editing) and self.state.aside is not None

    @property
    def waiting(self) -> bool:
        """True if play was asked for and the first state has not come (compiling)."""
        return isinstance(self.state, Starting)

    @property
    def level(self) -> Level | None:
        """The level being played."""
        return self.current.level if self.current else None

    @property
    def snapshot(self) -> Snapshot | None:
        """Snapshot on the screen."""
        return self.current.snapshot if self.current else None

    @property
    def casting(self) -> Casting | None:
        """The agent that plays, or None when a person does."""
        return self.current.casting if self.current else None

    @property
    def player(self) -> str:
        """Name of the agent."""
        return self.current.player if self.current else ""

    @property
    def played_under(self) -> str:
        """Physics preset of the episode on show; of the next one while there is none."""
        return self.current.physics if self.current else self.physics

    @property
    def next_physics(self) -> str:
        """Physics preset of the next episode: the chosen one, or that of the attempt on show."""
        return (self.current.own_physics if self.current else "") or self.physics

    @property
    def perturbed(self) -> bool:
        """True if the mouse pulled at a body, or a person drove instead of the agent."""
        return self.current.perturbed if self.current else False

    @property
    def ring(self) -> Ring:
        """The episode's moments."""
        return self.current.ring if self.current else Ring()

    @property
    def step_count(self) -> int:
        """Environment steps of the snapshot on show."""
        return self.snapshot.step if self.snapshot else 0

    @property
    def outcome(self) -> Outcome | None:
        """Outcome of the episode, or None."""
        return self.snapshot.outcome if self.snapshot else None

    @property
    def frame_skip(self) -> int:
        """Engine steps in one environment step of this episode."""
        return self.snapshot.frame_skip if self.snapshot else FRAME_SKIP

    @property
    def engine_step(self) -> int:
        """Engine steps of the snapshot on show."""
        return self.step_count * self.frame_skip

    @property
    def step_seconds(self) -> float:
        """Real time of one environment step at the present speed [s]."""
        return self.frame_skip / ENGINE_STEPS_PER_SECOND / self.speed

    @property
    def step_share(self) -> float:
        """Share of the time until the next step that has passed, 0 … 1."""
        return (
            self.state.owed / self.step_seconds if isinstance(self.state, Live | Replaying) else 0.0
        )

    @property
    def replay_index(self) -> int:
        """Index of the moment on the screen: the last one unless it is a replay."""
        if isinstance(self.state, Replaying):
            return self.state.index
        return max(len(self.ring) - 1, 0)

    @property
    def moments(self) -> tuple[Snapshot, ...]:
        """All moments that can be looked at, oldest first."""
        if isinstance(self.state, Replaying):
            return self.state.trace.snapshots
        return self.ring.snapshots

    @property
    def can_branch(self) -> bool:
        """True if the episode can be played on from the moment on show."""
        state, shown = self.state, self.snapshot
        if not isinstance(state, Replaying) or state.trace.from_file:
            return False
        kept = state.index >= state.episode.ring.bare
        return kept and shown is not None and shown.outcome is None

    @property
    def real_time_factor(self) -> float:
        """Simulated time over wall time of the last second."""
        return self.current.real_time_factor if self.current else 0.0

    @property
    def actions(self) -> tuple[Action, ...]:
        """Actions of every step of the episode so far."""
        if isinstance(self.state, Replaying):
            return self.state.trace.actions
        return tuple(self.current.actions) if self.current else ()

    @property
    def trace(self) -> Trace | None:
        """The episode so far."""
        if isinstance(self.state, Replaying):
            return self.state.trace
        return self.current.trace if self.current else None
