"""A second episode that keeps step with the one on show: for comparing two players.

It plays as far as the first one has come, in engine steps, and keeps every moment, so that it
follows a timeline back and forth too. Once the first one has ended it goes on by itself to its own
end.
"""

from collections.abc import Callable, Sequence
from typing import TypeAlias

from editor.play.simulator import Simulator
from editor.worker.requests import Casting
from editor.worker.snapshots import ENGINE_STEPS_PER_SECOND, FRAME_SKIP, Action, Snapshot
from kinetix.errors import KinetixError
from kinetix.level.model import Level

_AHEAD = 2
"""Steps that are asked for before they are needed, so that it is there when the first one is."""
_AT_ONCE = 8
"""Steps in one request at most: the first episode must not wait long for its turn."""


Mirror: TypeAlias = Callable[[], Sequence[Action]]
"""Actions of the first episode so far, step by step."""


class Follower:
    """The second episode."""

    def __init__(self, simulator: Simulator) -> None:
        self.simulator = simulator
        self.level: Level | None = None
        self.player = ""
        """Name of the player; empty: none."""
        self.casting: Casting | None = None
        """Agent and draws of the episode; None: nobody plays, or the first one is followed."""
        self.failure = ""
        """Reason why it could not start or continue."""
        self.snapshots: list[Snapshot] = []
        self._starting = False
        self._beyond = 0.0
        """Engine steps that it has gone on since the first one ended."""
        self._goes_on = False
        self._mirror: Mirror | None = None
        self._used: list[Action] = []

    @property
    def active(self) -> bool:
        """True if there is a second episode."""
        return self.level is not None

    @property
    def waiting(self) -> bool:
        """True if its first state has not come."""
        return self._starting

    @property
    def preparing(self) -> bool:
        """True if its first state has not come, and nothing says that it will not."""
        return self._starting and not self.failure

    @property
    def goes_on(self) -> bool:
        """True while it plays on and the first one has ended."""
        return self._goes_on

    def start(
        self,
        level: Level,
        physics: str,
        casting: Casting | None,
        *,
        player: str,
        mirror: Mirror | None = None,
    ) -> None:
        """Begin an episode.

        Args:
            level: The level.
            physics: Preset or solver, which may differ from the first episode's.
            casting: Who plays; None: nobody, all controls stay at rest.
            player: What that is called on the screen.
            mirror: Where there is no agent: what to do, the same as in the first episode.
        """
        self.stop()
        self._mirror = mirror if casting is None else None
        self.level, self.player, self._starting = level, player, True
        self.casting = casting
        self.simulator.start(level, physics, casting)

    def stop(self) -> None:
        """Forget everything."""
        self.simulator.stop()
        self.level, self.player, self.failure = None, "", ""
        self.casting = None
        self.snapshots, self._starting = [], False
        self._goes_on, self._beyond = False, 0.0
        self._mirror, self._used = None, []

    def tick(self, engine_step: int, *, alone: float | None = None) -> None:
        """Take what has arrived and ask for what is missing up to an engine step.

        Args:
            engine_step: Of the moment of the first episode that is on show.
            alone: Where the first one has ended: time since the last call, in which this one goes
                on by itself; its pace is real time [s].

        Raises:
            KinetixError: The simulation failed.
        """
        self._goes_on = False
        if self.level is None or self.failure:
            return
        try:
            arrived = self.simulator.take()
        except KinetixError as error:
            self.failure = str(error)
            raise
        self.snapshots += arrived
        self._starting = self._starting and not self.snapshots
        if not self.snapshots:
            return
        self._go_on(engine_step, alone)
        engine_step += int(self._beyond)
        if self._mirror is not None:
            self._do_the_same(self._mirror())
            return
        if self.snapshots[-1].outcome is not None:
            return
        have = self.snapshots[-1].step + self.simulator.outstanding
        missing = engine_step // self.frame_skip + _AHEAD - have
        if missing > 0 and self.simulator.outstanding < _AT_ONCE:
            self.simulator.advance((None,) * min(missing, _AT_ONCE))

    def _go_on(self, engine_step: int, seconds: float | None) -> None:
        """Let the time pass that it has for itself; where the actions are the first one's, none."""
        if seconds is None or self._mirror is not None:
            self._beyond = 0.0
            return
        shown = self.shown(engine_step)
        self._goes_on = shown is not None and shown.outcome is None
        if self._goes_on:
            # It waits for its simulation, as the first one does.
            most = self.snapshots[-1].step * self.frame_skip + self.frame_skip - engine_step
            self._beyond = min(self._beyond + seconds * ENGINE_STEPS_PER_SECOND, max(most, 0.0))

    def _do_the_same(self, actions: Sequence[Action]) -> None:
        """Request the first episode's steps; rewind if its actions have diverged."""
        if self.simulator.outstanding:
            return
        common = min(len(actions), len(self._used))
        agreed = next((k for k in range(common) if actions[k] != self._used[k]), common)
        if agreed < common:
            # An episode that has ended here may have fewer moments than were asked for.
            agreed = min(agreed, len(self.snapshots) - 1)
            del self.snapshots[agreed + 1 :]
            del self._used[agreed:]
            self.simulator.restore(self.snapshots[-1])
        if self.snapshots[-1].outcome is not None:
            return
        more = tuple(actions[len(self._used) : len(self._used) + _AT_ONCE])
        if more:
            self._used += more
            self.simulator.advance(more)

    @property
    def frame_skip(self) -> int:
        """Engine steps in one of its environment steps."""
        return self.snapshots[0].frame_skip if self.snapshots else FRAME_SKIP

    def shown(self, engine_step: int) -> Snapshot | None:
        """Return the moment that belongs to an engine step; the last one where it has ended before.

        Where it goes on by itself after the first one's end, that is added.
        """
        if not self.snapshots:
            return None
        index = (engine_step + int(self._beyond)) // self.frame_skip
        return self.snapshots[min(index, len(self.snapshots) - 1)]
