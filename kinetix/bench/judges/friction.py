"""Judges of the scenes about sliding, sticking and rolling."""

import math
from collections.abc import Iterable, Sequence

import numpy as np

from kinetix.bench.judges.base import Judge, Metric, each
from kinetix.bench.motion import Motion
from kinetix.scenes.model import GRAVITY

STUCK = 1e-3
"""A box that moved less has stuck [m]."""


def _along(motion: Motion) -> np.ndarray:
    """Return the distance covered down the slope [m]; a tilted floor counts along itself."""
    moved = motion.position[:, 1] - motion.position[0, 1]
    tilt = motion.rotation[0, 0]
    return moved @ np.array([math.cos(tilt), math.sin(tilt)])


def _distance(motion: Motion, wanted: float) -> Metric:
    """Relative error of the distance at the end; the tilted floor is a check without verdict."""
    error = abs(_along(motion)[-1] / wanted - 1)
    limits = (None, None) if motion.trial.name else (5e-3, 5e-2)
    return Metric(name="distance error", unit="1", value=error, good=limits[0], fail=limits[1])


def _slide(motion: Motion) -> Iterable[Metric]:
    slope = motion.trial.values["slope"]
    pull = GRAVITY * (math.sin(slope) - 0.3 * math.cos(slope))
    yield _distance(motion, pull * motion.time[-1] ** 2 / 2)


def _stick_map(motions: Sequence[Motion]) -> list[Metric]:
    found = []
    for name in dict.fromkeys(motion.trial.name for motion in motions):
        chosen = [motion for motion in motions if motion.trial.name == name]
        stuck = [motion.wild_after is None and abs(_along(motion)[-1]) < STUCK for motion in chosen]
        angles = [math.degrees(motion.trial.values["slope"]) for motion in chosen]
        # The next angle beyond the map stands in where nothing sticks or nothing slips.
        last_stuck = max(
            (a for a, s in zip(angles, stuck, strict=True) if s), default=angles[0] - 1
        )
        slipping = min(
            (a for a, s in zip(angles, stuck, strict=True) if not s), default=angles[-1] + 1
        )
        wanted = math.degrees(math.atan(chosen[0].trial.values["friction"]))
        value = None
        if all(motion.wild_after is None for motion in chosen):
            value = abs((last_stuck + slipping) / 2 - wanted)
        found.append(
            Metric(
                name="slipping angle error", unit="°", value=value, good=0.5, fail=3.0, variant=name
            )
        )
    return found


def _stop(motion: Motion) -> Iterable[Metric]:
    wanted = 3**2 / (2 * 0.4 * GRAVITY)
    error = abs(_along(motion)[-1] / wanted - 1)
    yield Metric(name="distance error", unit="1", value=error, good=0.01, fail=0.05)


def _creep(motion: Motion) -> Iterable[Metric]:
    moved = np.linalg.norm(motion.position[:, 1] - motion.position[0, 1], axis=1).max()
    yield Metric(name="displacement", unit="m", value=moved, good=1e-3, fail=1e-2)


def _roll(motion: Motion) -> Iterable[Metric]:
    pull = GRAVITY * math.sin(motion.trial.values["slope"]) / 1.5
    yield _distance(motion, pull * motion.time[-1] ** 2 / 2)
    tilt = motion.rotation[0, 0]
    speed = motion.velocity[:, 1] @ np.array([math.cos(tilt), math.sin(tilt)])
    slip = np.abs(speed + 0.25 * motion.angular_velocity[:, 1]).max()
    limits = (None, None) if motion.trial.name else (0.01, 0.1)
    yield Metric(name="slip", unit="m/s", value=slip, good=limits[0], fail=limits[1])


def _slip_roll(motion: Motion) -> Iterable[Metric]:
    speed = motion.velocity[:, 1, 0]
    yield Metric(
        name="final speed error", unit="1", value=abs(speed[-1] / 2 - 1), good=0.01, fail=0.05
    )
    # Slip falls in a straight line; its end is found between steps by carrying the line on.
    slip = speed + 0.25 * motion.angular_velocity[:, 1]
    sliding = (slip > 0.6) & (slip < 2.4)
    value = None
    if sliding.sum() > 1:
        fall, start = np.polyfit(motion.time[sliding], slip[sliding], 1)
        value = abs(-start / fall / (3 * 0.5 / (1.5 * 0.2 * GRAVITY)) - 1)
    yield Metric(name="time to roll, error", unit="1", value=value, good=0.01, fail=0.05)


FRICTION_JUDGES: dict[str, Judge] = {
    "F1": each(_slide),
    "F2": _stick_map,
    "F3": each(_stop),
    "F4": each(_creep),
    "F5": each(_roll),
    "F6": each(_slip_roll),
}
"""By the scene's id."""
