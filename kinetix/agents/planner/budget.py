"""Rounds that a planner can afford in the time it is given."""

from typing import Final

from kinetix.agents.planner.policy import LENGTH

MOST: Final = 16
"""Rounds of one planning: more would change little."""
_WEIGHT: Final = 0.3
"""Of the newest time in the running mean."""


class Budget:
    """Turns milliseconds into rounds, by how long rounds took so far."""

    def __init__(self, *, milliseconds: float, first_milliseconds: float, horizon: int) -> None:
        """Set the budget.

        Args:
            milliseconds: Whenever it plans again.
            first_milliseconds: Before its first move.
            horizon: How far it looks ahead when it plans again [environment steps].
        """
        self._budget = milliseconds / 1e3
        self._first_budget = first_milliseconds / 1e3
        self._stretch = LENGTH / horizon
        self._round: float | None = None
        self._owed = 0.0

    @property
    def rounds(self) -> int:
        """Rounds that fit into the next planning; 0 while an earlier overrun is paid back."""
        return 0 if self._owed > 0 else self._fitting(self._budget)

    @property
    def first(self) -> int:
        """Rounds that fit before the first move, each to the end of a plan: at least one."""
        return self._fitting(self._first_budget / self._stretch)

    def _fitting(self, seconds: float) -> int:
        if self._round is None:
            return 1
        return max(1, min(MOST, int(seconds / self._round)))

    def note(self, seconds: float, *, rounds: int, first: bool) -> None:
        """Take note of how long planning took; plans that win end early, so this is no promise.

        Args:
            seconds: Duration.
            rounds: Rounds that it was allowed; without any, the time pays back what is owed.
            first: True before the first move, whose time is not owed.
        """
        if not first:
            self._owed = max(0.0, self._owed + seconds - self._budget)
        if rounds:
            each = seconds / rounds / (self._stretch if first else 1.0)
            before = each if self._round is None else self._round
            self._round = (1 - _WEIGHT) * before + _WEIGHT * each
