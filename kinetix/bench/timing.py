"""The one rule by which all benchmarks time a loop."""

import statistics
import time
from collections.abc import Callable
from typing import Any, Final

import jax

RUNS: Final = 5
"""Timed runs a figure; the median counts."""


def seconds_of(run: Callable[[int], Any], steps: int) -> float:
    """Time so many steps of a loop, until their result is there [s]."""
    start = time.perf_counter()
    jax.block_until_ready(run(steps))
    return time.perf_counter() - start


def steps_per_second(run: Callable[[int], Any], *, about: float, first: int = 16) -> float:
    """Return the rate of a loop that was compiled: the median of some runs.

    Args:
        run: Takes so many steps.
        about: How long a run is made [s], so that the clock and the first dispatch do not matter.
        first: Steps of the first run, which finds out how many that is.
    """
    steps = first
    while (taken := seconds_of(run, steps)) < about / 2:
        steps = max(2 * steps, int(steps * about / taken))
    return steps / statistics.median(seconds_of(run, steps) for _ in range(RUNS))
