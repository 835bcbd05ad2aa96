"""Ctrl+C, SIGTERM and a closed terminal end a training after an update, with everything saved."""

import contextlib
import signal
from collections.abc import Callable, Iterator
from types import FrameType

import jax
import numpy as np
from jax.experimental import multihost_utils

from kinetix.failures import Terminated, ending_signals, signals_to


class StopRequest:
    """Return whether the process was asked to end, and by which signal."""

    def __init__(self, say: Callable[[str], None]) -> None:
        """Begin without a request.

        Args:
            say: Takes a sentence for the terminal.
        """
        self._say = say
        self.signal: int | None = None

    def __call__(self, number: int, frame: FrameType | None) -> None:
        """Note a signal; one more Ctrl+C ends the process at once.

        Other signals come twice without anybody's will: the editor sends one as it closes, and
        so does the system as the editor is gone.
        """
        if self.signal is None:
            self.signal = number
            self._say("stopping after this update; Ctrl+C once more stops at once, without saving")
        elif number == signal.SIGINT:
            self._say("stopped at once; the same command goes on from the last checkpoint, if any")
            raise self.error()

    def error(self) -> BaseException:
        """Return what ends the command with the status that the signal asks for."""
        return KeyboardInterrupt() if self.signal == signal.SIGINT else Terminated()

    def alone(self) -> bool:
        """Return whether this process, which trains without others, was asked."""
        return self.signal is not None and jax.process_count() == 1

    @property
    def agreed(self) -> bool:
        """True if any of the processes that train together was asked; all must call this."""
        own = self.signal is not None
        if jax.process_count() == 1:
            return own
        return bool(np.any(multihost_utils.process_allgather(np.asarray(own))))


@contextlib.contextmanager
def stop_requests(say: Callable[[str], None]) -> Iterator[StopRequest]:
    """Listen to Ctrl+C, SIGTERM and hang-ups; outside the main thread to none of them.

    Args:
        say: Takes a sentence for the terminal.
    """
    request = StopRequest(say)
    with signals_to(request, signal.SIGINT, *ending_signals()):
        yield request
