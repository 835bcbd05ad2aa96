"""Judges of the scenes of free motion."""

import math
from collections.abc import Iterable, Sequence

import numpy as np

from kinetix.bench import references
from kinetix.bench.judges.base import Judge, Metric, each
from kinetix.bench.motion import Motion
from kinetix.scenes.model import GRAVITY


def _free_fall(motion: Motion) -> Iterable[Metric]:
    error = motion.position[:, 0, 1] - (4 - GRAVITY * motion.time**2 / 2)
    yield Metric(
        name="height error", unit="1", value=np.abs(error).max() / 3.14, good=1e-5, fail=1e-2
    )


def _parabola(motion: Motion) -> np.ndarray:
    t = motion.time
    return np.stack([3 * t, 6 * t - GRAVITY * t**2 / 2], axis=1)


def _projectile(motion: Motion) -> Iterable[Metric]:
    error = np.linalg.norm(motion.position[:, 0] - _parabola(motion), axis=1).max()
    yield Metric(name="position error", unit="m", value=error, good=1e-5, fail=4e-2)


def _spin(motion: Motion) -> Iterable[Metric]:
    spin, velocity = motion.angular_velocity[:, 0], motion.velocity[:, 0]
    linear = np.linalg.norm(velocity - (1.0, 0.0), axis=1).max()
    angular = np.abs(spin / 10 - 1).max()
    yield Metric(name="momentum", unit="1", value=linear, good=1e-6, fail=1e-3)
    yield Metric(name="angular momentum", unit="1", value=angular, good=1e-6, fail=1e-3)
    duration = motion.time[-1]
    yield Metric(
        name="angle",
        unit="1",
        value=abs(motion.rotation[-1, 0] / (10 * duration) - 1),
        good=1e-5,
        fail=1e-3,
    )
    yield Metric(
        name="place",
        unit="1",
        value=abs(motion.position[-1, 0, 0] / duration - 1),
        good=1e-5,
        fail=1e-3,
    )


def _thrust(motion: Motion) -> Iterable[Metric]:
    push, t = 5 / (math.pi * 0.3**2), motion.time[-1]
    x, v = motion.position[-1, 0, 0], motion.velocity[-1, 0, 0]
    yield Metric(name="speed", unit="1", value=abs(v / (push * t) - 1), good=1e-4, fail=1e-2)
    yield Metric(
        name="distance", unit="1", value=abs(x / (push * t**2 / 2) - 1), good=1e-4, fail=1e-2
    )


def _thrust_offset(motion: Motion) -> Iterable[Metric]:
    tip = np.array(references.stored()["offset_thrust"])
    error = np.linalg.norm(motion.point(0, (0.3, 0.0)) - tip, axis=1).max()
    yield Metric(name="tip error", unit="m", value=error, good=1e-3, fail=2e-2)


def _hover(motion: Motion) -> Iterable[Metric]:
    error = np.abs(motion.position[:, 0, 1] - 2).max()
    yield Metric(name="height error", unit="m", value=error, good=1e-4, fail=1e-2)


def _order(motions: Sequence[Motion]) -> list[Metric]:
    """Return least-squares slope of log error over log dt, of the errors at the end."""
    found = []
    for name, error in (("I2", _projectile_error), ("D2", _pendulum_error)):
        chosen = [motion for motion in motions if motion.trial.name == name]
        errors = np.array([error(motion) for motion in chosen])
        steps = np.log([motion.trial.dt for motion in chosen])
        value = None
        if np.isfinite(errors).all() and all(motion.wild_after is None for motion in chosen):
            # Without any error there is no slope; such a method counts as good.
            exact = (errors < 1e-6).all()
            value = 2.0 if exact else np.polyfit(steps, np.log(np.maximum(errors, 1e-16)), 1)[0]
        found.append(
            Metric(
                name="order",
                unit="1",
                value=None if value is None else float(value),
                good=1.9,
                fail=1.1,
                variant=name,
            )
        )
    return found


def _projectile_error(motion: Motion) -> float:
    return float(np.linalg.norm(motion.position[-1, 0] - _parabola(motion)[-1]))


def _pendulum_error(motion: Motion) -> float:
    return float(abs(motion.rotation[-1, 1] - references.stored()["pendulum"]["45"]))


INTEGRATOR_JUDGES: dict[str, Judge] = {
    "I1": each(_free_fall),
    "I2": each(_projectile),
    "I3": each(_spin),
    "I4": each(_thrust),
    "I5": each(_thrust_offset),
    "I6": each(_hover),
    "I7": _order,
}
"""By the scene's id."""
