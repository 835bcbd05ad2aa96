"""Duration of a training: updates and evaluations timed apart, compilation left out."""

import collections
import statistics
from typing import Final

_RECENT: Final = 32
"""The pace is that of so many last updates."""


class Pace:
    """Durations of one process's updates and evaluations.

    The first of either compiles and does not count once there is a second; a median leaves out the
    updates that compile something later, such as a first replay.
    """

    def __init__(self, *, updates: int, eval_freq: int) -> None:
        """Count nothing yet.

        Args:
            updates: How many updates the training has.
            eval_freq: Updates between two evaluations; 0: none.
        """
        self._updates_in_all = updates
        self._eval_freq = eval_freq
        self._updates: collections.deque[float] = collections.deque(maxlen=_RECENT)
        self._evaluations: list[float] = []
        self._compiled = self._evaluated = False

    def updated(self, seconds: float) -> None:
        """Take the duration of an update [s]."""
        if len(self._updates) == 1 and not self._compiled:
            self._updates.clear()
            self._compiled = True
        self._updates.append(seconds)

    def evaluated(self, seconds: float) -> None:
        """Take the duration of an evaluation [s]."""
        self._evaluations = [*self._evaluations[-_RECENT:], seconds]
        if len(self._evaluations) == 2 and not self._evaluated:
            self._evaluated = True
            del self._evaluations[0]

    def seconds_left(self, done: int) -> float | None:
        """Return how long the rest takes [s]; None while only compilation has been seen.

        Args:
            done: Updates that are done.
        """
        if not self._compiled:
            return None
        rest = self._updates_in_all - done
        left = rest * statistics.median(self._updates)
        if self._eval_freq and self._evaluations:
            evaluations = -(-self._updates_in_all // self._eval_freq) - done // self._eval_freq
            left += evaluations * statistics.fmean(self._evaluations)
        return left
