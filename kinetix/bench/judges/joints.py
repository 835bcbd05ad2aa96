"""Judges of the scenes about joints, limits and motors."""

import math
from collections.abc import Iterable

import numpy as np

from kinetix.bench import references
from kinetix.bench.judges.base import Judge, Metric, each, last, rms
from kinetix.bench.motion import Motion
from kinetix.scenes.model import GRAVITY


def _gap(motion: Motion, good: float, fail: float) -> Metric:
    return Metric(name="joint gap", unit="m", value=motion.joint_gap().max(), good=good, fail=fail)


def _period(motion: Motion) -> Iterable[Metric]:
    angle = motion.rotation[:, 1]
    before = np.flatnonzero(angle[:-1] * angle[1:] < 0)
    crossings = (before + angle[before] / (angle[before] - angle[before + 1])) * motion.trial.dt
    value = None
    if len(crossings) >= 21:
        wanted = references.small_swing_period(motion.trial.values["angle"])
        value = abs((crossings[20] - crossings[0]) / 10 / wanted - 1)
    yield Metric(name="period error", unit="1", value=value, good=5e-4, fail=1e-2)


def _pendulum(motion: Motion) -> Iterable[Metric]:
    degrees = round(math.degrees(motion.trial.values["angle"]))
    wanted = references.stored()["pendulum"][str(degrees)]
    yield Metric(
        name="angle error",
        unit="rad",
        value=abs(motion.rotation[-1, 1] - wanted),
        good=5e-3,
        fail=5e-2,
    )
    energy = motion.energy()
    drift = np.abs(energy - energy[0]).max() / (motion.masses[1, 0] * GRAVITY * 0.5)
    yield Metric(name="energy drift", unit="1", value=drift, good=5e-3, fail=5e-2)


def _double_pendulum(motion: Motion) -> Iterable[Metric]:
    tip = np.array(references.stored()["double_pendulum"])
    error = np.linalg.norm(motion.point(-1, (0.0, -0.25)) - tip, axis=1).max()
    yield Metric(name="tip error", unit="m", value=error, good=0.01, fail=0.1)


def _cantilever(motion: Motion) -> Iterable[Metric]:
    drop = np.abs(motion.point(-1, (0.2, 0.0))[:, 1]).max()
    yield Metric(name="tip drop", unit="m", value=drop, good=1e-3, fail=5e-2)
    bend = np.degrees(np.abs(np.diff(motion.rotation, axis=1)).max())
    yield Metric(name="bend", unit="°", value=bend, good=0.1, fail=5.0)


def _chain(motion: Motion) -> Iterable[Metric]:
    yield _gap(motion, 1e-3, 2e-2)
    energy = motion.energy()
    gain = (energy - energy[0]).max() / (motion.trial.values["mass"] * GRAVITY)
    yield Metric(name="energy gained", unit="1", value=max(0.0, gain), good=0.01, fail=0.01)


def _bridge(motion: Motion) -> Iterable[Metric]:
    # Eight planks of .5 m between pins 4 m apart have no slack: the true sag is nought.
    planks = motion.position[:, 1:9, 1]
    yield Metric(name="sag", unit="m", value=np.abs(planks - 2).max(), good=0.01, fail=0.1)
    yield _gap(motion, 1e-3, 2e-2)


def _limit(motion: Motion) -> Iterable[Metric]:
    angle, limit = motion.rotation[:, 1], motion.trial.values["limit"]
    side = -1.0 if motion.trial.name == "falls" else 1.0
    over = max(0.0, (np.abs(angle) - limit).max())
    yield Metric(name="overshoot", unit="°", value=math.degrees(over), good=1.0, fail=10.0)
    end = last(motion, 1.0)
    steady = np.degrees(np.abs(angle[end] - side * limit).max())
    yield Metric(name="steady error", unit="°", value=steady, good=0.1, fail=2.0)
    yield Metric(name="jitter", unit="rad/s", value=rms(motion.angular_velocity[end, 1]))


def _motor(motion: Motion) -> Iterable[Metric]:
    if motion.trial.name == "stalled arm":
        wanted = references.stalled_arm_angle(0.05)
        error = math.degrees(abs(motion.rotation[-1, 1] - wanted))
        yield Metric(name="stall angle error", unit="°", value=error, good=0.1, fail=2.0)
        return
    spin = motion.angular_velocity[last(motion, 1.0), 0]
    yield Metric(name="speed error", unit="rad/s", value=rms(spin - 6), good=0.01, fail=1.0)


def _loop(motion: Motion) -> Iterable[Metric]:
    yield _gap(motion, 1e-3, 1e-2)


def _car(motion: Motion) -> Iterable[Metric]:
    x, v = motion.position[-1, 1, 0], motion.velocity[-1, 1, 0]
    distance, speed = references.stored()["car"]
    yield Metric(name="distance error", unit="m", value=abs(x - distance), good=0.01, fail=0.1)
    yield Metric(name="speed error", unit="1", value=abs(v / speed - 1), good=0.01, fail=0.1)
    yield _gap(motion, 1e-3, 2e-2)


JOINT_JUDGES: dict[str, Judge] = {
    "D1": each(_period),
    "D2": each(_pendulum),
    "D3": each(_double_pendulum),
    "D4": each(_cantilever),
    "D5": each(_chain),
    "D6": each(_bridge),
    "D7": each(_limit),
    "D8": each(_motor),
    "D9": each(_loop),
    "D10": each(_car),
}
"""By the scene's id."""
