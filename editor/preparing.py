"""Compiling ahead on the worker what Play will need, so that the first step comes at once."""

import time
from collections.abc import Callable, Hashable
from typing import Final

from editor.jobs import Job
from editor.requests import Rehearse, WarmUp
from editor.session import Session
from kinetix.level.sizes import AUTOMATIC, capacity_of, describe_capacity

SETTLED_SECONDS: Final = 2.0
"""A need must last this long: who draws one shape after the other wants nothing compiled yet."""


class Preparation:
    """Knows what was asked for: every size and physics once in a run, and so for the agent."""

    def __init__(self, session: Session, done: Callable[[Job], None]) -> None:
        """Ask for nothing yet.

        Args:
            session: Whose level and physics are prepared for.
            done: Called with every finished job.
        """
        self._session = session
        self._done = done
        self._begun = False
        self._asked: set[Hashable] = set()
        self._need: Hashable = None
        self._since = 0.0

    def begin(self) -> None:
        """Prepare the size of the level in front first, then the other named ones."""
        self._begun = True
        own, physics = self._own()
        for size in sorted({own, *AUTOMATIC}, key=lambda size: (size != own, size)):
            self._ask(size, physics)

    def tick(self) -> None:
        """Prepare what the level in front needs by now, as soon as the worker has nothing to do."""
        session = self._session
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
