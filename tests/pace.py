"""Measures how slow the machine is now, so that limits of time in tests can follow it."""

import time
from collections.abc import Callable

USUAL = 0.008
"""Of `_work`, on the machine on which the limits were set [s]."""


def slowness() -> float:
    """Return how often the usual time ordinary Python takes here: 1 or more."""
    return max(1.0, min(processor_time(_work) for _ in range(5)) / USUAL)


def processor_time(work: Callable[[], object]) -> float:
    """Return how much processor time `work` takes [s]."""
    start = time.process_time()
    work()
    return time.process_time() - start


def share_of(
    limit: float,
    work: Callable[[], object],
    *,
    seconds: Callable[[Callable[[], object]], float] = processor_time,
    tries: int = 30,
) -> float:
    """Return what share of a limit of time [s] `work` takes: 1 or less if it keeps it.

    Another process can slow a machine for a moment, so the machine's pace is taken beside each
    try, and the first try that keeps the limit is enough.
    """
    least = float("inf")
    for _ in range(tries):
        least = min(least, seconds(work) / (limit * slowness()))
        if least <= 1:
            break
    return least


def _work() -> None:
    sums: dict[tuple[int, str], float] = {}
    for k in range(20_000):
        key = (k % 97, str(k % 31))
        sums[key] = sums.get(key, 0) + 0.5 * k
