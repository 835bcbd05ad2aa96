"""From files of kinetix-env to the engine's arrays."""

from collections.abc import Iterator, Sequence
from typing import Any, Literal

import numpy as np
from jaxtyping import Int

from kinetix.engine.solvers.base import AbstractSolver
from kinetix.engine.spec import SceneSpec
from kinetix.errors import LevelError
from kinetix.level.compile import Scene, empty_scene, finished
from kinetix.level.kinetix_env.document import STANDARD_GRAVITY, KinetixEnvDocument
from kinetix.level.kinetix_env.schema import ENV_PARAMS, KinetixJoint, KinetixThruster
from kinetix.level.sizes import (
    describe_capacity,
)


def compile_kinetix_env(
    document: KinetixEnvDocument,
    *,
    solver: AbstractSolver,
    spec: SceneSpec | None = None,
    gravity: Literal["file", "fixed"] = "file",
    time_limit: Literal["file", "fixed"] = "file",
) -> Scene:
    """A file of kinetix-env as the engine's arrays: slots, gaps, leftovers and masses as stored.

    Slots beyond the file's own are those of `empty_scene`; indices of circles move with them.

    Args:
        document: The file.
        solver: Provides the empty warm-start cache; stored impulses are not carried over. Which
            contacts are active is, unless the capacity is larger than the file's own.
        spec: Capacity to compile to; by default the file's own.
        gravity: `fixed`: (0, −9.81) whatever the file has, as kinetix-env's reader does.
        time_limit: `fixed`: 256 steps whatever the file has, as kinetix-env's reader does.

    Raises:
        LevelError: The file does not fit the capacity.
    """
    own = document.capacity
    spec = spec or SceneSpec(capacity=own)
    if not spec.capacity.covers(own):
        raise LevelError(
            f"{document.file}: does not fit: it has {describe_capacity(own)} (polygons, circles, "
            f"joints, thrusters), got {describe_capacity(spec.capacity)}"
        )
    scene = empty_scene(spec, solver)
    polygons, circles = np.arange(own.polygons), np.arange(own.circles)
    slots = np.concatenate([polygons, spec.capacity.polygons + circles])
    _put_kinetix_bodies(scene, document, slots)
    if document.joints:
        _put_kinetix_joints(scene, document.joints, slots)
    if document.thrusters:
        _put_kinetix_thrusters(scene, document.thrusters, slots)
    if spec.capacity == own:
        scene.state.touching[:] = _stored_touching(document)
    scene.world.gravity[:] = document.gravity if gravity == "file" else STANDARD_GRAVITY
    scene.labels.max_timesteps[...] = (
        document.parameters["max_timesteps"]
        if time_limit == "file"
        else ENV_PARAMS["max_timesteps"]
    )
    return finished(scene)


def _stored_touching(document: KinetixEnvDocument) -> list[bool]:
    """Mark the candidate pairs in contact in the file: snapshots may be taken in mid-episode."""
    slots = [contact.active for contact in document.polygon_contacts]
    pairs = [first or second for first, second in zip(slots[::2], slots[1::2], strict=True)]
    others = document.circle_polygon_contacts + document.circle_contacts
    return pairs + [contact.active for contact in others]


def _columns(rows: Sequence[Any], *names: str) -> Iterator[Any]:
    """One array per field of some records."""
    return (np.array([getattr(row, name) for row in rows]) for name in names)


def _put_kinetix_bodies(
    scene: Scene, document: KinetixEnvDocument, slots: Int[np.ndarray, " k"]
) -> None:
    bodies, state, labels = scene.world.bodies, scene.state, scene.labels
    for array, name in (
        (bodies.inverse_mass, "inverse_mass"),
        (bodies.inverse_inertia, "inverse_inertia"),
        (bodies.friction, "friction"),
        (bodies.restitution, "restitution"),
        (bodies.collision_mode, "collision_mode"),
        (bodies.active, "active"),
        (state.position, "position"),
        (state.rotation, "rotation"),
        (state.velocity, "velocity"),
        (state.angular_velocity, "angular_velocity"),
        (labels.role, "role"),
        (labels.density, "density"),
    ):
        (array[slots],) = _columns(document.bodies, name)
    own = document.capacity
    (bodies.vertices[: own.polygons],) = _columns(document.polygons, "vertices")
    (bodies.vertex_count[: own.polygons],) = _columns(document.polygons, "n_vertices")
    if document.circles:
        (bodies.radius[: own.circles],) = _columns(document.circles, "radius")


def _put_kinetix_joints(
    scene: Scene, rows: Sequence[KinetixJoint], slots: Int[np.ndarray, " k"]
) -> None:
    joints, count = scene.world.joints, len(rows)
    for array, name in (
        (joints.anchor_a, "a_relative_pos"),
        (joints.anchor_b, "b_relative_pos"),
        (joints.active, "active"),
        (joints.fixed, "is_fixed_joint"),
        (joints.reference_angle, "rotation"),
        (joints.motor_on, "motor_on"),
        (joints.motor_speed, "motor_speed"),
        (joints.motor_power, "motor_power"),
        (joints.limited, "motor_has_joint_limits"),
        (joints.limit_min, "min_rotation"),
        (joints.limit_max, "max_rotation"),
        (scene.labels.motor_binding, "motor_binding"),
    ):
        (array[:count],) = _columns(rows, name)
    a, b = _columns(rows, "a_index", "b_index")
    # Unused rows may hold stale indices; a clip keeps them inside without changing those in range.
    joints.body_a[:count] = slots[a.clip(0, len(slots) - 1)]
    joints.body_b[:count] = slots[b.clip(0, len(slots) - 1)]


def _put_kinetix_thrusters(
    scene: Scene, rows: Sequence[KinetixThruster], slots: Int[np.ndarray, " k"]
) -> None:
    thrusters, count = scene.world.thrusters, len(rows)
    for array, name in (
        (thrusters.position, "relative_position"),
        (thrusters.angle, "rotation"),
        (thrusters.power, "power"),
        (thrusters.active, "active"),
        (scene.labels.thruster_binding, "thruster_binding"),
    ):
        (array[:count],) = _columns(rows, name)
    (index,) = _columns(rows, "object_index")
    thrusters.body[:count] = slots[index.clip(0, len(slots) - 1)]
