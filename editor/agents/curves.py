"""Curves of training runs: smoothed, and several of them as a band. Plain numpy."""

import dataclasses
from collections.abc import Sequence
from pathlib import Path
from weakref import WeakKeyDictionary

import numpy as np
from jaxtyping import Float

from editor.agents.metrics import Metrics

_GRID = 200
"""Places at which a band is worked out."""
_BLOCK = 128
"""Values that are smoothed at a time."""
_MOST = 1000
"""Parts of a thinned curve, each with its lowest and highest value: about a plot's pixels."""


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


class Curves:
    """Curves of runs, which are worked out again when a run has more rows."""

    def __init__(self) -> None:
        self._kept: WeakKeyDictionary[Metrics, dict[str, tuple[int, float, Curve, Curve]]]
        self._kept = WeakKeyDictionary()

    def of(self, metrics: Metrics, name: str, smoothing: float) -> tuple[Curve, Curve]:
        """Return a metric of a run whole, and thinned to be drawn.

        Args:
            metrics: Of the run.
            name: Of the metric.
            smoothing: See `smoothed`.
        """
        of_run = self._kept.setdefault(metrics, {})
        known = of_run.get(name)
        if known is None or known[:2] != (len(metrics), smoothing):
            curve = curve_of(metrics, name, smoothing)
            known = of_run[name] = (len(metrics), smoothing, curve, thinned(curve))
        return known[2:]


def curve_of(metrics: Metrics, name: str, smoothing: float) -> Curve:
    """Return a metric of a run.

    Args:
        metrics: Of the run.
        name: Of the metric.
        smoothing: See `smoothed`.
    """
    x, y = metrics.column(name)
    return Curve(x=x, y=smoothed(y, smoothing))


def thinned(curve: Curve) -> Curve:
    """Return a curve of a bounded number of points that looks the same: extremes and ends stay."""
    size = -(-len(curve.y) // _MOST)
    if size <= 2:
        return curve
    whole = len(curve.y) // size * size
    parts = curve.y[:whole].reshape(-1, size)
    first = np.arange(0, whole, size)
    low = first + np.where(np.isnan(parts), np.inf, parts).argmin(axis=1)
    high = first + np.where(np.isnan(parts), -np.inf, parts).argmax(axis=1)
    kept = np.unique(np.concatenate([[0], low, high, np.arange(whole, len(curve.y))]))
    return Curve(x=curve.x[kept], y=curve.y[kept])


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
    finite = np.isfinite(values)
    kept = values[finite]
    counts = (1.0 - weight ** np.arange(1, len(kept) + 1)) / (1.0 - weight)
    out[finite] = _fading_sums(kept, weight) / counts
    return out


def _fading_sums(values: Float[np.ndarray, " k"], weight: float) -> Float[np.ndarray, " k"]:
    """Return for each value the sum of it and `weight` times the sum before it."""
    powers = weight ** np.arange(_BLOCK + 1)
    ages = np.subtract.outer(np.arange(_BLOCK), np.arange(_BLOCK))
    within = np.where(ages >= 0, powers[np.maximum(ages, 0)], 0.0)
    blocks = np.pad(values, (0, -len(values) % _BLOCK)).reshape(-1, _BLOCK)
    sums = blocks @ within.T
    for k in range(1, len(sums)):
        sums[k] += sums[k - 1, -1] * powers[1:]
    return sums.reshape(-1)[: len(values)]


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
