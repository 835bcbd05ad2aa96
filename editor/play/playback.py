"""Edit, play, pause, step, restart: a state machine without a window."""

import enum
import math
from collections.abc import Sequence
from typing import Final, Protocol

from editor.base.controls import NOOP
from editor.worker.recording import (
    ENGINE_STEPS_PER_SECOND,
    FRAME_SKIP,
    Action,
    Ring,
    Snapshot,
    Trace,
    channels_of,
)
from editor.worker.requests import Casting, Pull
from kinetix.environment.outcome import Outcome
from kinetix.errors import KinetixError
from kinetix.level.model import Level

SPEEDS: Final = tuple(2.0**exponent for exponent in range(-4, 4))
"""1/16 … 8 times real time."""
BACKLOG_SECONDS: Final = 0.25
"""Largest lag of the simulation; beyond it, playback runs in slow motion [s]."""
OUTSTANDING_SECONDS: Final = 0.1
"""Time for which steps are asked for in advance: more would delay the keys [s]."""


class Mode(enum.Enum):
    """Mode of the app; the values stand in the record of a `state` event."""

    EDIT = "edit"
    PLAYING = "playing"
    PAUSED = "paused"
    ENDED = "ended"
    REPLAY = "replay"


class Simulator(Protocol):
    """Interface of the simulation to playback; answers may come in later frames."""

    keep_contacts: bool
    """True if the snapshots to come carry contact points (debug drawing, plots)."""

    @property
    def outstanding(self) -> int:
        """Steps that were asked for and have not arrived."""
        ...

    def start(
        self,
        level: Level,
        physics: str,
        casting: Casting | None = None,
        since: Snapshot | None = None,
    ) -> None:
        """Go to a level's first state; its snapshot arrives first.

        With `since` the episode has come so far already: steps and return go on from there.
        """
        ...

    def advance(self, actions: tuple[Action | None, ...], pull: Pull | None = None) -> None:
        """Play one environment step for each action; after the episode's end nothing arrives.

        None in the place of an action leaves the choice to the agent that was cast.
        """
        ...

    def restore(self, snapshot: Snapshot) -> None:
        """Go on from an earlier snapshot of this episode; nothing arrives for it."""
        ...

    def stop(self) -> None:
        """Drop everything that was asked for."""
        ...

    def drop(self) -> None:
        """Drop the steps that were asked for; the episode stays."""
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
        """Snapshot on the screen."""
        self.casting: Casting | None = None
        """The agent that plays, or None when a person does."""
        self.player = ""
        """Name of the agent."""
        self.episode = 0
        """Rises with every episode that starts."""
        self.running = False
        """In a replay: whether it moves on by itself."""
        self.loop: tuple[int, int] | None = None
        """The part of a replay that is shown again and again, first and last index."""
        self.ring = Ring()
        self.perturbed = False
        """True if the mouse pulled at a body, or a person drove instead of the agent."""
        self.failure = ""
        """Reason why the last episode could not start or continue; empty while all is well."""
        self._actions: list[Action] = []
        self._sent: list[Action | None] = []
        self._starting = False
        self._accumulator = 0.0
        self._ended_for = 0.0
        self._clock = 0.0
        self._rate: list[tuple[float, int]] = []
        self._replay: Trace | None = None
        self._replay_index = 0
        self._live = False
        self._branch: Snapshot | None = None
        self._since: Snapshot | None = None
        self.suspended = False
        """True if a paused episode waits while its level is changed."""

    @property
    def active(self) -> bool:
        """True if the app plays or replays (the document is not being edited)."""
        return self.mode is not Mode.EDIT

    @property
    def waiting(self) -> bool:
        """True if play was asked for and the first state has not come (compiling)."""
        return self._starting

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
        return self._accumulator / self.step_seconds

    @property
    def replay_index(self) -> int:
        """Index of the moment on the screen: the last one unless it is a replay."""
        if self.mode is Mode.REPLAY:
            return self._replay_index
        return max(len(self.ring) - 1, 0)

    @property
    def moments(self) -> tuple[Snapshot, ...]:
        """All moments that can be looked at, oldest first."""
        if self.mode is Mode.REPLAY and self._replay is not None:
            return self._replay.snapshots
        return self.ring.snapshots

    @property
    def can_branch(self) -> bool:
        """True if the episode can be played on from the moment on show."""
        shown = self.snapshot
        lasting = self._replay is not None and not self._replay.from_file
        return lasting and shown is not None and shown.outcome is None

    @property
    def real_time_factor(self) -> float:
        """Simulated time over wall time of the last second."""
        if len(self._rate) < 2:
            return 0.0
        (first, low), (last, high) = self._rate[0], self._rate[-1]
        simulated = (high - low) * self.frame_skip / ENGINE_STEPS_PER_SECOND
        return simulated / (last - first) if last > first else 0.0

    @property
    def actions(self) -> tuple[Action, ...]:
        """Actions of every step of the episode so far."""
        return self._replay.actions if self._replay is not None else tuple(self._actions)

    @property
    def trace(self) -> Trace | None:
        """The episode so far, as far back as the ring reaches."""
        if self.mode is Mode.REPLAY:
            return self._replay
        snapshots = self.ring.snapshots
        if not snapshots:
            return None
        actions = tuple(self._actions[len(self._actions) - len(snapshots) + 1 :])
        casting = self.casting
        return Trace(
            physics=self.physics,
            perturbed=self.perturbed,
            snapshots=snapshots,
            actions=actions,
            player=self.player,
            seed=casting.seed if casting else 0,
            attempt=casting.attempt if casting else 0,
            deterministic=casting.deterministic if casting else False,
            digest=casting.digest if casting else "",
        )

    def play(self, level: Level, casting: Casting | None = None, *, player: str = "") -> None:
        """Start an episode of a level from its first state.

        Args:
            level: The level.
            casting: The agent that plays; None: a person.
            player: What the agent is called.
        """
        self.level, self.casting, self.player = level, casting, player
        self._begin()
        self.mode = Mode.PLAYING

    def play_from(
        self,
        level: Level,
        since: Snapshot,
        casting: Casting | None = None,
        *,
        player: str = "",
    ) -> None:
        """Go on with an episode whose level was changed; moments before it are forgotten.

        Args:
            level: The level as it stands now.
            since: The moment that was changed: steps and return go on from it.
            casting: The agent that plays; None: a person.
            player: What the agent is called.
        """
        self.level, self.casting, self.player = level, casting, player
        self._begin(since)
        self.perturbed = True
        self.mode = Mode.PLAYING

    def suspend(self) -> None:
        """Set a paused episode aside while its level is changed; `resume` brings it back."""
        if self.mode is Mode.PAUSED:
            self.simulator.drop()
            self._sent = []
            self.mode, self.suspended = Mode.EDIT, True

    def resume(self) -> None:
        """Show the episode that was set aside; it is paused, as it was."""
        if self.suspended and self.snapshot is not None:
            self.mode, self.suspended = Mode.PAUSED, False
            self.simulator.restore(self.snapshot)

    def go_on(self) -> None:
        """Play on with the episode that was set aside."""
        self.resume()
        self.pause()

    def pause(self) -> None:
        """Pause, or go on; a replay that has come to its end begins again."""
        if self.mode is Mode.REPLAY:
            self.running = not self.running
            self._accumulator = 0.0
            if self.running and self._replay_index + 1 >= len(self.moments):
                self.scrub(0)
        elif self.mode is Mode.PLAYING:
            self.mode = Mode.PAUSED
        elif self.mode is Mode.PAUSED:
            self.mode = Mode.PLAYING
            self._accumulator = 0.0

    def step(self, action: Action | None = NOOP, pull: Pull | None = None) -> None:
        """Play one environment step and stay paused; in a replay, show the next moment."""
        if self.mode is Mode.REPLAY:
            self.running = False
            self.scrub(self._replay_index + 1)
        elif self.mode in (Mode.PLAYING, Mode.PAUSED) and not self._starting:
            self.mode = Mode.PAUSED
            self._send((action,), pull)

    def step_back(self) -> None:
        """Go back one environment step and pause; in a replay, show the moment before."""
        if self.mode is Mode.REPLAY:
            self.running = False
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
        """Start the episode anew, or where it was changed; a paused one stays paused."""
        if self.mode is Mode.EDIT:
            return
        since = self._since
        self._begin(since)
        self.perturbed = since is not None
        self.mode = Mode.PAUSED if self.mode is Mode.PAUSED else Mode.PLAYING

    def stop(self) -> None:
        """Back to editing; the document is as it was."""
        self.simulator.stop()
        self.mode = Mode.EDIT
        self.level = self.snapshot = self.casting = None
        self.player = ""
        self._starting = self.suspended = False
        self._forget()

    def replay(
        self, trace: Trace, level: Level, casting: Casting | None = None, *, player: str = ""
    ) -> None:
        """Show a recorded episode, read-only.

        Args:
            trace: The episode.
            level: Its level.
            casting: The agent that goes on when it is branched from; None: a person.
            player: What the agent is called.
        """
        self.simulator.stop()
        self._starting = False
        self._forget()
        self.episode += 1
        self.failure = ""
        self._replay, self.level, self.mode = trace, level, Mode.REPLAY
        self.casting, self.player = casting, player or trace.player
        self.scrub(0)

    def look_back(self) -> None:
        """Make a replay of the episode under way; `branch` goes on with it."""
        trace = self.trace
        if self.mode not in (Mode.PLAYING, Mode.PAUSED, Mode.ENDED) or trace is None:
            return
        self._replay, self._live, self.mode = trace, True, Mode.REPLAY
        self._replay_index, self.running, self.loop = len(trace.snapshots) - 1, False, None

    def scrub(self, index: int) -> None:
        """Show the moment `index`; an episode under way becomes a replay, as does one that ended.

        Outside, the nearest moment is shown.
        """
        if self.mode is not Mode.REPLAY:
            self.look_back()
        if self._replay is None:
            return
        self._replay_index = min(max(index, 0), len(self._replay.snapshots) - 1)
        self.snapshot = self._replay.snapshots[self._replay_index]

    def branch(self) -> None:
        """Play on from the moment of the replay on show; paused until told to go."""
        shown, trace = self.snapshot, self._replay
        if not self.can_branch or shown is None or trace is None or self.level is None:
            return
        index = self._replay_index
        live, physics = self._live, trace.physics
        self._sent, self._rate = [], []
        self._replay, self._live, self.running, self.loop = None, False, False, None
        self.ring.keep(trace.snapshots[: index + 1])
        self._actions = list(trace.actions[:index])
        self.perturbed = trace.perturbed
        self.mode = Mode.PAUSED
        if live:
            self.simulator.drop()
            self.simulator.restore(shown)
        else:
            self._branch, self._starting, self.physics = shown, True, physics
            self.simulator.start(self.level, physics, self.casting)

    def slower(self) -> None:
        """Halve the speed, down to 1/16."""
        self.speed = max((s for s in SPEEDS if s < self.speed), default=SPEEDS[0])

    def faster(self) -> None:
        """Double the speed, up to 8."""
        self.speed = min((s for s in SPEEDS if s > self.speed), default=SPEEDS[-1])

    def tick(self, elapsed: float, action: Action | None = NOOP, pull: Pull | None = None) -> None:
        """Let time pass: ask for the steps that are due and take what has arrived.

        Args:
            elapsed: Wall time since the last tick [s].
            action: What the held keys drive now; every step asked for in this tick gets it. None
                leaves it to the agent.
            pull: What the mouse pulls at.

        Raises:
            KinetixError: The simulation failed; playback is paused, or back in Edit when the
                episode could not even start.
        """
        self._clock += elapsed
        if self.mode is Mode.REPLAY:
            self._run_replay(elapsed)
            return
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

    def _run_replay(self, elapsed: float) -> None:
        """Move on in a recording; the loop, or the end, decides where it turns back or stops."""
        if not self.running or self._replay is None:
            return
        self._accumulator += elapsed
        count = len(self._replay.snapshots)
        first, last = self.loop if self.loop is not None else (0, count - 1)
        while self._accumulator >= self.step_seconds - 1e-6:
            self._accumulator -= self.step_seconds
            if self._replay_index < last:
                self.scrub(self._replay_index + 1)
            elif self.loop is not None:
                self.scrub(first)
            else:
                self.running = False
                return

    def _begin(self, since: Snapshot | None = None) -> None:
        assert self.level is not None
        self._forget()
        self.episode += 1
        self._starting, self.suspended = True, False
        self._since = since
        self.failure = ""
        if since is None:
            self.simulator.start(self.level, self.physics, self.casting)
        else:
            self.simulator.start(self.level, self.physics, self.casting, since)

    def _forget(self) -> None:
        self._replay, self._replay_index, self._live, self._branch = None, 0, False, None
        self.running, self.loop = False, None
        self.ring.clear()
        self._actions, self._sent, self._rate = [], [], []
        self._accumulator = self._ended_for = 0.0
        self.perturbed = False

    def _send(self, actions: tuple[Action | None, ...], pull: Pull | None) -> None:
        self._sent += actions
        helped = self.casting is not None and any(action is not None for action in actions)
        self.perturbed = self.perturbed or helped or pull is not None
        self.simulator.advance(actions, pull)

    def _take(self) -> None:
        try:
            arrived = self.simulator.take()
        except KinetixError as error:
            if self._starting:
                self.stop()
            else:
                self.mode = Mode.PAUSED
                self._sent = []
            self.failure = str(error)
            raise
        for snapshot in arrived:
            if self._starting:
                self._starting = False
                self._accumulator = 0.0
                branch, self._branch = self._branch, None
                if branch is not None:
                    self.simulator.restore(branch)
                    continue
            elif self._sent:
                sent = self._sent.pop(0)
                self._actions.append(channels_of(snapshot.action) if sent is None else sent)
            self.snapshot = snapshot
            self.ring.push(snapshot)
            if snapshot.outcome is not None:
                self.mode = Mode.ENDED
                self._sent = []
                self._ended_for = 0.0
                break
        if arrived and arrived[-1].step >= (self._rate[-1][1] if self._rate else 0):
            self._rate.append((self._clock, arrived[-1].step))
        self._rate = [(t, n) for t, n in self._rate if t >= self._clock - 1.0]
