"""Motion between two steps: the screen shows more moments a second than the simulation has steps.

What is shown runs at an even pace, less than one step behind the newest one, whenever the steps
themselves arrive. Paused, ended and stepped-to moments are shown as they are.
"""

import dataclasses
import math
from typing import Final

import numpy as np

from editor.play.mode import Mode
from editor.play.playback import Playback
from editor.worker.snapshots import Snapshot

_MOST_BEHIND: Final = 1.5
"""Steps; what is shown jumps ahead rather than fall further behind."""


@dataclasses.dataclass(frozen=True, kw_only=True)
class Moment:
    """Poses of the bodies between two steps; rows in the order of `level.bodies`."""

    position: np.ndarray
    angle: np.ndarray
    velocity: np.ndarray
    angular_velocity: np.ndarray


def between(a: Snapshot, b: Snapshot, share: float) -> Moment:
    """Return the moment that lies between two snapshots.

    Args:
        a: The earlier one.
        b: The later one.
        share: 0 is `a`, 1 is `b`.
    """
    turn = np.remainder(b.angle - a.angle + math.pi, math.tau) - math.pi
    return Moment(
        position=a.position + share * (b.position - a.position),
        angle=a.angle + share * turn,
        velocity=a.velocity + share * (b.velocity - a.velocity),
        angular_velocity=a.angular_velocity + share * (b.angular_velocity - a.angular_velocity),
    )


class Motion:
    """The clock of what is shown, in environment steps."""

    def __init__(self) -> None:
        self.moment: Moment | None = None
        """Poses shown instead of the snapshot's; None: the snapshot itself."""
        self._at = 0.0
        self._episode = -1

    def advance(self, playback: Playback, elapsed: float) -> None:
        """Let time pass.

        Args:
            playback: What is played.
            elapsed: Time since the last call [s].
        """
        newest, self.moment = playback.snapshot, None
        if newest is None:
            return
        if playback.mode is Mode.REPLAY:
            self._in_replay(playback)
            return
        moves = playback.mode in (Mode.PLAYING, Mode.ENDED)
        if playback.episode != self._episode or not moves or self._at > newest.step:
            self._episode, self._at = playback.episode, float(newest.step)
            return
        passed = elapsed / playback.step_seconds
        least = newest.step - max(_MOST_BEHIND, 1.0 + passed)
        self._at = max(min(self._at + passed, float(newest.step)), least)
        self._show(playback.ring.newest(math.ceil(newest.step - self._at) + 1))

    def _show(self, states: tuple[Snapshot, ...]) -> None:
        """Show the moment between the snapshots before and after it, if both are kept."""
        if len(states) > 1 and states[1].step == states[0].step + 1 > self._at:
            self.moment = between(states[0], states[1], self._at - states[0].step)

    def _in_replay(self, playback: Playback) -> None:
        index, moments = playback.replay_index, playback.moments
        if playback.running and index + 1 < len(moments):
            share = min(playback.step_share, 1.0)
            self.moment = between(moments[index], moments[index + 1], share)
