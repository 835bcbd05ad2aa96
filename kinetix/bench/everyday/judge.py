"""Faults of a scene: numbers with limits, from the motion of any engine."""

import dataclasses
from collections.abc import Mapping
from typing import Any, Final

import numpy as np
from jaxtyping import Float

from kinetix.bench.motion import Motion
from kinetix.engine.types import default_parameters
from kinetix.level.geometry import inverse_mass, referenced_body
from kinetix.level.model import BodyReference, Joint
from kinetix.scenes.everyday.model import EverydayScene


@dataclasses.dataclass(frozen=True, kw_only=True)
class Limit:
    """A number that every scene is judged by; more than the limit is bad."""

    unit: str
    limit: float
    note: str
    """For people."""


LIMITS: Final[dict[str, Limit]] = {
    "moved": Limit(unit="m", limit=2e-3, note="way of a body that should rest"),
    "energy": Limit(
        unit="1", limit=0.02, note="energy out of nothing, as a share of what there was"
    ),
    "overlap": Limit(unit="m", limit=5e-3, note="deepest overlap beyond that at the start"),
    "joints": Limit(unit="m", limit=5e-3, note="widest gap of a joint beyond that at the start"),
    "escaped": Limit(unit="1", limit=0.0, note="bodies that left what encloses them"),
    "seams": Limit(unit="m", limit=2e-3, note="difference from one slab, beyond 1 % of the way"),
    "dropped": Limit(unit="1", limit=0.0, note="share of steps that left a contact out"),
    "outcome": Limit(unit="m", limit=0.05, note="end against that with 1/32 of the step"),
}
"""In the order of reports."""

SAME_END: Final = 0.01
"""Fine runs whose ends differ by more are chaotic: their scene's outcome is not judged [m]."""
WORK_MARGIN: Final = 1.1
"""Motors may have done this much more work than the recorded frames show."""


@dataclasses.dataclass(frozen=True, kw_only=True)
class Recorded:
    """A scene with what an engine made of it."""

    scene: EverydayScene
    motion: Motion
    twin: Motion | None = None
    fine: tuple[Motion, Motion] | None = None
    """With 1/16 and 1/32 of the step."""


def judge(recorded: Recorded) -> dict[str, float | None]:
    """Return the numbers that apply to a scene; None: the run broke."""
    scene, motion = recorded.scene, recorded.motion
    found: dict[str, float | None] = {
        "energy": energy_gained(motion),
        "overlap": _beyond_start(motion.penetration()),
        "dropped": motion.overflow,
    }
    if scene.trial.level.joints:
        found["joints"] = _beyond_start(motion.joint_gap().max(axis=1))
    if scene.rests:
        found["moved"] = way(motion, scene.rests, scene.rests_from)
    if scene.inside:
        found["escaped"] = float(_outside(scene, motion))
    if recorded.twin is not None:
        found["seams"] = _seams(scene, motion, recorded.twin)
    if recorded.fine is not None:
        found |= _outcome(motion, *recorded.fine)
    if motion.wild_after is not None:
        found = dict.fromkeys(found)
    return {name: found[name] for name in LIMITS if name in found}


def bad(numbers: Mapping[str, float | None]) -> list[str]:
    """Return the names of the numbers beyond their limits."""
    return [
        name for name, value in numbers.items() if value is None or not value <= LIMITS[name].limit
    ]


def excess(name: str, value: float | None) -> float:
    """Return how bad a number is, to compare numbers of different kinds: 1 is the limit."""
    limit = LIMITS[name].limit
    return np.inf if value is None else value / limit if limit else 1e3 * value


def _beyond_start(values: Float[np.ndarray, " k"]) -> float:
    return max(0.0, float(values.max() - values[0]))


def _indices(motion: Motion, ids: tuple[int, ...]) -> list[int]:
    index = {body.id: k for k, body in enumerate(motion.bodies)}
    return [index[each] for each in ids]


def way(motion: Motion, ids: tuple[int, ...], since: float = 0.0) -> float:
    """Return the largest displacement of any of the bodies since a moment [m]."""
    first = round(since / motion.trial.dt)
    moved = motion.position[first:, _indices(motion, ids)]
    return float(np.linalg.norm(moved - moved[0], axis=-1).max())


def _outside(scene: EverydayScene, motion: Motion) -> int:
    left, bottom, right, top = scene.box
    x, y = np.moveaxis(motion.position[:, _indices(motion, scene.inside)], -1, 0)
    within = (x >= left) & (x <= right) & (y >= bottom) & (y <= top)
    return int((~within.all(axis=0)).sum())


def _seams(scene: EverydayScene, motion: Motion, twin: Motion) -> float:
    over = motion.position[:, _indices(motion, scene.watched)]
    wanted = twin.position[:, -len(scene.watched) :]
    travelled = np.cumsum(np.linalg.norm(np.diff(wanted, axis=0), axis=-1), axis=0)
    error = np.linalg.norm(over - wanted, axis=-1)[1:] - 0.01 * travelled
    return max(0.0, float(error.max()))


def _outcome(motion: Motion, coarser: Motion, fine: Motion) -> dict[str, float | None]:
    """Return the distance from the fine run's end; nothing where the fine runs disagree."""
    free = motion.free
    if coarser.wild_after is not None or fine.wild_after is not None:
        return {}

    def apart(first: Motion, second: Motion) -> float:
        difference = first.position[-1, free] - second.position[-1, free]
        return float(np.linalg.norm(difference, axis=-1).max())

    return {"outcome": apart(motion, fine)} if apart(coarser, fine) <= SAME_END else {}


def energy_gained(motion: Motion) -> float:
    """Return the energy that no motor and no fall can explain, as a share of what there was.

    That is the kinetic energy at the start and the potential energy above the lowest body.
    """
    level = motion.trial.level
    mass = motion.masses[:, 0]
    pull = np.linalg.norm(level.gravity)
    height = -(motion.position[0] @ np.array(level.gravity)) / max(float(pull), 1e-9)
    scale = float(motion.kinetic_energy()[0])
    scale += float(pull * (mass @ (height - height.min() + 0.1)))
    energy = motion.energy()
    gained = energy - energy[0] - WORK_MARGIN * motor_work(motion)
    return max(0.0, float(gained.max())) / max(scale, 1e-9)


def motor_work(motion: Motion) -> Float[np.ndarray, " k"]:
    """Return the work that the motors have done at most, by their law at the frames [J]."""
    total = np.zeros(len(motion.position))
    for joint in motion.trial.level.joints:
        if joint.motor is not None and joint.motor.on and motion.trial.motor:
            total += _work(motion, joint)
    return total


def _work(motion: Motion, joint: Joint) -> Float[np.ndarray, " k"]:
    assert joint.motor is not None
    law = default_parameters()
    level = motion.trial.level
    ends = [referenced_body(level, end) for end in (joint.a, joint.b)]
    inverse = sum(inverse_mass(end, level.inertia_model)[1] for end in ends)
    if not inverse:
        return np.zeros(len(motion.position))
    spin = _spin(motion, joint.b) - _spin(motion, joint.a)
    wanted = law.base_motor_speed * joint.motor.speed * motion.trial.motor
    strength = law.base_motor_power * joint.motor.power / inverse
    torque = strength * np.tanh(law.motor_decay_coefficient * (wanted - spin))
    # Within a frame both may have been what they are at either end, whichever way it turns.
    power = np.maximum(
        np.maximum(*_ends(torque)) * np.maximum(*_ends(spin)),
        np.minimum(*_ends(torque)) * np.minimum(*_ends(spin)),
    )
    return np.concatenate([[0.0], np.cumsum(np.maximum(power, 0) * motion.trial.dt)])


def _ends(values: Any) -> tuple[np.ndarray, np.ndarray]:
    """At the start and at the end of every frame."""
    return values[:-1], values[1:]


def _spin(motion: Motion, reference: BodyReference) -> Float[np.ndarray, " k"]:
    for k, body in enumerate(motion.bodies):
        if body.id == reference:
            return motion.angular_velocity[:, k]
    return np.zeros(len(motion.position))
