"""Curves of training runs: smoothed, and several of them as a band. Plain numpy."""

import dataclasses
from collections.abc import Sequence
from pathlib import Path

import numpy as np
from jaxtyping import Float

from editor.agents.run_watch import RunWatch

STEPS = "timing/num_env_steps"
"""Horizontal axis of the metrics."""
_GRID = 200
"""Places at which a band is worked out."""


@dataclasses.dataclass(frozen=True, kw_only=True)
class Curve:
    """A metric of one run."""

    x: Float[np.ndarray, " k"]
    """Environment steps."""
    y: Float[np.ndarray, " k"]


@dataclasses.dataclass(frozen=True, kw_only=True)
class Band:
    """Several runs of the same thing."""

    x: Float[np.ndarray, " g"]
    low: Float[np.ndarray, " g"]
    mean: Float[np.ndarray, " g"]
    high: Float[np.ndarray, " g"]


def run_names(paths: Sequence[str]) -> list[str]:
    """Return what to call runs: the ends of their paths, as long as they need to differ.

    Args:
        paths: Of the runs.
    """
    parts = [Path(path).parts for path in paths]
    for count in range(1, max(map(len, parts), default=0) + 1):
        names = ["/".join(each[-count:]) for each in parts]
        if len(set(names)) == len(set(paths)):
            return names
    return list(paths)


def curve_of(run: RunWatch, metric: str, smoothing: float) -> Curve:
    """Return a metric of a run.

    Args:
        run: The run.
        metric: Its name.
        smoothing: See `smoothed`.
    """
    known = [row for row in run.rows if metric in row]
    x = np.array([row.get(STEPS, k) for k, row in enumerate(known)], np.float64)
    y = np.array([row[metric] for row in known], np.float64)
    return Curve(x=x, y=smoothed(y, smoothing))


def smoothed(values: Float[np.ndarray, " k"], weight: float) -> Float[np.ndarray, " k"]:
    """Return the running mean in which each value counts `weight` times the one after it.

    NaN stays where it is and counts for nothing. At the start there is no bias: the first value is
    itself.

    Args:
        values: In their order.
        weight: 0 leaves them as they are; below 1.
    """
    if weight <= 0.0:
        return values
    out = np.full(len(values), np.nan)
    total = count = 0.0
    for k, value in enumerate(values.tolist()):
        if np.isfinite(value):
            total, count = total * weight + value, count * weight + 1.0
            out[k] = total / count
    return out


def band_of(curves: Sequence[Curve]) -> Band | None:
    """Return mean and range of several curves where all of them have values; None where none do."""
    kept = []
    for curve in curves:
        finite = np.isfinite(curve.y)
        if finite.sum() >= 2:
            kept.append((curve.x[finite], curve.y[finite]))
    if len(kept) < 2:
        return None
    first = max(x[0] for x, _ in kept)
    last = min(x[-1] for x, _ in kept)
    if last <= first:
        return None
    grid = np.linspace(first, last, _GRID)
    rows = np.stack([np.interp(grid, x, y) for x, y in kept])
    return Band(x=grid, low=rows.min(axis=0), mean=rows.mean(axis=0), high=rows.max(axis=0))
