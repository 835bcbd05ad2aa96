"""From documents to the engine's arrays, and back.

The only file of this package that knows the engine's pytrees. Everything is built as numpy arrays;
nothing here is traced.
"""

import dataclasses
import functools
from collections.abc import Iterable, Iterator, Sequence
from typing import Any, Final, Literal

import jax
import numpy as np
from jaxtyping import Array, Bool, Float, Int

from kinetix.engine.pairs import candidate_pairs, collision_matrix, may_push
from kinetix.engine.pipeline import empty_cache
from kinetix.engine.solvers.base import AbstractSolver
from kinetix.engine.spec import ARENA_BODIES, Capacity, Features, SceneSpec, Used
from kinetix.engine.types import Bodies, Joints, State, Thrusters, World
from kinetix.errors import LevelError
from kinetix.level.geometry import (
    STANDARD_ARENA,
    arena_bodies,
    inverse_mass,
    reverse_winding,
    same_geometry,
    same_masses,
    shape_mass,
)
from kinetix.level.kinetix_env import STANDARD_GRAVITY, KinetixEnvDocument
from kinetix.level.kinetix_env_schema import ENV_PARAMS, KinetixJoint, KinetixThruster
from kinetix.level.model import (
    ARENA_NAMES,
    COLLISIONS,
    ROLES,
    Arena,
    ArenaBody,
    Body,
    BodyReference,
    Circle,
    Geometry,
    InertiaModel,
    Joint,
    Level,
    Limits,
    MassProperties,
    Motor,
    Point,
    Polygon,
    Thruster,
)
from kinetix.level.sizes import (
    capacity_of,
    describe_capacity,
    needed_capacity,
    size_hint,
    size_name,
)
from kinetix.level.slots import body_slots
from kinetix.pytree import pytree

MAX_VERTICES: Final = 4
"""Rows of the vertex array."""

_NO_MOTOR: Final = Motor(on=False)
_NO_LIMITS: Final = Limits(on=False)


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


def empty_scene(spec: SceneSpec, solver: AbstractSolver) -> Scene:
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
        cache=empty_cache(spec, solver),
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
    kept = active[a] & active[b] & (free[a] | free[b]) & may_push(mode[a], mode[b])
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
    """Return the features that a level or compiled world uses: those left out could never act.

    Args:
        subject: A level, a scene or a world (of one level, not a batch).
        capacity: For a level: what it is compiled to; by default `capacity_of(level)`.
    """
    world = _world_of(subject, capacity)
    bodies, joints = world.bodies, world.joints
    active = np.asarray(joints.active)
    hinges = active & ~np.asarray(joints.fixed)
    filled = np.asarray(bodies.active)
    polygons = filled[: len(bodies.vertex_count)]
    thrusters = np.asarray(world.thrusters.active)
    return Features(
        pairs=pushing_pairs(world),
        used=Used(
            bodies=tuple(np.flatnonzero(filled | (np.arange(len(filled)) < ARENA_BODIES)).tolist()),
            joints=tuple(np.flatnonzero(active).tolist()),
            thrusters=tuple(np.flatnonzero(thrusters).tolist()),
        ),
        restitution=bool((np.asarray(bodies.restitution) * np.asarray(bodies.active) > 0).any()),
        triangles=bool((polygons & (np.asarray(bodies.vertex_count) == 3)).any()),
        limits=bool((hinges & np.asarray(joints.limited)).any()),
        welds=bool((active & np.asarray(joints.fixed)).any()),
        motors=bool((hinges & np.asarray(joints.motor_on)).any()),
        thrusters=bool(thrusters.any()),
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
    filled = [each.used for each in every]
    used = None if None in filled else functools.reduce(Used.union, filter(None, filled))
    names = [
        field.name for field in dataclasses.fields(Features) if field.name not in ("pairs", "used")
    ]
    return Features(
        pairs=pairs,
        used=used,
        **{name: any(getattr(each, name) for each in every) for name in names},
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

    Slots beyond the file's own hold what `empty_scene` says; indices of circles move with them.

    Args:
        document: The file.
        solver: Provides the empty warm-start cache; stored impulses are not carried over. Which
            contacts are active is, unless the capacity is larger than the file's own.
        spec: Capacity to compile to; by default the file's own.
        gravity: `fixed`: (0, −9.81) whatever the file says, as kinetix-env's reader does.
        time_limit: `fixed`: 256 steps whatever the file says, as kinetix-env's reader does.

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


def level_from_scene(
    scene: Scene,
    *,
    name: str,
    inertia_model: InertiaModel = "exact",
    description: str = "",
    tags: Sequence[str] = (),
) -> Level:
    """A document from compiled arrays of one world: the present state becomes the initial one.

    Entities get the ids 1, 2, … in slot order: polygons, circles, joints, thrusters.

    Args:
        scene: Arrays of one world, of any array library.
        name: Name of the new level.
        inertia_model: By which masses follow from shapes; where the arrays differ by more than
            1e-5, the body carries `mass_properties`.
        description: Text of the new level.
        tags: Tags of the new level.
    """
    bare = dataclasses.replace(scene, state=dataclasses.replace(scene.state, cache=()))
    scene = jax.tree.map(np.asarray, bare)
    world = scene.world
    capacity = capacity_of_world(world)
    references: dict[int, BodyReference] = dict(enumerate(ARENA_NAMES))
    bodies: list[Body] = []
    for slot in np.flatnonzero(world.bodies.active).tolist():
        if slot >= ARENA_BODIES:
            references[slot] = len(bodies) + 1
            bodies.append(_body_from(scene, slot, len(bodies) + 1, inertia_model))
    hinges = np.flatnonzero(world.joints.active).tolist()
    pushes = np.flatnonzero(world.thrusters.active).tolist()
    first = len(bodies) + 1
    return Level(
        name=name,
        description=description,
        tags=tuple(tags),
        size=size_name(capacity) or size_hint(capacity),
        gravity=_pair(world.gravity),
        max_timesteps=int(scene.labels.max_timesteps),
        inertia_model=inertia_model,
        arena=Arena(
            **{arena: _arena_body_from(scene, slot) for slot, arena in enumerate(ARENA_NAMES)}
        ),
        bodies=tuple(bodies),
        joints=tuple(
            _joint_from(scene, slot, first + k, references) for k, slot in enumerate(hinges)
        ),
        thrusters=tuple(
            _thruster_from(scene, slot, first + len(hinges) + k, references)
            for k, slot in enumerate(pushes)
        ),
    )


def _pair(values: Any) -> Point:
    return float(values[0]), float(values[1])


def _corners(world: World, slot: int) -> tuple[Point, ...]:
    count = int(world.bodies.vertex_count[slot])
    return reverse_winding([_pair(corner) for corner in world.bodies.vertices[slot, :count]])


def _body_from(scene: Scene, slot: int, body_id: int, inertia_model: InertiaModel) -> Body:
    world, state, labels = scene.world, scene.state, scene.labels
    polygons = len(world.bodies.vertex_count)
    shape = (
        Polygon(vertices=_corners(world, slot))
        if slot < polygons
        else Circle(radius=float(world.bodies.radius[slot - polygons]))
    )
    inverses = float(world.bodies.inverse_mass[slot]), float(world.bodies.inverse_inertia[slot])
    fixed = inverses == (0.0, 0.0)
    own = None
    if not fixed:
        derived = shape_mass(shape, float(labels.density[slot]), inertia_model)
        if not same_masses(inverses, derived):
            own = MassProperties(mass=1 / (inverses[0] or 1.0), inertia=1 / (inverses[1] or 1.0))
    return Body(
        id=body_id,
        shape=shape,
        position=_pair(state.position[slot]),
        angle=float(state.rotation[slot]),
        velocity=_pair(state.velocity[slot]),
        angular_velocity=float(state.angular_velocity[slot]),
        density=float(labels.density[slot]),
        friction=float(world.bodies.friction[slot]),
        restitution=float(world.bodies.restitution[slot]),
        role=ROLES[int(labels.role[slot])],
        fixed=fixed,
        collision=COLLISIONS[int(world.bodies.collision_mode[slot])],
        mass_properties=own,
    )


def _arena_body_from(scene: Scene, slot: int) -> ArenaBody:
    world, labels = scene.world, scene.labels
    place = Geometry(position=_pair(scene.state.position[slot]), vertices=_corners(world, slot))
    return ArenaBody(
        role=ROLES[int(labels.role[slot])],
        friction=float(world.bodies.friction[slot]),
        restitution=float(world.bodies.restitution[slot]),
        density=float(labels.density[slot]),
        collision=COLLISIONS[int(world.bodies.collision_mode[slot])],
        geometry=None if same_geometry(place, STANDARD_ARENA[ARENA_NAMES[slot]]) else place,
    )


def _joint_from(
    scene: Scene, slot: int, joint_id: int, references: dict[int, BodyReference]
) -> Joint:
    joints, labels = scene.world.joints, scene.labels
    motor = Motor(
        on=bool(joints.motor_on[slot]),
        speed=float(joints.motor_speed[slot]),
        power=float(joints.motor_power[slot]),
        binding=int(labels.motor_binding[slot]),
        auto=bool(labels.motor_auto[slot]),
    )
    limits = Limits(
        on=bool(joints.limited[slot]),
        min=float(joints.limit_min[slot]),
        max=float(joints.limit_max[slot]),
    )
    return Joint(
        id=joint_id,
        kind="fixed" if joints.fixed[slot] else "revolute",
        a=references[int(joints.body_a[slot])],
        b=references[int(joints.body_b[slot])],
        anchor_a=_pair(joints.anchor_a[slot]),
        anchor_b=_pair(joints.anchor_b[slot]),
        reference_angle=float(joints.reference_angle[slot]),
        motor=None if motor == _NO_MOTOR else motor,
        limits=None if limits == _NO_LIMITS else limits,
    )


def _thruster_from(
    scene: Scene, slot: int, thruster_id: int, references: dict[int, BodyReference]
) -> Thruster:
    thrusters = scene.world.thrusters
    body = references[int(thrusters.body[slot])]
    if isinstance(body, str):
        raise LevelError(f"thruster {slot}: expected a body that is not {body}")
    return Thruster(
        id=thruster_id,
        body=body,
        position=_pair(thrusters.position[slot]),
        angle=float(thrusters.angle[slot]),
        power=float(thrusters.power[slot]),
        binding=int(scene.labels.thruster_binding[slot]),
    )
