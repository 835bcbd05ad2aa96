"""A training run that is watched while it trains: its metrics, and when it has a newer agent."""

import functools
from collections.abc import Callable
from typing import Final

from editor.agents.metrics import Metrics
from editor.worker.jobs import Job, JobState, Worker
from editor.worker.requests import Place, ReadRun, RunNews

POLL_SECONDS: Final = 2.0
"""Interval at which the folder is read [s]."""


class RunWatch:
    """Looks at one run's folder now and then; never writes there."""

    def __init__(self, worker: Worker) -> None:
        self._worker = worker
        self.path = ""
        """The run's folder; empty: none is watched."""
        self.metrics = Metrics()
        """Metrics of the run; another object once they were read again."""
        self.newest: int | None = None
        """Environment steps of the newest checkpoint."""
        self.error = ""
        self._asked = -POLL_SECONDS
        self._pending = False
        self._place: Place | None = None
        self._watches = 0
        """Number of times that a run was pointed at: an answer to an earlier time is not taken."""

    def watch(self, path: str) -> None:
        """Watch a run; an empty path watches none."""
        self.path, self.error = path, ""
        self.metrics, self.newest = Metrics(), None
        self._place = None
        self._asked = -POLL_SECONDS
        self._watches += 1

    def tick(self, now: float, changed: Callable[[int], None]) -> None:
        """Look at the folder when it is time.

        Args:
            now: The session's clock [s].
            changed: Called with the steps of a newer checkpoint.
        """
        if not self.path or self._pending or now - self._asked < POLL_SECONDS:
            return
        self._asked, self._pending = now, True
        self._worker.submit(
            ReadRun(path=self.path, after=self._place),
            title="Reading the training run",
            done=functools.partial(self._done, self._watches, changed),
        )

    def _done(self, watch: int, changed: Callable[[int], None], job: Job) -> None:
        self._pending = False
        if watch != self._watches:
            return
        if job.state is JobState.FAILED:
            self.error = job.error
            return
        if job.state is not JobState.DONE:
            return
        news: RunNews = job.result
        self.error = ""
        if news.total == len(news.rows):
            self.metrics = Metrics()
        self.metrics.extend(news.rows)
        self._place = news.place
        if news.newest is not None and news.newest != self.newest:
            self.newest = news.newest
            changed(news.newest)
