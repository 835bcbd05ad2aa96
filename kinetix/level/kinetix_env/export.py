"""From our documents to kinetix-env's level JSON; README.md lists what gets lost."""

import json
from collections.abc import Sequence
from typing import Any

import msgspec
import numpy as np

from kinetix.engine.pairs import collision_matrix, pair_counts
from kinetix.engine.spec import Capacity
from kinetix.errors import LevelError
from kinetix.level.geometry import (
    arena_bodies,
    inverse_mass,
    joint_place,
    reverse_winding,
    rotate,
)
from kinetix.level.integrity import level_faults
from kinetix.level.kinetix_env.document import lost_fields
from kinetix.level.kinetix_env.schema import (
    ENV_PARAMS,
    VERTEX_ROWS,
    KinetixBody,
    KinetixContact,
    KinetixJoint,
    KinetixThruster,
    static_env_params,
)
from kinetix.level.model import (
    COLLISIONS,
    ROLES,
    Body,
    BodyReference,
    Circle,
    InertiaModel,
    Joint,
    Level,
    Limits,
    Motor,
    Polygon,
    Thruster,
    round_real,
)
from kinetix.level.sizes import capacity_of
from kinetix.level.slots import body_slots


def world_anchor(body: KinetixBody, local: tuple[float, float]) -> tuple[float, float]:
    """Return a point of a body's frame in world coordinates [m], rounded to binary32."""
    x, y = rotate(local, body.rotation)
    return round_real(body.position[0] + x), round_real(body.position[1] + y)


JointEnd = tuple[KinetixBody, tuple[float, float], float]
"""A body, the anchor in its frame, and its inverse mass."""


def joint_position(a: JointEnd, b: JointEnd) -> tuple[float, float]:
    """World place of a joint: a fixed body's anchor counts, else the inverse-mass weighted mean."""
    (body_a, local_a, weight_a), (body_b, local_b, weight_b) = a, b
    places = world_anchor(body_a, local_a), world_anchor(body_b, local_b)
    x, y = joint_place(*places, (weight_a, weight_b))
    return round_real(x), round_real(y)


def dump_tree(tree: Any) -> str:
    """Return a tree as JSON text the way kinetix-env writes it: one line, no newline at the end."""
    return json.dumps(tree)


def from_level(level: Level, *, stem: str | None = None) -> tuple[str, tuple[str, ...]]:
    """Return kinetix-env's JSON text for a level, and the fields that it cannot hold.

    Args:
        level: The document.
        stem: The file's name without suffix, which is all the name that kinetix-env knows.

    Returns:
        The text, and the names of the fields that kinetix-env loses.

    Raises:
        LevelError: The level does not fit its own size, or refers to a missing body.
    """
    capacity = capacity_of(level)
    faults = [fault for fault in level_faults(level) if fault.code in ("E009", "E011", "E013")]
    if faults:
        raise LevelError(f"level {level.name!r} cannot be written for kinetix-env: {faults[0]}")
    return dump_tree(_export_tree(level, capacity)), lost_fields(level, stem=stem)


def _keyed(values: Sequence[Any]) -> dict[str, Any]:
    """Return an array in kinetix-env's form: an object with decimal keys."""
    return {
        str(k): _keyed(value) if isinstance(value, (tuple, list)) else value
        for k, value in enumerate(values)
    }


def _row(record: Any) -> dict[str, Any]:
    return {
        name: _keyed(value) if isinstance(value, tuple) else value
        for name, value in msgspec.structs.asdict(record).items()
    }


def _export_tree(level: Level, capacity: Capacity) -> dict[str, Any]:
    slots = body_slots(level, capacity)
    model = level.inertia_model
    polygons = [_export_body(body, model) for body in arena_bodies(level.arena)]
    polygons += [_export_body(b, model) for b in level.bodies if isinstance(b.shape, Polygon)]
    circles = [_export_body(b, model) for b in level.bodies if isinstance(b.shape, Circle)]
    polygons += [KinetixBody(n_vertices=VERTEX_ROWS)] * (capacity.polygons - len(polygons))
    circles += [KinetixBody()] * (capacity.circles - len(circles))
    bodies = polygons + circles
    joints = [_export_joint(joint, slots, bodies) for joint in level.joints]
    thrusters = [_export_thruster(thruster, slots, bodies) for thruster in level.thrusters]
    joints += [KinetixJoint()] * (capacity.joints - len(joints))
    thrusters += [KinetixThruster()] * (capacity.thrusters - len(thrusters))
    rr, cr, cc = pair_counts(capacity)
    return {
        "env_state": {
            "polygon": [_row(body) for body in polygons],
            "circle": [_row(body) for body in circles],
            "joint": [_row(joint) for joint in joints],
            "thruster": [_row(thruster) for thruster in thrusters],
            "collision_matrix": _keyed(_export_matrix(joints, capacity)),
            "acc_rr_manifolds": [_row(KinetixContact())] * (2 * rr),
            "acc_cr_manifolds": [_row(KinetixContact())] * cr,
            "acc_cc_manifolds": [_row(KinetixContact())] * cc,
            "gravity": _keyed(level.gravity),
        },
        "env_params": ENV_PARAMS | {"max_timesteps": level.max_timesteps},
        "static_env_params": static_env_params(capacity),
    }


def _export_matrix(joints: list[KinetixJoint], capacity: Capacity) -> list[list[bool]]:
    active = [joint for joint in joints if joint.active]
    matrix = collision_matrix(
        capacity.bodies,
        np.array([joint.a_index for joint in active], dtype=np.int32),
        np.array([joint.b_index for joint in active], dtype=np.int32),
        np.ones(len(active), dtype=np.bool_),
    )
    return matrix.tolist()


def _number(word: str, words: Sequence[str], what: str) -> int:
    """Return kinetix-env's number for a word of ours."""
    if word not in words:
        raise LevelError(f"{what} {word!r}: expected {', '.join(words)}")
    return words.index(word)


def _export_body(body: Body, inertia_model: InertiaModel) -> KinetixBody:
    mass, inertia = inverse_mass(body, inertia_model)
    vertices, radius = (), 0.0
    if isinstance(body.shape, Circle):
        radius = body.shape.radius
    else:
        vertices = reverse_winding(body.shape.vertices)
    return KinetixBody(
        position=body.position,
        rotation=body.angle,
        velocity=body.velocity,
        angular_velocity=body.angular_velocity,
        inverse_mass=mass,
        inverse_inertia=inertia,
        friction=body.friction,
        restitution=body.restitution,
        collision_mode=_number(body.collision, COLLISIONS, "collision"),
        active=True,
        n_vertices=len(vertices),
        vertices=vertices + ((0.0, 0.0),) * (VERTEX_ROWS - len(vertices)),
        radius=radius,
        role=_number(body.role, ROLES, "role"),
        density=body.density,
    )


def _export_joint(
    joint: Joint, slots: dict[BodyReference, int], bodies: list[KinetixBody]
) -> KinetixJoint:
    a, b = slots[joint.a], slots[joint.b]
    motor, limits = joint.motor or Motor(on=False), joint.limits or Limits(on=False)
    return KinetixJoint(
        a_index=a,
        b_index=b,
        a_relative_pos=joint.anchor_a,
        b_relative_pos=joint.anchor_b,
        global_position=joint_position(
            (bodies[a], joint.anchor_a, bodies[a].inverse_mass),
            (bodies[b], joint.anchor_b, bodies[b].inverse_mass),
        ),
        active=True,
        motor_speed=motor.speed,
        motor_power=motor.power,
        motor_on=motor.on,
        motor_has_joint_limits=limits.on,
        min_rotation=limits.min,
        max_rotation=limits.max,
        is_fixed_joint=joint.kind == "fixed",
        rotation=joint.reference_angle,
        motor_binding=motor.binding,
    )


def _export_thruster(
    thruster: Thruster, slots: dict[BodyReference, int], bodies: list[KinetixBody]
) -> KinetixThruster:
    index = slots[thruster.body]
    return KinetixThruster(
        object_index=index,
        relative_position=thruster.position,
        rotation=thruster.angle,
        power=thruster.power,
        global_position=world_anchor(bodies[index], thruster.position),
        active=True,
        thruster_binding=thruster.binding,
    )
