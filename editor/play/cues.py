"""Audible events of an episode: hits, and its end; the hosts choose the sounds."""

import dataclasses
from typing import Final, Literal

import numpy as np

from editor.play.mode import Mode
from editor.play.playback import Playback
from editor.worker.snapshots import ENGINE_STEPS_PER_SECOND, Snapshot
from kinetix.level.model import Level

CueName = Literal["hit", "won", "lost", "timeout", "broken"]

QUIETEST: Final = 0.8
"""A sudden change of velocity below this is no hit [m/s]."""
LOUDEST: Final = 8.0
"""One above this is as loud as can be [m/s]."""
PAUSE: Final = 0.07
"""Between two hits [s]."""


@dataclasses.dataclass(frozen=True, kw_only=True)
class Cue:
    """Something that can be heard."""

    name: CueName
    loudness: float = 1.0
    """0 … 1."""


class Ears:
    """Listens to what is played; a replay is silent."""

    def __init__(self) -> None:
        self._heard: Snapshot | None = None
        self._episode = -1
        self._next_hit = 0.0

    def hear(self, playback: Playback, now: float) -> list[Cue]:
        """Return what could be heard since the last call.

        Args:
            playback: What is played.
            now: Time [s].
        """
        shown, level = playback.snapshot, playback.level
        before, self._heard = self._heard, shown
        if playback.episode != self._episode:
            self._episode, before = playback.episode, None
        plays = playback.mode in (Mode.PLAYING, Mode.ENDED)
        if not plays or shown is None or level is None or before is None or shown is before:
            return []
        cues: list[Cue] = []
        blow = hardest_blow(level, before, shown) if shown.step > before.step else 0.0
        if blow >= QUIETEST and now >= self._next_hit:
            self._next_hit = now + PAUSE
            cues.append(Cue(name="hit", loudness=min(blow / LOUDEST, 1.0)))
        if shown.outcome is not None and before.outcome is None:
            cues.append(Cue(name=shown.outcome))
        return cues


def hardest_blow(level: Level, before: Snapshot, after: Snapshot) -> float:
    """Return the largest change of a free body's velocity that gravity does not explain [m/s]."""
    free = np.array([not body.fixed for body in level.bodies], bool)
    if not free.any() or before.velocity.shape != after.velocity.shape:
        return 0.0
    seconds = (after.step - before.step) * after.frame_skip / ENGINE_STEPS_PER_SECOND
    gained = after.velocity - before.velocity - np.array(level.gravity) * seconds
    return float(np.linalg.norm(gained[free], axis=1).max())
