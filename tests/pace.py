"""Measures how slow the machine is now, so that limits of time in tests can follow it."""

import time

USUAL = 0.008
"""Of `_work`, on the machine on which the limits were set [s]."""


def slowness() -> float:
    """Return how often the usual time ordinary Python takes here: 1 or more."""
    return max(1.0, min(_work() for _ in range(5)) / USUAL)


def _work() -> float:
    start = time.process_time()
    sums: dict[tuple[int, str], float] = {}
    for k in range(20_000):
        key = (k % 97, str(k % 31))
        sums[key] = sums.get(key, 0) + 0.5 * k
    return time.process_time() - start
