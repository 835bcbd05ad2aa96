"""Judges of the scenes about hits."""

import math
from collections.abc import Iterable

import numpy as np

from kinetix.bench import references
from kinetix.bench.judges.base import Judge, Metric, after, each, last, rms
from kinetix.bench.motion import Motion
from kinetix.scenes.model import GRAVITY

LEAST_IMPACT = 0.5
"""Bounces from slower reference impacts are not counted, as engines have thresholds [m/s]."""


def _elastic(motion: Motion) -> Iterable[Metric]:
    energy = motion.energy() - motion.masses[1, 0] * GRAVITY * 0.2
    drift = float(np.abs(energy / energy[0] - 1).max())
    yield Metric(name="energy drift", unit="1", value=drift, good=0.01, fail=0.05)


def _apexes(motion: Motion, count: int) -> list[float]:
    """Heights of the lowest point at the top of the first flights after bounces [m].

    A flight is a run of steps in which gravity alone acts; its apex follows from its slowest step.
    """
    speed = motion.velocity[:, 1, 1]
    height = motion.position[:, 1, 1] - 0.2
    kick = GRAVITY * motion.trial.dt
    starts = np.flatnonzero((speed[:-1] < 0) & (speed[1:] > 0)) + 1
    found = []
    for start in starts[:count]:
        alone = np.abs(np.diff(speed[start:]) + kick) < 0.1 * kick
        length = len(alone) if alone.all() else int(np.argmin(alone))
        flight = slice(start, start + length + 1)
        slowest = start + int(np.argmin(np.abs(speed[flight])))
        found.append(float(height[slowest] + speed[slowest] ** 2 / (2 * GRAVITY)))
    return found + [0.0] * (count - len(found))


def _restitution(motion: Motion) -> Iterable[Metric]:
    e, height = motion.trial.values["restitution"], motion.trial.values["height"]
    first = math.sqrt(2 * GRAVITY * height)
    count = sum(first * e ** (k - 1) >= LEAST_IMPACT for k in (1, 2, 3))
    errors = [
        abs(apex / (e ** (2 * k) * height) - 1)
        for k, apex in enumerate(_apexes(motion, count), start=1)
    ]
    yield Metric(
        name="mean apex error", unit="1", value=float(np.mean(errors)), good=0.01, fail=0.1
    )


def _settle(motion: Motion) -> Iterable[Metric]:
    e, height = motion.trial.values["restitution"], motion.trial.values["height"]
    wanted = math.sqrt(2 * height / GRAVITY) * (1 + 2 * e / (1 - e))
    fast = np.flatnonzero(~(np.abs(motion.velocity[:, 1, 1]) < 0.05))
    settled = motion.time[min(fast[-1] + 1, len(motion.time) - 1)]
    yield Metric(
        name="time to settle, error",
        unit="s",
        value=float(abs(settled - wanted)),
        good=0.1,
        fail=0.5,
    )
    speed = np.linalg.norm(motion.velocity[last(motion, 1.0), 1], axis=1)
    yield Metric(
        name="speed in the last second", unit="m/s", value=rms(speed), good=1e-3, fail=0.05
    )


def _oblique(motion: Motion) -> Iterable[Metric]:
    sixty, thirty = math.radians(-60), math.radians(30)
    wanted = np.array(
        [
            (math.cos(sixty), math.sin(sixty)),
            (math.sqrt(3) * math.cos(thirty), math.sqrt(3) * math.sin(thirty)),
        ]
    )
    error = np.linalg.norm(motion.velocity[-1] - wanted, axis=1).max()
    yield Metric(name="velocity error", unit="m/s", value=error, good=1e-3, fail=0.05)


def _cradle(motion: Motion) -> Iterable[Metric]:
    speed = motion.velocity[-1, :, 0]
    yield Metric(
        name="last disc's speed error", unit="m/s", value=abs(speed[-1] - 2), good=0.05, fail=0.5
    )
    yield Metric(name="others' speed", unit="m/s", value=np.abs(speed[:-1]).max())


def _gas(motion: Motion) -> Iterable[Metric]:
    energy = motion.kinetic_energy()
    drift = float(np.abs(energy / energy[0] - 1).max())
    yield Metric(name="kinetic energy drift", unit="1", value=drift, good=0.02, fail=0.2)


def _spin_bounce(motion: Motion) -> Iterable[Metric]:
    vx, vy, spin = references.bounce_off((1.0, -4.0), -20.0, 0.2, 0.5, 0.3)
    velocity = np.linalg.norm(motion.velocity[-1, 1] - (vx, vy))
    turning = 0.2 * abs(motion.angular_velocity[-1, 1] - spin)
    yield Metric(
        name="velocity error", unit="m/s", value=max(velocity, turning), good=0.01, fail=0.2
    )


def _box_drop(motion: Motion) -> Iterable[Metric]:
    # It falls until it touches, so every upward speed comes afterwards.
    upward = max(0.0, motion.velocity[:, 1, 1].max())
    yield Metric(name="upward speed", unit="m/s", value=upward, good=0.02, fail=0.3)
    energy = motion.energy()[after(motion, 0.0)]
    yield Metric(name="energy gained", unit="J", value=(energy - energy[0]).max())


IMPACT_JUDGES: dict[str, Judge] = {
    "B1": each(_elastic),
    "B2": each(_restitution),
    "B3": each(_settle),
    "B4": each(_oblique),
    "B5": each(_cradle),
    "B6": each(_gas),
    "B7": each(_spin_bounce),
    "B8": each(_box_drop),
}
"""By the scene's id."""
