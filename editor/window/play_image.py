"""The JAX renderer's picture of what is played, asked of the worker while the vectors are on show.

Play never waits for it: the drawing function of a size is compiled in Edit while the worker is
idle, a picture that comes late is dropped, and where the machine cannot keep up the vectors, which
show the same state, stay alone.
"""

import dataclasses
import functools
from typing import TYPE_CHECKING, Final

import numpy as np

from editor.play.mode import Mode
from editor.worker.jobs import Job, JobState
from editor.worker.requests import RenderState
from editor.worker.snapshots import Snapshot
from kinetix.engine.spec import Capacity
from kinetix.level.geometry import ARENA_WIDTH
from kinetix.level.model import Level
from kinetix.level.sizes import capacity_of

if TYPE_CHECKING:
    from editor.session import Session

SIDES: Final = (512, 768, 1024)
"""Sizes of the picture [px]: the arena on the screen takes the next larger one."""
_LATE_STEPS: Final = 3
"""A picture older than this is not shown: the vectors are ahead of it."""
_SLOW_FACTOR: Final = 0.9
"""Below this share of the wanted speed the pictures are given up for the episode."""
_TITLE: Final = "Drawing"

_Key = tuple[Capacity, int, str, bool, bool]


@dataclasses.dataclass(frozen=True, kw_only=True)
class Picture:
    """A picture of the arena at one moment of an episode."""

    pixels: np.ndarray
    """uint8[side, side, 3], top row first."""
    snapshot: Snapshot
    episode: int
    """Number of the episode, as `Playback` counts."""
    stamp: int


class PlayImage:
    """Asks for one picture at a time and keeps the last one."""

    def __init__(self) -> None:
        self.enabled = False
        """True if the worker may be asked; the window turns it on once Play is prepared."""
        self._ready: set[_Key] = set()
        self._pending = False
        self._picture: Picture | None = None
        self._stamp = 0
        self._given_up: Level | None = None

    def update(self, session: "Session", side_px: float) -> None:
        """Ask for what is missing; call it once a frame.

        Args:
            session: The app.
            side_px: Side of the arena on the screen [px].
        """
        if not self.enabled or self._pending:
            return
        side = next((side for side in SIDES if side >= side_px), None)
        if side is None:
            return
        playback = session.playback
        if session.editing:
            self._picture = None
            self._given_up = None
            level = session.document.level
            key = _key(session, level, side)
            if key not in self._ready and session.worker.idle:
                self._ask(session, _request(session, level, None, side), key, None)
            return
        level, snapshot = playback.level, playback.snapshot
        if level is None or snapshot is None or snapshot.state is None or level is self._given_up:
            return
        key = _key(session, level, side)
        fresh = self._picture is not None and self._picture.snapshot is snapshot
        if key not in self._ready or fresh:
            return
        slow = playback.real_time_factor < _SLOW_FACTOR * playback.speed
        if session.mode is Mode.PLAYING and playback.step_count > 45 and slow:
            self._given_up, self._picture = level, None
            return
        self._ask(session, _request(session, level, snapshot.state, side), key, snapshot)

    def picture(self, session: "Session") -> Picture | None:
        """The picture to show now, or None when there is none that is recent enough."""
        playback, picture = session.playback, self._picture
        if session.editing or picture is None:
            return None
        if picture.snapshot is playback.snapshot:
            return picture
        late = playback.step_count - picture.snapshot.step
        recent = picture.episode == playback.episode and 0 < late <= _LATE_STEPS
        return picture if recent else None

    def _ask(
        self, session: "Session", request: RenderState, key: _Key, snapshot: Snapshot | None
    ) -> None:
        self._pending = True
        session.worker.submit(
            request,
            title=_TITLE,
            urgent=not session.editing,
            done=functools.partial(self._done, key, snapshot, session.playback.episode),
        )

    def _done(self, key: _Key, snapshot: Snapshot | None, episode: int, job: Job) -> None:
        self._pending = False
        if job.state is JobState.FAILED:
            # The log has the reason; the vectors show the same.
            self.enabled = False
        elif job.state is JobState.DONE:
            self._ready.add(key)
            if snapshot is not None:
                self._stamp += 1
                pixels, stamp = job.result.pixels, self._stamp
                self._picture = Picture(
                    pixels=pixels, snapshot=snapshot, episode=episode, stamp=stamp
                )


def _key(session: "Session", level: Level, side: int) -> _Key:
    """Return the key for which a drawing function is compiled."""
    settings = session.settings
    return capacity_of(level), side, settings.palette, settings.glyphs, settings.patterns


def _request(session: "Session", level: Level, state: object, side: int) -> RenderState:
    settings = session.settings
    return RenderState(
        level=level,
        state=state,
        size=(side, side),
        centre=(ARENA_WIDTH / 2, ARENA_WIDTH / 2),
        scale=side / ARENA_WIDTH,
        physics=session.playback.played_under,
        palette=settings.palette,
        glyphs=settings.glyphs,
        patterns=settings.patterns,
    )
