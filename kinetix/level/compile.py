"""From levels to the engine's arrays. Everything is built as numpy arrays; nothing is traced."""

import dataclasses
from typing import Any, Final

import numpy as np
from jaxtyping import Array, Bool, Float, Int

from kinetix.engine.pairs import candidate_pairs, collision_matrix
from kinetix.engine.pipeline import empty_cache
from kinetix.engine.solvers.base import AbstractSolver
from kinetix.engine.spec import SceneSpec
from kinetix.engine.types import Bodies, Joints, State, Thrusters, World
from kinetix.errors import LevelError
from kinetix.level.geometry import (
    arena_bodies,
    inverse_mass,
    reverse_winding,
)
from kinetix.level.model import (
    COLLISIONS,
    ROLES,
    Body,
    Joint,
    Level,
    Limits,
    Motor,
    Polygon,
)
from kinetix.level.sizes import (
    needed_capacity,
    shortages,
)
from kinetix.level.slots import body_slots
from kinetix.pytree import pytree

MAX_VERTICES: Final = 4
"""Rows of the vertex array."""

NO_MOTOR: Final = Motor(on=False)
"""Default of a joint without one."""

NO_LIMITS: Final = Limits(on=False)
"""Defaults of a joint without them."""


@pytree
class Labels:
    """Properties of a level's entities that the engine does not need."""

    role: Int[Array, " b"]
    """0 none, 1 green, 2 blue, 3 red."""
    density: Float[Array, " b"]
    """Mass per area [kg/m²]."""
    motor_binding: Int[Array, " j"]
    """Action channel of the motor, 0 … 3."""
    motor_auto: Bool[Array, " j"]
    """True where the motor is always driven at +1."""
    thruster_binding: Int[Array, " t"]
    """Action channel of the thruster, 0 … 1."""
    max_timesteps: Int[Array, ""]
    """Episode length in environment steps."""


@pytree
class Scene:
    """A compiled level: ready for the environment."""

    world: World
    state: State
    labels: Labels


def empty_scene(spec: SceneSpec, solver: AbstractSolver | None) -> Scene:
    """A scene with every slot inactive, as writable numpy arrays, for builders to fill.

    Inactive slots hold what kinetix-env's files hold there: friction 1, density 1, collision mode
    1, vertex count 4, all else 0.
    """
    size = spec.capacity
    b, p, r, j, t = size.bodies, size.polygons, size.circles, size.joints, size.thrusters

    def zeros(*shape: int) -> Any:
        return np.zeros(shape, np.float32)

    def ones(n: int) -> Any:
        return np.ones(n, np.float32)

    def integers(*shape: int, value: int = 0) -> Any:
        return np.full(shape, value, np.int32)

    def flags(*shape: int) -> Any:
        return np.zeros(shape, np.bool_)

    bodies = Bodies(
        inverse_mass=zeros(b),
        inverse_inertia=zeros(b),
        friction=ones(b),
        restitution=zeros(b),
        collision_mode=integers(b, value=1),
        active=flags(b),
        vertices=zeros(p, MAX_VERTICES, 2),
        vertex_count=integers(p, value=MAX_VERTICES),
        radius=zeros(r),
    )
    joints = Joints(
        body_a=integers(j),
        body_b=integers(j),
        anchor_a=zeros(j, 2),
        anchor_b=zeros(j, 2),
        active=flags(j),
        fixed=flags(j),
        reference_angle=zeros(j),
        motor_on=flags(j),
        motor_speed=zeros(j),
        motor_power=zeros(j),
        limited=flags(j),
        limit_min=zeros(j),
        limit_max=zeros(j),
    )
    thrusters = Thrusters(
        body=integers(t), position=zeros(t, 2), angle=zeros(t), power=zeros(t), active=flags(t)
    )
    world = World(
        bodies=bodies,
        joints=joints,
        thrusters=thrusters,
        gravity=zeros(2),
        collides=flags(b, b),
    )
    state = State(
        position=zeros(b, 2),
        rotation=zeros(b),
        velocity=zeros(b, 2),
        angular_velocity=zeros(b),
        touching=flags(len(candidate_pairs(size))),
        overflow=flags(),
        cache=() if solver is None else empty_cache(spec, solver),
    )
    labels = Labels(
        role=integers(b),
        density=ones(b),
        motor_binding=integers(j),
        motor_auto=flags(j),
        thruster_binding=integers(t),
        max_timesteps=integers(),
    )
    return Scene(world=world, state=state, labels=labels)


def finished(scene: Scene) -> Scene:
    """Return the scene with what is derived from all of it: the collision filter."""
    joints = scene.world.joints
    collides = collision_matrix(
        len(scene.world.bodies.active),
        np.asarray(joints.body_a),
        np.asarray(joints.body_b),
        np.asarray(joints.active),
    )
    return dataclasses.replace(scene, world=dataclasses.replace(scene.world, collides=collides))


def compile_level(level: Level, *, spec: SceneSpec, solver: AbstractSolver | None = None) -> Scene:
    """A level as the engine's arrays, slots filled without gaps in list order.

    Args:
        level: The document.
        spec: Capacity to compile to; its features do not matter here.
        solver: Provides the empty warm-start cache; None where only the world is wanted.

    Raises:
        LevelError: The level does not fit the capacity, or holds what the reader of files would
            refuse and arrays cannot hold (more than 4 vertices, a reference to a missing body).
    """
    needed = needed_capacity(level)
    if not spec.capacity.covers(needed):
        sentences = " ".join(shortages(needed, spec.capacity))
        raise LevelError(f"level {level.name!r}: {sentences}")
    scene = empty_scene(spec, solver)
    slots = body_slots(level, spec.capacity)
    for slot, body in enumerate(arena_bodies(level.arena)):
        _put_body(scene, slot, body, level)
    for body in level.bodies:
        _put_body(scene, slots[body.id], body, level)
    try:
        for index, joint in enumerate(level.joints):
            _put_joint(scene, index, joint, slots[joint.a], slots[joint.b])
        _put_thrusters(scene, level, slots)
    except KeyError as error:
        raise LevelError(
            f"level {level.name!r}: a joint or thruster refers to the missing body {error}"
        ) from None
    scene.world.gravity[:] = level.gravity
    scene.labels.max_timesteps[...] = level.max_timesteps
    return finished(scene)


def _put_body(scene: Scene, slot: int, body: Body, level: Level) -> None:
    bodies, state = scene.world.bodies, scene.state
    bodies.inverse_mass[slot], bodies.inverse_inertia[slot] = inverse_mass(
        body, level.inertia_model
    )
    bodies.friction[slot] = body.friction
    bodies.restitution[slot] = body.restitution
    bodies.collision_mode[slot] = COLLISIONS.index(body.collision)
    bodies.active[slot] = True
    if isinstance(body.shape, Polygon):
        vertices = reverse_winding(body.shape.vertices)
        if len(vertices) > MAX_VERTICES:
            raise LevelError(
                f"level {level.name!r}: body {body.id} has {len(vertices)} vertices, "
                f"expected at most {MAX_VERTICES}"
            )
        bodies.vertices[slot, : len(vertices)] = vertices
        bodies.vertex_count[slot] = len(vertices)
    else:
        bodies.radius[slot - len(bodies.vertex_count)] = body.shape.radius
    state.position[slot] = body.position
    state.rotation[slot] = body.angle
    state.velocity[slot] = body.velocity
    state.angular_velocity[slot] = body.angular_velocity
    scene.labels.role[slot] = ROLES.index(body.role)
    scene.labels.density[slot] = body.density


def _put_joint(scene: Scene, index: int, joint: Joint, body_a: int, body_b: int) -> None:
    joints = scene.world.joints
    motor, limits = joint.motor or NO_MOTOR, joint.limits or NO_LIMITS
    joints.body_a[index], joints.body_b[index] = body_a, body_b
    joints.anchor_a[index], joints.anchor_b[index] = joint.anchor_a, joint.anchor_b
    joints.active[index] = True
    joints.fixed[index] = joint.kind == "fixed"
    joints.reference_angle[index] = joint.reference_angle
    joints.motor_on[index] = motor.on
    joints.motor_speed[index] = motor.speed
    joints.motor_power[index] = motor.power
    joints.limited[index] = limits.on
    joints.limit_min[index] = limits.min
    joints.limit_max[index] = limits.max
    scene.labels.motor_binding[index] = motor.binding
    scene.labels.motor_auto[index] = motor.auto


def _put_thrusters(scene: Scene, level: Level, slots: dict[Any, int]) -> None:
    thrusters = scene.world.thrusters
    for index, thruster in enumerate(level.thrusters):
        thrusters.body[index] = slots[thruster.body]
        thrusters.position[index] = thruster.position
        thrusters.angle[index] = thruster.angle
        thrusters.power[index] = thruster.power
        thrusters.active[index] = True
        scene.labels.thruster_binding[index] = thruster.binding
