"""Duration of a training: parts of updates and evaluations timed apart, compilation left out."""

import collections
import statistics
from collections.abc import Iterable, Mapping
from typing import Final

from kinetix.training.work import Part

_RECENT: Final = 32
"""The pace is that of so many last parts of a name."""


class Pace:
    """Durations of one process's work.

    What compiles does not count: the first part of each name and any other that compiles, and the
    first batch of episodes of the first evaluation.
    """

    def __init__(
        self,
        *,
        updates: int,
        eval_freq: int,
        per_update: Mapping[str, float],
        evaluation_share: float = 0.0,
    ) -> None:
        """Count nothing yet.

        Args:
            updates: How many updates the training has.
            eval_freq: Updates between two evaluations; 0: none.
            per_update: How often a part of each name occurs in an update, on average.
            evaluation_share: An evaluation's environment steps per step of an update: its
                duration until one has been timed.
        """
        self._updates = updates
        self._eval_freq = eval_freq
        self._per_update = per_update
        self._share = evaluation_share
        self._parts: dict[str, collections.deque[float]] = {}
        self._evaluations: list[float] = []

    def worked(self, parts: Iterable[Part]) -> None:
        """Take the parts of an update."""
        for part in parts:
            if not part.compiled:
                recent = self._parts.setdefault(part.name, collections.deque(maxlen=_RECENT))
                recent.append(part.seconds)

    def evaluated(self, seconds: float) -> None:
        """Take the duration of an evaluation that had nothing to compile [s]."""
        self._evaluations = [*self._evaluations[1 - _RECENT :], seconds]

    def seconds_left(self, done: int) -> float | None:
        """Return how long the rest takes [s]; None while only compilation has been seen.

        Args:
            done: Updates that are done.
        """
        if not self._parts:
            return None
        update = self._seconds_per_update()
        left = (self._updates - done) * update
        if self._eval_freq:
            evaluations = -(-self._updates // self._eval_freq) - done // self._eval_freq
            each = self._share * update
            if self._evaluations:
                each = statistics.fmean(self._evaluations)
            left += evaluations * each
        return left

    def _seconds_per_update(self) -> float:
        """The parts of an average update; one that has not been timed lasts as long as others."""
        # A median leaves out the parts that something else on the machine delayed.
        typical = {name: statistics.median(recent) for name, recent in self._parts.items()}
        other = statistics.fmean(typical.values())
        return sum(often * typical.get(name, other) for name, often in self._per_update.items())
