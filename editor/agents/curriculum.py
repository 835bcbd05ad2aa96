"""The history of a run's level buffer as the window sees it: a page at a time, live."""

import functools
from typing import Final

import numpy as np
from jaxtyping import UInt8

from editor.gallery.thumbnail import draw_thumbnail
from editor.worker.jobs import Job, JobState, Worker
from editor.worker.requests import CurriculumNews, ReadCurriculum
from kinetix.training.curricula.pages import BufferPage, GoneLevel, ListedLevel

POLL_SECONDS: Final = 2.0
"""Interval at which the folder is read [s]."""
SIDE: Final = 112
"""Width and height of a picture [px]."""
_A_FRAME: Final = 2
"""Pictures that are drawn in a frame, some 3 ms each."""


class CurriculumWatch:
    """Follows the newest page of a run, or stays at one that was chosen."""

    def __init__(self, worker: Worker) -> None:
        self._worker = worker
        self.path = ""
        self.open = False
        """True if the panel is on the screen: only then anything is read."""
        self.updates: tuple[int, ...] = ()
        self.page: BufferPage | None = None
        self.thumbnails: list[UInt8[np.ndarray, "h w 3"]] = []
        """Of the page's levels, as far as they are drawn."""
        self.stamp = 0
        """Rises with every page."""
        self.wanted: int | None = None
        """The page to show; None: the newest."""
        self.error = ""
        self._asked = -POLL_SECONDS
        self._pending = False

    @property
    def drawing(self) -> bool:
        """True if pictures of the page are still missing."""
        return self.page is not None and len(self.thumbnails) < len(self.page.levels)

    def watch(self, path: str) -> None:
        """Look at another run; an empty path looks at none."""
        if path != self.path:
            self.path, self.error = path, ""
            self.updates, self.page, self.wanted = (), None, None
            self._asked = -POLL_SECONDS

    def choose(self, update: int | None) -> None:
        """Show the page of an update; None follows the newest."""
        self.wanted = update
        self._asked = -POLL_SECONDS

    def tick(self, now: float) -> None:
        """Read what is due.

        Args:
            now: The session's clock [s].
        """
        if self.open and self.drawing and self.page is not None:
            for level in self.page.levels[len(self.thumbnails) :][:_A_FRAME]:
                self.thumbnails.append(draw_thumbnail(level, SIDE))
        shown = None if self.page is None else self.page.head.update
        due = now - self._asked >= POLL_SECONDS
        if not self.path or not self.open or self._pending or not due:
            return
        self._asked, self._pending = now, True
        self._worker.submit(
            ReadCurriculum(path=self.path, update=self.wanted, known=shown),
            title="Reading the curriculum",
            done=functools.partial(self._done, self.path),
        )

    def _done(self, path: str, job: Job) -> None:
        self._pending = False
        if path != self.path:
            return
        if job.state is JobState.FAILED:
            self.error = job.error
        elif job.state is JobState.DONE:
            news: CurriculumNews = job.result
            self.error, self.updates = "", news.updates
            if news.page is not None:
                self.page, self.thumbnails = news.page, []
                self.stamp += 1
            shown = None if self.page is None else self.page.head.update
            if self.wanted is not None and self.wanted not in (*news.updates, shown):
                self.wanted = None  # thinned out before it could be shown


def lineage(level: ListedLevel) -> str:
    """Return where a level comes from: `edited from #12, from #3`; empty for drawn ones."""
    if not level.ancestry:
        return ""
    return "edited from " + ", from ".join(f"#{serial}" for serial in level.ancestry)


def why_gone(level: GoneLevel) -> str:
    """Return why a level left the buffer, as a sentence."""
    rate = level.solve_rate
    last = "" if rate is None else f" It was won {rate:.0%} of the time by then."
    if level.reason == "outscored":
        score = "" if level.score is None else f", its own was {level.score:.3f}"
        return (
            f"Update {level.update}: #{level.by} took its place with a better score{score}.{last}"
        )
    if rate is not None and rate > 0.9:
        return f"Update {level.update}: learnt; the buffer was refilled.{last}"
    if rate is not None and rate < 0.1:
        return f"Update {level.update}: too hard still; the buffer was refilled.{last}"
    return f"Update {level.update}: the buffer was refilled.{last}"
