"""Reasons for agent A's action at the moment on the screen."""

import functools
from typing import Any, Final

from editor.worker.jobs import Job, JobState, Worker
from editor.worker.requests import About, AgentRef, Explain, Explained
from kinetix.level.model import Level

OVERLAYS: Final = ("attention", "saliency", "places")
"""Names in the settings of what is drawn over the level."""


class Reasons:
    """Asks the worker about one moment at a time; what is shown may be a moment old."""

    def __init__(self, worker: Worker) -> None:
        self._worker = worker
        self.told: Explained | None = None
        self.level: Level | None = None
        """The level that `told` is about."""
        self.error = ""
        self.about: About = "value"
        self.pending = False
        self._of: tuple[Any, ...] = ()

    def ask(
        self,
        level: Level,
        moment: Any,
        agent: AgentRef,
        physics: str,
        body: int | None,
    ) -> None:
        """Ask, unless that is known or on its way.

        Args:
            level: The level.
            moment: A snapshot with a state, or None for the level's start.
            agent: Whose network.
            physics: Under which it plays.
            body: Id of the body whose path is explained; None: none.
        """
        asked = (id(level), id(moment), agent, physics, body, self.about)
        if self.pending or asked == self._of:
            return
        self._of, self.pending = asked, True
        request = Explain(
            level=level,
            state=None if moment is None else moment.state,
            memory=None if moment is None else moment.memory,
            agent=agent,
            physics=physics,
            about=self.about,
            body=body,
        )
        done = functools.partial(self._done, level, asked)
        self._worker.submit(request, title="Asking the agent", done=done)

    def forget(self) -> None:
        """Show nothing any more."""
        self.told, self.level, self.error, self._of = None, None, "", ()

    def _done(self, level: Level, asked: tuple[Any, ...], job: Job) -> None:
        self.pending = False
        if asked != self._of:
            return  # It was forgotten meanwhile.
        if job.state is JobState.DONE:
            self.told, self.level, self.error = job.result, level, ""
        elif job.state is JobState.FAILED:
            self.told, self.level, self.error = None, None, job.error
