"""Scenes in a format of no engine: the input of a peer, and its answer as motions."""

import math
from collections.abc import Sequence
from typing import Any, Final

import numpy as np
from jaxtyping import Float

from kinetix.bench.motion import Motion
from kinetix.level.geometry import inverse_mass, referenced_body
from kinetix.level.graph import components
from kinetix.level.model import ARENA_NAMES, Body, BodyReference, Circle, InertiaModel, Level
from kinetix.scenes.model import Trial

PAIR_FRICTION: Final = 0.4 * math.sqrt(2)
"""Coefficient of friction between two surfaces of friction value 1."""


def scene_of(trial: Trial, *, inertia: InertiaModel | None = None) -> dict[str, Any]:
    """Return a trial as plain JSON, in SI units.

    Bodies are listed in the level's order, then those of the arena that can be felt. `friction` is
    the coefficient that two such surfaces have; `mass` 0 means fixed; bodies of one `group` (not 0)
    never collide, as joints connect them.

    Args:
        trial: The run.
        inertia: By which rule masses follow from shapes, if not by the level's own.
    """
    level = trial.level
    references = _references(level)
    index: dict[BodyReference, int] = {each: k for k, each in enumerate(references)}
    model = inertia or level.inertia_model
    groups = _groups(level, references)
    return {
        "gravity": level.gravity,
        "dt": trial.dt,
        "steps": trial.steps,
        "motor": trial.motor,
        "thruster": trial.thruster,
        "inactive": trial.inactive,
        "recorded": len(level.bodies),
        "bodies": [
            _body(referenced_body(level, reference), model, groups[k])
            for k, reference in enumerate(references)
        ],
        "joints": [
            {
                "weld": joint.kind == "fixed",
                "a": index[joint.a],
                "b": index[joint.b],
                "anchor_a": joint.anchor_a,
                "anchor_b": joint.anchor_b,
                "reference": joint.reference_angle,
                "motor": [joint.motor.speed, joint.motor.power]
                if joint.motor and joint.motor.on
                else None,
                "limits": [joint.limits.min, joint.limits.max]
                if joint.limits and joint.limits.on
                else None,
            }
            for joint in level.joints
        ],
        "thrusters": [
            {
                "body": index[thruster.body],
                "position": thruster.position,
                "angle": thruster.angle,
                "power": thruster.power,
            }
            for thruster in level.thrusters
        ],
    }


def motion_of(trial: Trial, rows: Float[np.ndarray, "k b 6"]) -> Motion:
    """A peer's answer: x, y, angle, their velocities, of every body of the level at every step."""
    rows = rows.astype(np.float64)
    return Motion(
        trial=trial,
        position=rows[..., :2],
        rotation=rows[..., 2],
        velocity=rows[..., 3:5],
        angular_velocity=rows[..., 5],
    )


def _references(level: Level) -> list[BodyReference]:
    joined = {end for joint in level.joints for end in (joint.a, joint.b)}
    arena: list[BodyReference] = [
        name
        for name in ARENA_NAMES
        if name in joined or getattr(level.arena, name).collision != "ghost"
    ]
    return [*(body.id for body in level.bodies), *arena]


def _groups(level: Level, references: Sequence[BodyReference]) -> list[int]:
    """Number the jointed components from 1; 0 for bodies that stand alone."""
    component = components(level.joints)
    numbers = {root: k for k, root in enumerate(dict.fromkeys(component.values()), 1)}
    return [numbers[component[each]] if each in component else 0 for each in references]


def _body(body: Body, model: InertiaModel, group: int) -> dict[str, Any]:
    inverse, inverse_turning = inverse_mass(body, model)
    shape: Sequence[Any] | float
    shape = body.shape.radius if isinstance(body.shape, Circle) else body.shape.vertices
    return {
        "radius" if isinstance(body.shape, Circle) else "vertices": shape,
        "position": body.position,
        "angle": body.angle,
        "velocity": body.velocity,
        "angular_velocity": body.angular_velocity,
        "mass": 1 / inverse if inverse else 0.0,
        "inertia": 1 / inverse_turning if inverse_turning else 0.0,
        "friction": PAIR_FRICTION * body.friction,
        "restitution": body.restitution,
        "collision": body.collision,
        "group": group,
    }
