"""Judges of the scenes about resting contact."""

import math
from collections.abc import Iterable, Sequence

import numpy as np

from kinetix.bench.judges.base import Judge, Metric, each, failed, rms
from kinetix.bench.motion import Motion

MOST_TURN = math.radians(10)
"""A box that turned farther has fallen."""
MOST_MOVE = 0.1
"""A top that moved farther has fallen [m]."""


def _moved(motion: Motion, body: int = -1) -> np.ndarray:
    return np.linalg.norm(motion.position[:, body] - motion.position[0, body], axis=-1)


def _stands(motion: Motion) -> bool:
    turn = np.abs(motion.rotation - motion.rotation[0]).max()
    return bool(turn <= MOST_TURN and _moved(motion).max() <= MOST_MOVE)


def _penetration(motion: Motion, good: float, fail: float) -> Metric:
    half = len(motion.position) // 2
    return Metric(
        name="penetration", unit="m", value=motion.penetration()[half:].max(), good=good, fail=fail
    )


def _stack(motion: Motion) -> Iterable[Metric]:
    found = [
        Metric(name="top drift", unit="m", value=_moved(motion).max(), good=5e-3, fail=5e-2),
        _penetration(motion, 2e-3, 2e-2),
        Metric(
            name="final kinetic energy",
            unit="J",
            value=motion.kinetic_energy()[-1],
            good=1e-6,
            fail=1e-2,
        ),
    ]
    return found if _stands(motion) else failed(found)


def _carries(motion: Motion) -> Iterable[Metric]:
    found = [_penetration(motion, 2e-3, 2e-2)]
    return found if _stands(motion) else failed(found)


def _arch(motion: Motion) -> Iterable[Metric]:
    keystone = motion.position[:, 1 + 8, 1]
    drop = np.abs(keystone - keystone[0]).max()
    yield Metric(name="keystone drop", unit="m", value=drop, good=5e-3, fail=5e-2)


def _card_house(motion: Motion) -> Iterable[Metric]:
    top = motion.position[:, -2:, 1]
    drop = np.abs(top - top[0]).max()
    found = [Metric(name="top drop", unit="m", value=drop, good=5e-3, fail=5e-2)]
    moved = np.linalg.norm(motion.position - motion.position[0], axis=-1).max()
    return found if moved <= 0.02 else failed(found)


def _resting(motion: Motion) -> Iterable[Metric]:
    speed = np.linalg.norm(motion.velocity[:, 1], axis=1)
    yield Metric(name="speed", unit="m/s", value=rms(speed), good=1e-4, fail=1e-2)
    yield Metric(name="drift", unit="m", value=_moved(motion).max(), good=1e-4, fail=1e-2)


def _spinner(motion: Motion) -> Iterable[Metric]:
    energy = motion.energy()
    gain = max(0.0, (energy / energy[0] - 1).max())
    yield Metric(name="energy gained", unit="1", value=gain, good=0.01, fail=0.2)
    final = motion.velocity[-30:, 1], 0.2 * motion.angular_velocity[-30:, 1]
    moving = max(np.abs(final[0]).max(), np.abs(final[1]).max()) > 0.05
    yield Metric(name="not at rest at the end", unit="1", value=float(moving), good=0.0, fail=0.0)


def _bullet(motions: Sequence[Motion]) -> list[Metric]:
    found = []
    for name in dict.fromkeys(motion.trial.name for motion in motions):
        chosen = [motion for motion in motions if motion.trial.name == name]
        through = [
            motion.wild_after is not None
            or motion.position[-1, 1, 0] > motion.trial.values["wall"] / 2
            for motion in chosen
        ]
        found.append(
            Metric(
                name="share that passes",
                unit="1",
                value=float(np.mean(through)),
                good=0.0,
                fail=0.0,
                variant=name,
            )
        )
    return found


def _overlap(motion: Motion) -> Iterable[Metric]:
    speed = np.linalg.norm(motion.velocity, axis=-1).max()
    yield Metric(name="fastest", unit="m/s", value=speed, good=0.5, fail=3.0)
    above = motion.position[:, motion.free, 1].max() - motion.trial.values["rest"]
    yield Metric(name="thrown up", unit="m", value=max(0.0, above), good=0.02, fail=0.2)


def _press(motion: Motion) -> Iterable[Metric]:
    found = [_penetration(motion, 5e-3, 5e-2)]
    return found if np.abs(motion.velocity).max() < 10 else failed(found)


CONTACT_JUDGES: dict[str, Judge] = {
    "S1": each(_stack),
    "S2": each(_stack),
    "S3": each(_carries),
    "S4": each(_carries),
    "S5": each(_arch),
    "S6": each(_card_house),
    "S7": each(_resting),
    "S8": each(_spinner),
    "S9": _bullet,
    "S10": each(_overlap),
    "S11": each(_press),
}
"""By the scene's id."""
