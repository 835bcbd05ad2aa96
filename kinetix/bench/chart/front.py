"""Pareto fronts: which points are dominated, and how far ours is ahead."""

from collections.abc import Sequence
from typing import Any, Final

from kinetix.bench.chart.points import OURS, Point

LEAST_ERROR: Final = 1e-6
"""Errors below this count as this, as in the class error."""
BASELINE: Final = "jax2d"
"""The engine, at its defaults, that the scalars compare with."""


def dominates(first: Point, second: Point) -> bool:
    """Return whether one is at least as fast and as accurate, and better in one of the two."""
    at_least = first.speed >= second.speed and first.error <= second.error
    return at_least and (first.speed, first.error) != (second.speed, second.error)


def pareto_front(points: Sequence[Point]) -> list[Point]:
    """Return those that no other dominates, the fastest first."""
    kept = [p for p in points if not any(dominates(other, p) for other in points)]
    return sorted(kept, key=lambda point: -point.speed)


def scalars(points: Sequence[Point]) -> dict[str, Any]:
    """Return how far ours is ahead of the baseline in one facet, without interpolation.

    Returns:
        `speed_ratio`: our fastest point that is no less accurate than the baseline, over its speed;
        `error_ratio`: its error over that of our most accurate point that is no slower. None where
        there is no such point, or no baseline. `ahead_of_us`: the names of foreign points on the
        common front.
    """
    ours = [point for point in points if point.family == OURS]
    base = next((p for p in points if p.name == BASELINE and p.family != OURS), None)
    ahead = [point.name for point in pareto_front(points) if point.family != OURS]
    if base is None:
        return {"speed_ratio": None, "error_ratio": None, "ahead_of_us": ahead}
    speeds = [point.speed for point in ours if point.error <= base.error]
    errors = [max(point.error, LEAST_ERROR) for point in ours if point.speed >= base.speed]
    return {
        "speed_ratio": max(speeds) / base.speed if speeds else None,
        "error_ratio": max(base.error, LEAST_ERROR) / min(errors) if errors else None,
        "ahead_of_us": ahead,
    }
