"""Edit, play, pause, step, restart: a state machine without a window."""

import enum
import math
from collections.abc import Sequence
from typing import Final, Protocol

from editor.controls import NOOP
from editor.recording import (
    ENGINE_STEPS_PER_SECOND,
    FRAME_SKIP,
    Action,
    Ring,
    Snapshot,
    Trace,
)
from editor.requests import Pull
from kinetix.errors import KinetixError
from kinetix.level.model import Level

SPEEDS: Final = tuple(2.0**exponent for exponent in range(-4, 4))
"""1/16 … 8 times real time."""
BACKLOG_SECONDS: Final = 0.25
"""How far the simulation may fall behind before time is given up: then it runs in slow motion."""
OUTSTANDING_SECONDS: Final = 0.1
"""How far ahead steps are asked for: more would delay the keys."""


class Mode(enum.Enum):
    """What the app does with the level; the values stand in the record of a `state` event."""

    EDIT = "edit"
    PLAYING = "playing"
    PAUSED = "paused"
    ENDED = "ended"
    REPLAY = "replay"


class Simulator(Protocol):
    """What playback asks of the simulation; answers may come in later frames."""

    keep_contacts: bool
    """Whether the snapshots to come carry contact points (debug drawing, plots)."""

    @property
    def outstanding(self) -> int:
        """Steps that were asked for and have not arrived."""
        ...

    def start(self, level: Level, physics: str) -> None:
        """Go to a level's first state; its snapshot arrives first."""
        ...

    def advance(self, actions: tuple[Action, ...], pull: Pull | None = None) -> None:
        """Play one environment step for each action; after the episode's end nothing arrives."""
        ...

    def restore(self, snapshot: Snapshot) -> None:
        """Go on from an earlier snapshot of this episode; nothing arrives for it."""
        ...

    def stop(self) -> None:
        """Drop everything that was asked for."""
        ...

    def take(self) -> Sequence[Snapshot]:
        """Snapshots that arrived since the last call, in order.

        Raises:
            KinetixError: The simulation failed; the sentence says why.
        """
        ...


class Playback:
    """Owns the mode and the episode; reads the level when play starts and never writes it."""

    def __init__(self, simulator: Simulator) -> None:
        self.simulator = simulator
        self.mode = Mode.EDIT
        self.physics = "balanced"
        """Physics preset of the next episode."""
        self.speed = 1.0
        """Target, in multiples of real time."""
        self.restart_automatically = False
        """Start anew after an end, a second later."""
        self.level: Level | None = None
        """The level being played."""
        self.snapshot: Snapshot | None = None
        """What is on show."""
        self.ring = Ring()
        self.perturbed = False
        """Whether the mouse pulled at a body in this episode."""
        self.failure = ""
        """Why the last episode could not start or go on; empty while all is well."""
        self._actions: list[Action] = []
        self._sent: list[Action] = []
        self._starting = False
        self._accumulator = 0.0
        self._ended_for = 0.0
        self._clock = 0.0
        self._rate: list[tuple[float, int]] = []
        self._replay: Trace | None = None
        self._replay_index = 0

    @property
    def active(self) -> bool:
        """Whether the app plays or replays (the document is not being edited)."""
        return self.mode is not Mode.EDIT

    @property
    def waiting(self) -> bool:
        """Whether play was asked for and the first state has not come (compiling)."""
        return self._starting

    @property
    def step_count(self) -> int:
        """Environment steps of the snapshot on show."""
        return self.snapshot.step if self.snapshot else 0

    @property
    def outcome(self) -> str | None:
        """How the episode ended, or None."""
        return self.snapshot.outcome if self.snapshot else None

    @property
    def step_seconds(self) -> float:
        """Real time of one environment step at the present speed [s]."""
        return FRAME_SKIP / ENGINE_STEPS_PER_SECOND / self.speed

    @property
    def real_time_factor(self) -> float:
        """Simulated time over wall time of the last second."""
        if len(self._rate) < 2:
            return 0.0
        (first, low), (last, high) = self._rate[0], self._rate[-1]
        simulated = (high - low) * FRAME_SKIP / ENGINE_STEPS_PER_SECOND
        return simulated / (last - first) if last > first else 0.0

    @property
    def trace(self) -> Trace | None:
        """The episode so far, as far back as the ring reaches."""
        if self.mode is Mode.REPLAY:
            return self._replay
        snapshots = self.ring.snapshots
        if not snapshots:
            return None
        actions = tuple(self._actions[len(self._actions) - len(snapshots) + 1 :])
        return Trace(
            physics=self.physics, perturbed=self.perturbed, snapshots=snapshots, actions=actions
        )

    def play(self, level: Level) -> None:
        """Start an episode of a level from its first state."""
        self.level = level
        self._begin()
        self.mode = Mode.PLAYING

    def pause(self) -> None:
        """Pause, or go on."""
        if self.mode is Mode.PLAYING:
            self.mode = Mode.PAUSED
        elif self.mode is Mode.PAUSED:
            self.mode = Mode.PLAYING
            self._accumulator = 0.0

    def step(self, action: Action = NOOP, pull: Pull | None = None) -> None:
        """Play one environment step and stay paused; in a replay, show the next moment."""
        if self.mode is Mode.REPLAY:
            self.scrub(self._replay_index + 1)
        elif self.mode in (Mode.PLAYING, Mode.PAUSED) and not self._starting:
            self.mode = Mode.PAUSED
            self._send((action,), pull)

    def step_back(self) -> None:
        """Go back one environment step and pause; in a replay, show the moment before."""
        if self.mode is Mode.REPLAY:
            self.scrub(self._replay_index - 1)
            return
        if self.mode not in (Mode.PLAYING, Mode.PAUSED, Mode.ENDED):
            return
        self.mode = Mode.PAUSED
        if self._starting or self.simulator.outstanding:
            return
        earlier = self.ring.back()
        if earlier is not None:
            self._actions.pop()
            self.simulator.restore(earlier)
            self.snapshot = earlier

    def reset(self) -> None:
        """Start the episode anew; a paused one stays paused."""
        if self.mode in (Mode.EDIT, Mode.REPLAY):
            return
        self._begin()
        self.mode = Mode.PAUSED if self.mode is Mode.PAUSED else Mode.PLAYING

    def stop(self) -> None:
        """Back to editing; the document is as it was."""
        self.simulator.stop()
        self.mode = Mode.EDIT
        self.level = self.snapshot = self._replay = None
        self._starting = False
        self._forget()

    def replay(self, trace: Trace, level: Level) -> None:
        """Show a recorded episode, read-only."""
        self.simulator.stop()
        self._replay, self.level, self.mode = trace, level, Mode.REPLAY
        self.scrub(0)

    def scrub(self, index: int) -> None:
        """Show the moment `index` of the replay; outside, the nearest one."""
        if self._replay is None:
            return
        self._replay_index = min(max(index, 0), len(self._replay.snapshots) - 1)
        self.snapshot = self._replay.snapshots[self._replay_index]

    def slower(self) -> None:
        """Halve the speed, down to 1/16."""
        self.speed = max((s for s in SPEEDS if s < self.speed), default=SPEEDS[0])

    def faster(self) -> None:
        """Double the speed, up to 8."""
        self.speed = min((s for s in SPEEDS if s > self.speed), default=SPEEDS[-1])

    def tick(self, elapsed: float, action: Action = NOOP, pull: Pull | None = None) -> None:
        """Let time pass: ask for the steps that are due and take what has arrived.

        Args:
            elapsed: Wall time since the last tick [s].
            action: What the held keys drive now; every step asked for in this tick gets it.
            pull: What the mouse pulls at.

        Raises:
            KinetixError: The simulation failed; playback is paused, or back in Edit when the
                episode could not even start.
        """
        self._clock += elapsed
        self._take()
        if self.mode is Mode.PLAYING and not self._starting:
            backlog = max(BACKLOG_SECONDS, self.step_seconds) + elapsed
            self._accumulator = min(self._accumulator + elapsed, backlog)
            due = math.floor(self._accumulator / self.step_seconds + 1e-6)
            room = max(math.ceil(OUTSTANDING_SECONDS / self.step_seconds), 1, due)
            steps = min(due, room - self.simulator.outstanding)
            if steps > 0:
                self._accumulator -= steps * self.step_seconds
                self._send((action,) * steps, pull)
                self._take()
        if self.mode is Mode.ENDED and self.restart_automatically:
            self._ended_for += elapsed
            if self._ended_for >= 1.0:
                self.reset()

    def _begin(self) -> None:
        assert self.level is not None
        self._forget()
        self._starting = True
        self.failure = ""
        self.simulator.start(self.level, self.physics)

    def _forget(self) -> None:
        self.ring.clear()
        self._actions, self._sent, self._rate = [], [], []
        self._accumulator = self._ended_for = 0.0
        self.perturbed = False

    def _send(self, actions: tuple[Action, ...], pull: Pull | None) -> None:
        self._sent += actions
        self.perturbed = self.perturbed or pull is not None
        self.simulator.advance(actions, pull)

    def _take(self) -> None:
        try:
            arrived = self.simulator.take()
        except KinetixError as error:
            if self._starting:
                self.stop()
            else:
                self.mode = Mode.PAUSED
            self.failure = str(error)
            raise
        for snapshot in arrived:
            if self._starting:
                self._starting = False
                self._accumulator = 0.0
            elif self._sent:
                self._actions.append(self._sent.pop(0))
            self.snapshot = snapshot
            self.ring.push(snapshot)
            if snapshot.outcome is not None:
                self.mode = Mode.ENDED
                self._sent = []
                self._ended_for = 0.0
                break
        if arrived:
            self._rate.append((self._clock, arrived[-1].step))
        self._rate = [(t, n) for t, n in self._rate if t >= self._clock - 1.0]
