"""Compiling ahead on the worker what Play will need, so that the first step comes at once."""

import time
from collections.abc import Callable
from typing import Final

from editor.jobs import Job
from editor.requests import WarmUp
from editor.session import Session
from kinetix.level.sizes import AUTOMATIC, capacity_of, describe_capacity

SETTLED_SECONDS: Final = 2.0
"""A need must last this long: who draws one shape after the other wants nothing compiled yet."""


class Preparation:
    """Knows what was asked for: every size and physics once in a run."""

    def __init__(self, session: Session, done: Callable[[Job], None]) -> None:
        """Ask for nothing yet.

        Args:
            session: Whose level and physics are prepared for.
            done: Called with every finished job.
        """
        self._session = session
        self._done = done
        self._begun = False
        self._asked: set[tuple[str, str]] = set()
        self._need: tuple[str, str] = ("", "")
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
        need = self._own()
        if need != self._need:
            self._need, self._since = need, time.monotonic()
        if need not in self._asked and time.monotonic() - self._since >= SETTLED_SECONDS:
            self._ask(*need)

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
