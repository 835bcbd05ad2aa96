"""Returns and solve rates over many episodes: one update's few swing with the time limit."""

import collections
import dataclasses
import math
from collections.abc import Mapping
from typing import Final

AVERAGED: Final = ("episode_return", "episode_length", "episode_solved")
"""Metrics of the episodes that ended in an update."""
COUNT: Final = "episodes"
"""Metric that counts them."""
PREFIX: Final = "average/"
"""Begins the names of the averages."""
FEWEST: Final = 100
"""An average is over at least so many episodes, once there are so many."""


@dataclasses.dataclass(frozen=True)
class _Update:
    episodes: float
    sums: tuple[float, ...]


class EpisodeAverages:
    """Averages over the last episodes, each episode with the same weight.

    They reach over so many updates that every environment has ended one episode on average: then
    episodes that time out together count as often as those that end early.
    """

    def __init__(self, environments: int) -> None:
        """Begin without episodes.

        Args:
            environments: How many environments play.
        """
        self._wanted = max(environments, FEWEST)
        self._updates: collections.deque[_Update] = collections.deque()
        self._episodes = 0.0

    def add(self, metrics: Mapping[str, float]) -> dict[str, float]:
        """Take an update and return the averages, under the names of the metrics with a prefix.

        Args:
            metrics: Of the update.
        """
        episodes = metrics.get(COUNT, 0.0)
        means = [metrics.get(name, math.nan) for name in AVERAGED]
        if episodes > 0 and all(map(math.isfinite, means)):
            self._updates.append(_Update(episodes, tuple(mean * episodes for mean in means)))
            self._episodes += episodes
        while self._episodes - (oldest := self._oldest()) >= self._wanted and oldest:
            self._updates.popleft()
            self._episodes -= oldest
        if not self._updates:
            return {}
        totals = map(math.fsum, zip(*(update.sums for update in self._updates), strict=True))
        return {
            f"{PREFIX}{name}": total / self._episodes
            for name, total in zip(AVERAGED, totals, strict=True)
        }

    def _oldest(self) -> float:
        return self._updates[0].episodes if self._updates else 0.0
