"""A measured value with its thresholds, and how trials are put together."""

import dataclasses
import math
import statistics
from collections.abc import Callable, Iterable, Sequence
from typing import Final, Literal

import numpy as np

from kinetix.bench.motion import Motion

Verdict = Literal["good", "ok", "fail"]
FAILED_ERROR: Final = 10.0
"""The normalised error of a failed run."""


@dataclasses.dataclass(frozen=True, kw_only=True)
class Metric:
    """One value of one variant. Without thresholds it is reported only.

    Less is better, unless `fail` lies below `good`; with `fail` 0, anything above 0 fails.
    """

    name: str
    unit: str
    value: float | None
    """None: the run failed (or, without thresholds, there is nothing to report)."""
    good: float | None = None
    fail: float | None = None
    variant: str = ""

    @property
    def label(self) -> str:
        """Name and variant."""
        return f"{self.name} ({self.variant})" if self.variant else self.name

    @property
    def verdict(self) -> Verdict | None:
        """Good up to the first threshold, fail from the second on; None: reported only."""
        if self.good is None or self.fail is None:
            return None
        if self.value is None:
            return "fail"
        sign = -1 if self.fail < self.good else 1
        if sign * self.value <= sign * self.good:
            return "good"
        return "fail" if sign * self.value >= sign * self.fail else "ok"

    @property
    def error(self) -> float:
        """Normalised: 1 is where it fails. 0 where it is reported only."""
        if self.good is None or self.fail is None:
            return 0.0
        return normalised_error(self.value, self.good, self.fail)


def normalised_error(value: float | None, good: float, fail: float) -> float:
    """e_norm: value over the threshold of failing; a failed run counts 10.

    Source: the suite's scores; where more is better (good − value)/(good − fail), where any failure
    is one too many 1 + its share.
    """
    if value is None:
        return FAILED_ERROR
    if fail == 0:
        return 1 + value if value > 0 else 0.0
    if fail < good:
        return max(0.0, (good - value) / (good - fail))
    return value / fail


Judge = Callable[[Sequence[Motion]], list[Metric]]
"""Metrics of the motions of all trials of a scene."""


def each(judge: Callable[[Motion], Iterable[Metric]]) -> Judge:
    """Judge trials one by one; of a variant's phases the worst counts, the median is reported."""

    def judge_all(motions: Sequence[Motion]) -> list[Metric]:
        found: list[Metric] = []
        for name in dict.fromkeys(motion.trial.name for motion in motions):
            phases = [
                judge_safely(judge, motion) for motion in motions if motion.trial.name == name
            ]
            for same in zip(*phases, strict=True):
                found += merge_phases(same)
        return found

    return judge_all


def judge_safely(judge: Callable[[Motion], Iterable[Metric]], motion: Motion) -> list[Metric]:
    """One trial's metrics; of a broken run, and of what is not a number, the value is None."""
    with np.errstate(all="ignore"):
        found = list(judge(motion))
    broken = motion.wild_after is not None
    return [
        dataclasses.replace(
            metric,
            variant=motion.trial.name,
            value=None
            if broken or metric.value is None or not math.isfinite(metric.value)
            else float(metric.value),
        )
        for metric in found
    ]


def merge_phases(same: Sequence[Metric]) -> list[Metric]:
    """Return the worst of a metric's phases; with several, their median too, for information."""
    worst = max(same, key=lambda metric: (metric.error, metric.value or 0))
    if len(same) == 1:
        return [worst]
    values = [math.inf if metric.value is None else metric.value for metric in same]
    median = statistics.median(values)
    return [
        worst,
        Metric(
            name=f"{worst.name}, median of phases",
            unit=worst.unit,
            value=median if math.isfinite(median) else None,
            variant=worst.variant,
        ),
    ]


def failed(metrics: Iterable[Metric]) -> list[Metric]:
    """Return the same metrics of a run that went wrong in the scene's own sense."""
    return [dataclasses.replace(metric, value=None) for metric in metrics]


def after(motion: Motion, seconds: float) -> slice:
    """Return the steps from a moment on."""
    return slice(round(seconds / motion.trial.dt), None)


def last(motion: Motion, seconds: float) -> slice:
    """Return the steps of the last seconds."""
    return slice(-round(seconds / motion.trial.dt), None)


def rms(values: np.ndarray) -> float:
    """Root of the mean square."""
    return float(np.sqrt(np.mean(np.square(values))))
