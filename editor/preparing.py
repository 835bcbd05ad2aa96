"""Compiling ahead what Play will need, so that the first step comes at once and costs little."""

import time
from collections.abc import Callable, Hashable
from typing import Final

from editor.jobs import Job, JobState
from editor.outline import outline
from editor.requests import Rehearse, Tailor, WarmUp
from editor.session import Session
from kinetix.level.model import Level
from kinetix.level.sizes import AUTOMATIC, capacity_of, describe_capacity

SETTLED_SECONDS: Final = 2.0
"""A need must last this long: who draws one shape after the other wants nothing compiled yet."""
TAILORED_SECONDS: Final = 4.0
"""The same for the step of one level, which is a comfort and can wait."""


class Preparation:
    """Knows what was asked for: every size and physics once in a run, and so for the agent.

    When all that is done and the level still has the same parts, the step for this level alone is
    compiled too. The second worker does it: Play is never behind it in a queue, and begins with the
    size's step where the level's is not ready.
    """

    def __init__(self, session: Session, done: Callable[[Job], None]) -> None:
        """Ask for nothing yet.

        Args:
            session: Whose level and physics are prepared for.
            done: Called with every finished job that compiles a size.
        """
        self._session = session
        self._done = done
        self._begun = False
        self._asked: set[Hashable] = set()
        self._need: Hashable = None
        self._since = 0.0
        self._looked_at: Level | None = None
        self._outline: Hashable = None
        self._outlined = 0.0
        self._tailored: Hashable = None
        """The last need for which a level's own step was asked."""
        self._tailoring: Job | None = None
        self.tailors = True
        """Whether levels get steps of their own; a recorded session plays like its replay."""

    def begin(self) -> None:
        """Prepare the size of the level in front first, then the other named ones."""
        self._begun = True
        own, physics = self._own()
        for size in sorted({own, *AUTOMATIC}, key=lambda size: (size != own, size)):
            self._ask(size, physics)

    def tick(self) -> None:
        """Prepare what the level in front needs by now, as soon as the worker has nothing to do."""
        session = self._session
        self._look(session.document.level)
        self._give_way()
        if not session.editing:
            self._outlined = time.monotonic()  # who has just played may play again at once
        if not (self._begun and session.editing and session.worker.idle):
            return
        own, casting = self._own(), session.viewer.casting("a")
        agent = None if casting is None else (*own, casting.agent, casting.deterministic)
        if (own, agent) != self._need:
            self._need, self._since = (own, agent), time.monotonic()
        if time.monotonic() - self._since < SETTLED_SECONDS:
            return
        if own not in self._asked:
            self._ask(*own)
        elif casting is not None and agent not in self._asked and session.document.level.bodies:
            self._asked.add(agent)
            # Whatever is wrong with it is said when it is played.
            session.worker.submit(
                Rehearse(level=session.document.level, physics=own[1], casting=casting),
                title="Preparing the agent",
            )
        else:
            self._tailor()

    def _own(self) -> tuple[str, str]:
        session = self._session
        return describe_capacity(capacity_of(session.document.level)), session.playback.physics

    def _ask(self, size: str, physics: str) -> None:
        self._asked.add((size, physics))
        under = "" if physics == self._session.settings.physics else f" under {physics}"
        self._session.worker.submit(
            WarmUp(sizes=(size,), physics=physics),
            title=f"Preparing Play (size {size}{under})",
            done=self._done,
        )

    def _look(self, level: Level) -> None:
        """Note since when the level in front has had the parts that it has."""
        if level is self._looked_at:
            return
        self._looked_at, found = level, outline(level)
        if found != self._outline:
            self._outline, self._outlined = found, time.monotonic()

    def _wanted(self) -> Hashable:
        """What the level's own step depends on."""
        return self._outline, self._session.playback.physics

    def _tailor(self) -> None:
        """Ask for the step of the level in front, where nothing else goes on."""
        session = self._session
        level, need = session.document.level, self._wanted()
        busy = session.driver.active or session.gallery.open or not session.evaluator.idle
        if busy or not self.tailors or not level.bodies or need == self._tailored:
            return
        if time.monotonic() - self._outlined < TAILORED_SECONDS:
            return
        self._tailored = need
        # A level that is no good is told about when it is played.
        self._tailoring = session.evaluator.submit(
            Tailor(level=level, physics=session.playback.physics), title="Compiling for this level"
        )

    def _give_way(self) -> None:
        """Call the level's own step off where anything else is to be done or another is wanted."""
        session, job = self._session, self._tailoring
        if job is None:
            return
        if job.finished:
            if job.state is JobState.CANCELLED:
                self._tailored = None
            self._tailoring = None
        elif (
            not session.editing
            or len(session.evaluator.jobs) > 1
            or self._wanted() != self._tailored
        ):
            job.cancel()
