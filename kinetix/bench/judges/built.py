"""Judges of the scenes that people build."""

import dataclasses
import math
from collections.abc import Callable, Iterable, Sequence
from typing import Final

import numpy as np

from kinetix.bench.everyday.judge import energy_gained, way
from kinetix.bench.judges.base import Judge, Metric, each
from kinetix.bench.motion import Motion
from kinetix.level.model import Circle
from kinetix.scenes.model import GRAVITY

DOMINO_SPEED: Final = 3.533
"""Of the wave in U27 [m/s]; examples/domino.py computes it. Source: van Leeuwen, "The domino
effect", American Journal of Physics 78, 721 (2010)."""


def _free(motion: Motion) -> tuple[int, ...]:
    return tuple(body.id for body, free in zip(motion.bodies, motion.free, strict=True) if free)


def _moved(motion: Motion, good: float, fail: float, *, since: float = 0.0) -> Metric:
    value = way(motion, _free(motion), since)
    return Metric(name="moved", unit="m", value=value, good=good, fail=fail)


def _gained(motion: Motion, good: float = 1e-3, fail: float = 2e-2) -> Metric:
    value = energy_gained(motion)
    return Metric(name="energy gained", unit="1", value=value, good=good, fail=fail)


def _stands(good: float, fail: float) -> Callable[[Motion], Iterable[Metric]]:
    def judge(motion: Motion) -> Iterable[Metric]:
        yield _moved(motion, good, fail)
        yield _gained(motion)

    return judge


def _full(motion: Motion) -> Iterable[Metric]:
    """A disc on a box that is turned by 2 µrad, as rounding does, rolls by .7 mm in 10 s."""
    bodies = zip(motion.bodies, motion.free, strict=True)
    kinds: dict[bool, list[int]] = {True: [], False: []}
    for body in (body for body, free in bodies if free):
        kinds[isinstance(body.shape, Circle)].append(body.id)
    for round_ones, name, good, fail in (
        (False, "moved", 1e-4, 2e-3),
        (True, "rolled", 2e-3, 1e-2),
    ):
        value = way(motion, tuple(kinds[round_ones]))
        yield Metric(name=name, unit="m", value=value, good=good, fail=fail)
    yield _gained(motion)


def _shelf(motion: Motion) -> Iterable[Metric]:
    """The heaviest load is reported: no preset holds it at 1/60 s."""
    for metric in _stands(2e-3, 5e-3)(motion):
        heaviest = motion.trial.name == "load 50"
        yield dataclasses.replace(metric, good=None, fail=None) if heaviest else metric


def _slides(most_lost: float) -> Callable[[Motion], Iterable[Metric]]:
    def judge(motion: Motion) -> Iterable[Metric]:
        speed = motion.trial.values["speed"]
        lost = abs(1 - motion.velocity[-1, -1, 0] / speed)
        yield Metric(name="speed lost", unit="1", value=lost, good=most_lost, fail=1e-2)
        height = motion.position[:, -1, 1]
        bump = max(0.0, (height - height[0]).max())
        yield Metric(name="bump", unit="m", value=bump, good=1e-4, fail=1e-3)

    return judge


def _stopped(motion: Motion) -> Iterable[Metric]:
    # The step begins at x = 2; half of the box is .15.
    farthest = motion.position[:, -1, 0].max()
    passed = float(not 1.8 < farthest < 2.0)
    yield Metric(name="does not stop there", unit="1", value=passed, good=0.0, fail=0.0)


def _sticks(motion: Motion) -> Iterable[Metric]:
    yield _moved(motion, 1e-3, 5e-3)


def _turns(motion: Motion) -> Iterable[Metric]:
    height = motion.position[:, -1, 1] + motion.trial.values["path"]
    beyond = motion.position[:, -1, 0] > 0
    turned = height[beyond].max() if beyond.any() else 0.0
    error = abs(turned / motion.trial.values["turned"] - 1)
    yield Metric(name="turning height error", unit="1", value=error, good=1e-2, fail=3e-2)
    from_the_curve = abs(turned / height[0] - 1)
    yield Metric(name="turning height, from that of the curve", unit="1", value=from_the_curve)


def _keeps_energy(motion: Motion) -> Iterable[Metric]:
    fallen = motion.position[0, -1, 1] - motion.position[-1, -1, 1]
    wanted = math.sqrt(motion.trial.values["speed"] ** 2 + 2 * GRAVITY * fallen)
    error = abs(float(np.linalg.norm(motion.velocity[-1, -1])) / wanted - 1)
    good, fail = (1e-2, 3e-2) if motion.trial.values["follows"] else (None, None)
    yield Metric(name="speed error", unit="1", value=error, good=good, fail=fail)


def _as_on_a_slab(motions: Sequence[Motion]) -> list[Metric]:
    tiles, slab = motions
    if tiles.wild_after is not None or slab.wild_after is not None:
        hop = end = None
    else:
        # The chassis and two wheels are the last bodies of both.
        apart = tiles.position[:, -3:] - slab.position[:, -3:]
        hop = float(np.abs(apart[..., 1]).max())
        end = float(np.abs(apart[-1, :, 0]).max())
    return [
        Metric(name="hop", unit="m", value=hop, good=1e-3, fail=1e-2),
        Metric(name="distance error", unit="m", value=end, good=1e-2, fail=1e-1),
    ]


def _share(
    left: Callable[[Motion], np.ndarray],
) -> Callable[[Sequence[Motion]], list[Metric]]:
    """Return the share of free bodies that left, a metric a variant; broken runs count whole."""

    def judge(motions: Sequence[Motion]) -> list[Metric]:
        found = []
        for name in dict.fromkeys(motion.trial.name for motion in motions):
            chosen = [motion for motion in motions if motion.trial.name == name]
            gone = np.concatenate(
                [left(motion) | (motion.wild_after is not None) for motion in chosen]
            )
            found.append(
                Metric(
                    name="share that leaves",
                    unit="1",
                    value=float(gone.mean()),
                    good=0.0,
                    fail=0.0,
                    variant=name,
                )
            )
        return found

    return judge


def _beyond_reach(motion: Motion) -> np.ndarray:
    away = np.linalg.norm(motion.position[:, motion.free], axis=-1)
    return away.max(axis=0) > motion.trial.values["reach"]


def _past_the_wall(motion: Motion) -> np.ndarray:
    end: np.ndarray = motion.position[-1, motion.free, 0]
    return np.atleast_1d(end > motion.trial.values["wall"] / 2)


def _past_either(motion: Motion) -> np.ndarray:
    across = np.abs(motion.position[:, motion.free, 0])
    return across.max(axis=0) > motion.trial.values["half"]


def _carries(motion: Motion) -> Iterable[Metric]:
    yield _moved(motion, 1e-3, 5e-3)


def _chain(motion: Motion) -> Iterable[Metric]:
    depth = motion.penetration().max()
    yield Metric(name="penetration", unit="m", value=depth, good=1e-3, fail=5e-3)
    yield _gained(motion, 1e-3, 1e-2)
    gap = motion.joint_gap().max()
    yield Metric(name="joint gap", unit="m", value=gap, good=1e-3, fail=5e-3)


def _held(motion: Motion) -> Iterable[Metric]:
    ball = motion.position[:, -1, 1]
    slip = np.abs(ball - ball[0]).max()
    yield Metric(name="slip", unit="m", value=slip, good=2e-3, fail=2e-2)


def _pinned(motion: Motion) -> Iterable[Metric]:
    energy = motion.energy()
    lowest = -GRAVITY * motion.masses[:, 0].sum()
    drift = np.abs((energy - lowest) / (energy[0] - lowest) - 1).max()
    yield Metric(name="energy drift", unit="1", value=drift, good=1e-2, fail=5e-2)
    last = motion.position[:, -1, 1]
    still = float((last - last[0]).max() < 0.5 * (1 - math.cos(math.pi / 4)))
    yield Metric(name="last ball hangs still", unit="1", value=still, good=0.0, fail=0.0)


def _rocks(motion: Motion) -> Iterable[Metric]:
    """Housner: an impact leaves the share (1 − 3/2 sin²α)² of the energy."""
    width, height = motion.trial.values["width"], motion.trial.values["height"]
    alpha = math.atan(width / height)
    wanted = 1 - (1 - 1.5 * math.sin(alpha) ** 2) ** 2
    turn = motion.rotation[:, 1]
    # Energy above that of the block at rest, between impacts: there the angle changes its sign.
    energy = motion.energy() - motion.masses[1, 0] * GRAVITY * height / 2
    impacts = np.flatnonzero(np.sign(turn[1:]) * np.sign(turn[:-1]) < 0) + 1
    # Three frames from it on either side the impact is over.
    around = [(k - 3, k + 3) for k in impacts[:3] if k + 3 < len(energy)]
    if len(around) < 2:
        yield Metric(name="loss error", unit="1", value=None, good=0.02, fail=0.05)
        return
    losses = [1 - energy[after] / energy[before] for before, after in around]
    error = max(abs(loss / wanted - 1) for loss in losses)
    yield Metric(name="loss error", unit="1", value=error, good=0.02, fail=0.05)


def _rotor(motion: Motion) -> Iterable[Metric]:
    gap = motion.joint_gap().max()
    yield Metric(name="joint gap", unit="m", value=gap, good=1e-4, fail=1e-3)
    spin = np.median(motion.angular_velocity[len(motion.time) // 2 :, 1])
    yield Metric(name="spin error", unit="1", value=abs(spin / 25 - 1), good=0.01, fail=0.1)


def _wave(motion: Motion) -> Iterable[Metric]:
    turned = -motion.rotation[:, 1:]
    arrival = []
    for angle in turned.T[20:38]:
        after = int(np.argmax(angle > 0.02))
        if after == 0:
            arrival = []
            break
        share = (0.02 - angle[after - 1]) / (angle[after] - angle[after - 1])
        arrival.append((after - 1 + share) * motion.trial.dt)
    value = None
    if arrival and arrival[-1] > arrival[0]:
        speed = motion.trial.values["pitch"] * (len(arrival) - 1) / (arrival[-1] - arrival[0])
        value = abs(speed / DOMINO_SPEED - 1)
    yield Metric(name="speed error", unit="1", value=value, good=5e-2, fail=1e-1)


def _bucket(motion: Motion) -> Iterable[Metric]:
    depth = motion.penetration().max()
    yield Metric(name="penetration", unit="m", value=depth, good=2e-3, fail=2e-2)
    yield _moved(motion, 1e-3, 1e-2, since=motion.trial.duration - 1)
    yield _gained(motion)
    low = motion.position[:, motion.free, 1].min()
    across = np.abs(motion.position[:, motion.free, 0] - 2.5).max()
    # What was highest at the start has come down.
    left = float(low < 0.5 or across > 0.5 or motion.position[-1, -4:, 1].min() > 1.45)
    yield Metric(name="something leaves or hangs", unit="1", value=left, good=0.0, fail=0.0)


BUILT_JUDGES: dict[str, Judge] = {
    "U1": each(_stands(1e-4, 2e-3)),
    "U2": each(_stands(1e-4, 2e-3)),
    "U3": each(_stands(1e-4, 2e-3)),
    "U4": each(_full),
    "U5": each(_stands(1e-3, 5e-3)),
    "U6": each(_shelf),
    "U7": each(_slides(1e-3)),
    "U8": each(_slides(1e-3)),
    "U9": each(_slides(1e-3)),
    # A box that tips over the edge loses .14 % with any step.
    "U10": each(_slides(2e-3)),
    "U11": each(_stopped),
    "U12": each(_sticks),
    "U13": each(_turns),
    "U14": each(_keeps_energy),
    "U15": _as_on_a_slab,
    "U16": _share(_beyond_reach),
    "U17": _share(_beyond_reach),
    "U18": _share(_beyond_reach),
    "U19": _share(_past_the_wall),
    "U20": _share(_past_either),
    "U21": each(_carries),
    "U22": each(_chain),
    "U23": each(_held),
    "U24": each(_pinned),
    "U25": each(_rocks),
    "U26": each(_rotor),
    "U27": each(_wave),
    "U28": each(_bucket),
}
"""By the scene's id."""
