"""From documents to the engine's arrays, and back.

The only file of this package that knows the engine's pytrees. Everything is built as numpy arrays;
nothing here is traced.
"""

import dataclasses
from collections.abc import Iterable
from typing import Any, Final

import numpy as np
from jaxtyping import Array, Bool, Float, Int

from kinetix.engine.pairs import candidate_pairs, collision_matrix
from kinetix.engine.solvers.base import AbstractSolver
from kinetix.engine.spec import Capacity, Features, SceneSpec
from kinetix.engine.types import Bodies, Joints, State, Thrusters, World
from kinetix.errors import LevelError
from kinetix.level.geometry import arena_bodies, inverse_mass, reverse_winding
from kinetix.level.model import COLLISIONS, ROLES, Body, Joint, Level, Limits, Motor, Polygon
from kinetix.level.sizes import capacity_of, describe_capacity, needed_capacity
from kinetix.level.slots import body_slots
from kinetix.pytree import pytree

MAX_VERTICES: Final = 4
"""Rows of the vertex array."""

_NO_MOTOR: Final = Motor(on=False)
_NO_LIMITS: Final = Limits(on=False)


@pytree
class Labels:
    """What a level says about its entities and the engine does not need."""

    role: Int[Array, " b"]
    """0 none, 1 green, 2 blue, 3 red."""
    density: Float[Array, " b"]
    """Mass per area [kg/m²]."""
    motor_binding: Int[Array, " j"]
    """Action channel of the motor, 0 … 3."""
    motor_auto: Bool[Array, " j"]
    """Whether the motor is always driven at +1."""
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


def empty_scene(spec: SceneSpec, solver: AbstractSolver) -> Scene:
    """A scene with every slot inactive, as writable numpy arrays, for builders to fill.

    Inactive slots hold what level_format.md A8 says: friction 1, density 1, collision mode 1,
    vertex count 4, all else 0.
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
        cache=solver.empty_cache(spec),
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
    """The scene with what is derived from all of it: the collision filter."""
    joints = scene.world.joints
    collides = collision_matrix(
        len(scene.world.bodies.active),
        np.asarray(joints.body_a),
        np.asarray(joints.body_b),
        np.asarray(joints.active),
    )
    return dataclasses.replace(scene, world=dataclasses.replace(scene.world, collides=collides))


def compile_level(level: Level, *, spec: SceneSpec, solver: AbstractSolver) -> Scene:
    """A level as the engine's arrays, slots filled without gaps in list order.

    Args:
        level: The document.
        spec: Capacity to compile to; its features do not matter here.
        solver: Provides the empty warm-start cache.

    Raises:
        LevelError: The level does not fit the capacity, or holds what the reader of files would
            refuse and arrays cannot say (more than 4 vertices, a reference to a missing body).
    """
    needed = needed_capacity(level)
    if not spec.capacity.covers(needed):
        raise LevelError(
            f"level {level.name!r} does not fit: it needs {describe_capacity(needed)} (polygons, "
            f"circles, joints, thrusters), got {describe_capacity(spec.capacity)}"
        )
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
    motor, limits = joint.motor or _NO_MOTOR, joint.limits or _NO_LIMITS
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


def pushing_pairs(world: World) -> tuple[tuple[int, int], ...]:
    """The pairs of bodies that can ever push each other, as sorted global indices.

    Left out are exactly those with an inactive body, two fixed bodies, two bodies of one jointed
    component, or two bodies whose collision modes exclude each other; in candidate order.
    """
    bodies = world.bodies
    capacity = capacity_of_world(world)
    a, b = candidate_pairs(capacity).T
    active = np.asarray(bodies.active)
    mode = np.asarray(bodies.collision_mode)
    free = (np.asarray(bodies.inverse_mass) != 0) | (np.asarray(bodies.inverse_inertia) != 0)
    modes_meet = (mode[a] == 2) | (mode[b] == 2) | (mode[a] * mode[b] > 0)
    kept = active[a] & active[b] & (free[a] | free[b]) & modes_meet
    kept &= np.asarray(world.collides)[a, b]
    return tuple(
        (min(i, j), max(i, j)) for i, j in zip(a[kept].tolist(), b[kept].tolist(), strict=True)
    )


def capacity_of_world(world: World) -> Capacity:
    """The capacity that a compiled world has."""
    polygons = len(world.bodies.vertex_count)
    return Capacity(
        polygons=polygons,
        circles=len(world.bodies.radius),
        joints=len(world.joints.active),
        thrusters=len(world.thrusters.active),
    )


def features_of(subject: "Level | Scene | World", *, capacity: Capacity | None = None) -> Features:
    """What a level or compiled world uses, exactly: nothing that it leaves out could ever act.

    Args:
        subject: A level, a scene or a world (of one level, not a batch).
        capacity: For a level: what it is compiled to; by default `capacity_of(level)`.
    """
    world = _world_of(subject, capacity)
    bodies, joints = world.bodies, world.joints
    active = np.asarray(joints.active)
    hinges = active & ~np.asarray(joints.fixed)
    polygons = np.asarray(bodies.active)[: len(bodies.vertex_count)]
    return Features(
        pairs=pushing_pairs(world),
        restitution=bool((np.asarray(bodies.restitution) * np.asarray(bodies.active) > 0).any()),
        triangles=bool((polygons & (np.asarray(bodies.vertex_count) == 3)).any()),
        limits=bool((hinges & np.asarray(joints.limited)).any()),
        welds=bool((active & np.asarray(joints.fixed)).any()),
        motors=bool((hinges & np.asarray(joints.motor_on)).any()),
        thrusters=bool(np.asarray(world.thrusters.active).any()),
    )


def _world_of(subject: "Level | Scene | World", capacity: Capacity | None) -> World:
    if isinstance(subject, World):
        return subject
    if isinstance(subject, Scene):
        return subject.world
    spec = SceneSpec(capacity=capacity or capacity_of(subject))
    return compile_level(subject, spec=spec, solver=_NoSolver()).world


class _NoSolver(AbstractSolver):
    """Stands in where only a world is wanted."""

    name = "none"

    def empty_cache(self, spec: SceneSpec) -> Any:
        """Nothing is kept."""
        return ()

    def step(self, world: Any, state: Any, control: Any, parameters: Any, spec: Any) -> State:
        """There is nothing to step."""
        raise TypeError("a world that was compiled without a solver cannot be stepped")


def features_union(features: Iterable[Features], capacity: Capacity) -> Features:
    """The least features that cover several scenes of one capacity."""
    every = list(features)
    listed = [each.pairs for each in every]
    pairs = None
    if None not in listed:
        wanted = {pair for each in listed if each for pair in each}
        ordered = ((min(a, b), max(a, b)) for a, b in candidate_pairs(capacity).tolist())
        pairs = tuple(pair for pair in ordered if pair in wanted)
    names = [field.name for field in dataclasses.fields(Features) if field.name != "pairs"]
    return Features(
        pairs=pairs, **{name: any(getattr(each, name) for each in every) for name in names}
    )
