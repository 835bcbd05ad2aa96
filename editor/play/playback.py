"""Edit, play, pause, step, restart: a state machine without a window."""

import math
from typing import Final

from editor.base.controls import NOOP
from editor.play.mode import Mode
from editor.play.playback_view import Show
from editor.play.simulator import Simulator
from editor.play.states import Editing, Ended, Episode, Live, Paused, Replaying, Starting, State
from editor.worker.requests import Casting, Pull
from editor.worker.snapshots import (
    Action,
    Snapshot,
    Trace,
    channels_of,
)
from kinetix.engine.names import DEFAULT_PHYSICS
from kinetix.errors import KinetixError
from kinetix.level.model import Level

SPEEDS: Final = tuple(2.0**exponent for exponent in range(-4, 4))
"""1/16 … 8 times real time."""
BACKLOG_SECONDS: Final = 0.25
"""Largest lag of the simulation; beyond it, playback runs in slow motion [s]."""
OUTSTANDING_SECONDS: Final = 0.1
"""Time for which steps are asked for in advance: more would delay the keys [s]."""


class Playback(Show):
    """Owns the state and its episode; reads the level when play starts and never writes it."""

    def __init__(self, simulator: Simulator) -> None:
        self.simulator = simulator
        self.state: State = Editing()
        self.physics = DEFAULT_PHYSICS
        """Physics preset that the person has chosen; see `next_physics`."""
        self.speed = 1.0
        """Target, in multiples of real time."""
        self.restart_automatically = False
        """Restart a second after the end."""
        self.episode = 0
        """Rises with every episode that starts."""
        self.failure = ""
        """Reason why the last episode could not start or continue; empty while all is well."""
        self._clock = 0.0

    @property
    def running(self) -> bool:
        """True if a replay moves on by itself."""
        return isinstance(self.state, Replaying) and self.state.running

    @running.setter
    def running(self, running: bool) -> None:
        if isinstance(self.state, Replaying):
            self.state.running = running

    @property
    def loop(self) -> tuple[int, int] | None:
        """The part of a replay that is shown again and again, first and last index."""
        return self.state.loop if isinstance(self.state, Replaying) else None

    @loop.setter
    def loop(self, loop: tuple[int, int] | None) -> None:
        if isinstance(self.state, Replaying):
            self.state.loop = loop

    def play(self, level: Level, casting: Casting | None = None, *, player: str = "") -> None:
        """Start an episode of a level from its first state.

        Args:
            level: The level.
            casting: The agent that plays; None: a person.
            player: Name of the agent.
        """
        self._begin(Episode(level=level, casting=casting, player=player))

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
            player: Name of the agent.
        """
        self._begin(
            Episode(
                level=level,
                casting=casting,
                player=player,
                own_physics=self.current.own_physics if self.current else "",
                since=since,
                perturbed=True,
            )
        )

    def cast(self, casting: Casting, player: str) -> None:
        """Let the next episode of this level have another agent, seed or attempt."""
        if self.current is not None:
            self.current.casting, self.current.player = casting, player

    def choose_physics(self, physics: str) -> None:
        """Play under another preset from the next episode on, an attempt on show too."""
        self.physics = physics
        if self.current is not None:
            self.current.own_physics = ""

    def suspend(self) -> None:
        """Set a paused episode aside while its level is changed; `resume` brings it back."""
        if isinstance(self.state, Paused):
            self.simulator.drop()
            self.state.episode.sent = []
            self.state = Editing(aside=self.state.episode)

    def resume(self) -> None:
        """Show the episode that was set aside; it is paused, as it was."""
        episode = self.current
        if self.suspended and episode is not None and episode.snapshot is not None:
            self.state = Paused(episode=episode)
            self.simulator.restore(episode.snapshot)

    def go_on(self) -> None:
        """Play on with the episode that was set aside."""
        self.resume()
        self.pause()

    def pause(self) -> None:
        """Pause, or go on; a replay that has come to its end begins again."""
        match self.state:
            case Replaying() as state:
                state.running, state.owed = not state.running, 0.0
                if state.running and state.index + 1 >= len(state.trace.snapshots):
                    self.scrub(0)
            case Starting() as state:
                state.paused = not state.paused
            case Live(episode=episode):
                self.state = Paused(episode=episode)
            case Paused(episode=episode):
                self.state = Live(episode=episode)

    def step(self, action: Action | None = NOOP, pull: Pull | None = None) -> None:
        """Play one environment step and stay paused; in a replay, show the next moment."""
        match self.state:
            case Replaying() as state:
                state.running = False
                self.scrub(state.index + 1)
            case Live(episode=episode) | Paused(episode=episode):
                self.state = Paused(episode=episode)
                self._send(episode, (action,), pull)

    def step_back(self) -> None:
        """Go back one environment step and pause; in a replay, show the moment before."""
        match self.state:
            case Replaying() as state:
                state.running = False
                self.scrub(state.index - 1)
            case Starting() as state:
                state.paused = True
            case Live(episode=episode) | Paused(episode=episode) | Ended(episode=episode):
                self.state = Paused(episode=episode)
                self._go_back(episode)

    def _go_back(self, episode: Episode) -> None:
        earlier = None if self.simulator.outstanding else episode.ring.back()
        if earlier is not None:
            episode.actions.pop()
            self.simulator.restore(earlier)
            episode.snapshot = earlier

    def reset(self) -> None:
        """Restart the episode, from where it was changed if it was; a paused one stays paused.

        In place of a player that is known by name only, as a file's is, a person plays.
        """
        if isinstance(self.state, Editing):
            return
        paused, last = self.mode is Mode.PAUSED, self.state.episode
        self._begin(
            Episode(
                level=last.level,
                casting=last.casting,
                player="" if last.casting is None else last.player,
                own_physics=last.own_physics,
                since=last.since,
                perturbed=last.since is not None,
            ),
            paused=paused,
        )

    def stop(self) -> None:
        """Return to editing; the document is as it was."""
        self.simulator.stop()
        self.state = Editing()

    def replay(
        self, trace: Trace, level: Level, casting: Casting | None = None, *, player: str = ""
    ) -> None:
        """Show a recorded episode, read-only.

        Args:
            trace: The episode.
            level: Its level.
            casting: The agent that goes on when it is branched from, or restarted under the same
                physics; None: a person.
            player: Name of the agent.
        """
        self.simulator.stop()
        self.episode += 1
        self.failure = ""
        episode = Episode(
            level=level,
            casting=casting,
            player=player or trace.player,
            physics=trace.physics,
            own_physics="" if casting is None else trace.physics,
        )
        self.state = Replaying(episode=episode, trace=trace)
        self.scrub(0)

    def look_back(self) -> None:
        """Make a replay of the episode under way; `branch` goes on with it."""
        state, trace = self.state, self.trace
        if trace is None or isinstance(state, Editing | Replaying):
            return
        self.state = Replaying(
            episode=state.episode,
            trace=trace,
            index=len(trace.snapshots) - 1,
            under_way=not isinstance(state, Starting),
        )

    def scrub(self, index: int) -> None:
        """Show the moment `index`; an episode under way becomes a replay, as does one that ended.

        Outside, the nearest moment is shown.
        """
        self.look_back()
        if isinstance(self.state, Replaying):
            moments = self.state.trace.snapshots
            self.state.index = min(max(index, 0), len(moments) - 1)
            self.state.episode.snapshot = moments[self.state.index]

    def branch(self) -> None:
        """Play on from the moment of the replay on show; paused at first."""
        state, shown = self.state, self.snapshot
        if not isinstance(state, Replaying) or not self.can_branch or shown is None:
            return
        episode, trace = state.episode, state.trace
        episode.sent, episode.rate = [], []
        episode.ring.keep(trace.snapshots[: state.index + 1])
        episode.actions = list(trace.actions[: state.index])
        episode.perturbed = trace.perturbed
        if state.under_way:
            self.state = Paused(episode=episode)
            self.simulator.drop()
            self.simulator.restore(shown)
        else:
            self.state = Starting(episode=episode, paused=True, moment=shown)
            if not episode.own_physics:
                self.physics = episode.physics
            self.simulator.start(episode.level, episode.physics, episode.casting)

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
        if isinstance(self.state, Replaying):
            self._run_replay(self.state, elapsed)
            return
        self._take()
        if isinstance(self.state, Live):
            self._drive(self.state, elapsed, action, pull)
        if isinstance(self.state, Ended) and self.restart_automatically:
            self.state.seconds += elapsed
            if self.state.seconds >= 1.0:
                self.reset()

    def _drive(self, state: Live, elapsed: float, action: Action | None, pull: Pull | None) -> None:
        """Ask for the steps that are due."""
        backlog = max(BACKLOG_SECONDS, self.step_seconds) + elapsed
        state.owed = min(state.owed + elapsed, backlog)
        due = math.floor(state.owed / self.step_seconds + 1e-6)
        room = max(math.ceil(OUTSTANDING_SECONDS / self.step_seconds), 1, due)
        steps = min(due, room - self.simulator.outstanding)
        if steps > 0:
            state.owed -= steps * self.step_seconds
            self._send(state.episode, (action,) * steps, pull)
            self._take()

    def _run_replay(self, state: Replaying, elapsed: float) -> None:
        """Move on in a recording; the loop, or the end, decides where it turns back or stops."""
        if not state.running:
            return
        state.owed += elapsed
        first, last = state.loop if state.loop is not None else (0, len(state.trace.snapshots) - 1)
        while state.owed >= self.step_seconds - 1e-6:
            state.owed -= self.step_seconds
            if state.index < last:
                self.scrub(state.index + 1)
            elif state.loop is not None:
                self.scrub(first)
            else:
                state.running = False
                return

    def _begin(self, episode: Episode, *, paused: bool = False) -> None:
        self.episode += 1
        self.failure = ""
        # Until its first state comes, the last one stays on show, unless the level has changed.
        episode.snapshot = self.snapshot if self.level == episode.level else None
        episode.physics = episode.own_physics or self.physics
        self.state = Starting(episode=episode, paused=paused)
        since = () if episode.since is None else (episode.since,)
        self.simulator.start(episode.level, episode.physics, episode.casting, *since)

    def _send(
        self, episode: Episode, actions: tuple[Action | None, ...], pull: Pull | None
    ) -> None:
        episode.sent += actions
        helped = episode.casting is not None and any(action is not None for action in actions)
        episode.perturbed = episode.perturbed or helped or pull is not None
        self.simulator.advance(actions, pull)

    def _take(self) -> None:
        """Take what has arrived.

        Raises:
            KinetixError: The simulation failed.
        """
        try:
            arrived = self.simulator.take()
        except KinetixError as error:
            self._fail()
            self.failure = str(error)
            raise
        state = self.state
        if isinstance(state, Editing):
            return
        for snapshot in arrived:
            self._arrive(snapshot)
            if isinstance(self.state, Ended):
                break
        state.episode.measure(self._clock, arrived[-1].step if arrived else None)

    def _fail(self) -> None:
        match self.state:
            case Starting():
                self.stop()
            case Live(episode=episode) | Paused(episode=episode) | Ended(episode=episode):
                episode.sent = []
                self.state = Paused(episode=episode)

    def _arrive(self, snapshot: Snapshot) -> None:
        """Show a moment that the simulation has made, and keep it."""
        assert not isinstance(self.state, Editing)
        episode = self.state.episode
        if isinstance(self.state, Starting):
            moment = self.state.moment
            kind = Paused if self.state.paused else Live
            self.state = kind(episode=episode)
            if moment is not None:
                self.simulator.restore(moment)
                return
        elif episode.sent:
            sent = episode.sent.pop(0)
            episode.actions.append(channels_of(snapshot.action) if sent is None else sent)
        episode.snapshot = snapshot
        episode.ring.push(snapshot)
        if snapshot.outcome is not None:
            episode.sent = []
            self.state = Ended(episode=episode)
