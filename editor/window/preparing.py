"""Compiling ahead what Play will need, so that the first step comes at once and costs little."""

import dataclasses
import time
from collections.abc import Callable, Hashable, Iterator
from typing import Final

from editor.documents.document import Document
from editor.session import Session
from editor.worker.jobs import Job, JobState
from editor.worker.requests import GetReady, KeepPrograms, Rehearse, Request, Tailor, WarmUp
from editor.worker.step_key import outline
from kinetix.level.model import Level
from kinetix.level.sizes import AUTOMATIC, capacity_of, describe_capacity

SETTLED_SECONDS: Final = 2.0
"""A need must last this long: who draws one shape after the other wants nothing compiled yet."""
TAILORED_SECONDS: Final = 4.0
"""The same for the step of one level, which is a comfort and can wait."""
UNTOUCHED_SECONDS: Final = 2.0
"""Writing to disk stops the window for a moment: nobody must be doing anything."""


@dataclasses.dataclass(frozen=True, kw_only=True)
class _Task:
    """One thing to have ready."""

    key: Hashable
    """It is asked for once."""
    request: Request
    title: str
    goes_on: bool = False
    """True if it may begin and go on while something is played."""


class Preparation:
    """Asks for one thing at a time, the most urgent one first.

    First of all a step in which the level in front can be played at once, compiled quickly; then
    the better one of its size, which the next episode begins with; the agent's; the other sizes;
    and when the level still has the same parts, the step for this level alone. What is under way
    is called off as soon as something more urgent comes, or somebody plays.
    """

    def __init__(self, session: Session, done: Callable[[Job], None]) -> None:
        """Ask for nothing yet.

        Args:
            session: Whose level and physics are prepared for.
            done: Called with every finished job that gets a size ready.
        """
        self._session = session
        self._done = done
        self._begun = False
        self._asked: set[Hashable] = set()
        self._front: tuple[Document | None, str] = (None, "")
        """The document that was in front last, and its physics."""
        self._need: Hashable = None
        self._since = 0.0
        self._looked_at: Level | None = None
        self._outline: Hashable = None
        self._outlined = 0.0
        self._task: _Task | None = None
        self._job: Job | None = None
        self._unkept = 0
        """Jobs that have finished since the last time that programs were written to disk."""
        self.tailors = True
        """True if levels get steps of their own; a recorded session plays like its replay."""

    def begin(self) -> None:
        """Start as soon as `tick` is called: the window stands."""
        self._begun = True
        # What is there at the start has lasted long enough.
        self._need, self._since = self._own(), time.monotonic() - SETTLED_SECONDS

    def tick(self) -> None:
        """Ask for what is most urgent by now; call off what is not wanted any more."""
        session = self._session
        self._look(session.document.level)
        if not session.editing:
            self._outlined = time.monotonic()  # who has just played may play again at once
        if self._own() != self._need:
            self._need, self._since = self._own(), time.monotonic()
        self._take()
        task = next(self._tasks(), None) if self._begun else None
        if self._job is not None and self._task is not None:
            first = task is not None and isinstance(task.request, GetReady)
            same = task is not None and task.key == self._task.key
            if not same and (first or not self._task.goes_on):
                self._job.cancel()
        elif task is not None and (task.goes_on or self._quiet):
            self._ask(task)

    def _take(self) -> None:
        """Let go of a job that has finished; one that was called off may be asked for again."""
        task, job = self._task, self._job
        if task is None or job is None or not job.finished:
            return
        self._task = self._job = None
        if job.state is JobState.CANCELLED:
            self._asked.discard(task.key)
        elif not isinstance(task.request, KeepPrograms):
            self._unkept += 1

    def _ask(self, task: _Task) -> None:
        session = self._session
        self._asked.add(task.key)
        if isinstance(task.request, KeepPrograms):
            self._asked.discard(task.key)
            self._unkept = 0
        sized = isinstance(task.request, GetReady | WarmUp)
        self._task = task
        self._job = session.worker.submit(
            task.request, title=task.title, done=self._done if sized else None
        )

    def _tasks(self) -> Iterator[_Task]:
        """Return the tasks that remain, the most urgent first; running ones included."""
        running = self._task.key if self._task is not None else None
        for task in self._candidates():
            if task.key == running or task.key not in self._asked:
                yield task

    def _candidates(self) -> Iterator[_Task]:
        session = self._session
        if session.playback.waiting or session.viewer.rival.preparing:
            return
        level, (size, physics) = session.document.level, self._own()
        settled = time.monotonic() - self._since >= SETTLED_SECONDS
        if session.quick and session.editing and level.bodies:
            yield self._first(level, physics)
        if settled:
            under = "" if physics == session.settings.physics else f" under {physics}"
            title = f"Preparing Play (size {size}{under})"
            yield _sized(size, physics, title, goes_on=True)
        if session.editing and session.evaluator.idle:
            yield from self._comforts(level, size, physics, settled=settled)

    @property
    def _quiet(self) -> bool:
        """True if nothing else is to be done."""
        session = self._session
        return not (session.driver.active or session.gallery.open or session.worker.jobs)

    def _first(self, level: Level, physics: str) -> _Task:
        """A step that the level in front can be played in, asked for when it comes to the front."""
        front = self._session.document, physics
        key = "first", id(front[0]), physics
        if front != self._front:
            self._front = front
            self._asked.discard(key)
        request = GetReady(level=level, physics=physics)
        return _Task(key=key, request=request, title="Preparing Play", goes_on=True)

    def _comforts(self, level: Level, size: str, physics: str, *, settled: bool) -> Iterator[_Task]:
        """Return the tasks for an idle worker."""
        session = self._session
        if self._unkept and time.monotonic() - session.hands.touched >= UNTOUCHED_SECONDS:
            yield _Task(key="keep", request=KeepPrograms(), title="Keeping what was compiled")
        casting = session.viewer.casting("a")
        if casting is not None and level.bodies and settled:
            key = size, physics, casting.agent, casting.deterministic
            request = Rehearse(level=level, physics=physics, casting=casting)
            # Errors are reported when it is played.
            yield _Task(key=key, request=request, title="Preparing the agent")
        if settled:
            for other in AUTOMATIC:
                usual = session.settings.physics
                yield _sized(other, usual, f"Preparing Play (size {other})", goes_on=False)
        lasted = time.monotonic() - self._outlined >= TAILORED_SECONDS
        if self.tailors and level.bodies and lasted:
            yield _Task(
                key=("tailored", self._outline, physics),
                request=Tailor(level=level, physics=physics),
                title="Compiling for this level",
            )

    def _own(self) -> tuple[str, str]:
        session = self._session
        return describe_capacity(capacity_of(session.document.level)), session.playback.physics

    def _look(self, level: Level) -> None:
        """Note since when the level in front has had the parts that it has."""
        if level is self._looked_at:
            return
        self._looked_at, found = level, outline(level)
        if found != self._outline:
            self._outline, self._outlined = found, time.monotonic()


def _sized(size: str, physics: str, title: str, *, goes_on: bool) -> _Task:
    """Return the step that all levels of a size share."""
    request = WarmUp(sizes=(size,), physics=physics)
    return _Task(key=(size, physics), request=request, title=title, goes_on=goes_on)
