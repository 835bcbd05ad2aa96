"""Downloads, each in a thread of its own; the window takes finished ones."""

import queue
import threading
from collections.abc import Callable
from typing import Any

from kinetix.errors import KinetixError

Fetch = Callable[[], Any]
Take = Callable[[Any], None]
"""Gets what was fetched, or the error that says why it was not."""


class Fetches:
    """Begins fetches and hands over what has come; needs no simulation."""

    def __init__(self) -> None:
        self._come: queue.SimpleQueue[tuple[Take, Any]] = queue.SimpleQueue()
        self.waiting = 0
        """Fetches that are under way."""

    def begin(self, fetch: Fetch, take: Take) -> None:
        """Fetch in the background.

        Args:
            fetch: Runs in a thread; may raise `KinetixError`.
            take: Called by `poll` with the result or that error.
        """

        def work() -> None:
            try:
                told = fetch()
            except KinetixError as error:
                told = error
            except Exception as error:  # whatever a server leads the library to
                told = KinetixError(str(error) or type(error).__name__)
            self._come.put((take, told))

        self.waiting += 1
        threading.Thread(target=work, name="fetch", daemon=True).start()

    def poll(self) -> None:
        """Hand over what has come since the last call."""
        while not self._come.empty():
            take, told = self._come.get()
            self.waiting -= 1
            take(told)
