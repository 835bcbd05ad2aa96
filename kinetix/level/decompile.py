"""From the engine's arrays back to a level."""

import dataclasses
from collections.abc import Sequence
from typing import Any

import jax
import numpy as np

from kinetix.engine.spec import ARENA_BODIES
from kinetix.engine.types import World
from kinetix.errors import LevelError
from kinetix.level.compile import NO_LIMITS, NO_MOTOR, Scene
from kinetix.level.features import capacity_of_world
from kinetix.level.geometry import (
    STANDARD_ARENA,
    reverse_winding,
    same_geometry,
    same_masses,
    shape_mass,
)
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
from kinetix.level.representable import check_sayable
from kinetix.level.sizes import (
    size_hint,
    size_name,
)


def level_from_scene(
    scene: Scene,
    *,
    name: str,
    inertia_model: InertiaModel = "exact",
    description: str = "",
    tags: Sequence[str] = (),
) -> Level:
    """A document from compiled arrays of one world: the present state becomes the initial one.

    Entities get the ids 1, 2, … in slot order: polygons, circles, joints, thrusters. Joints and
    thrusters of bodies that are switched off have no effect and are left out.

    Args:
        scene: Arrays of one world, of any array library.
        name: Name of the new level.
        inertia_model: By which masses follow from shapes; where the arrays differ by more than
            1e-5, the body carries `mass_properties`.
        description: Text of the new level.
        tags: Tags of the new level.

    Raises:
        LevelError: The arrays hold something that no level can represent.
    """
    bare = dataclasses.replace(scene, state=dataclasses.replace(scene.state, cache=()))
    scene = jax.tree.map(np.asarray, bare)
    world = scene.world
    check_sayable(scene)
    capacity = capacity_of_world(world)
    references: dict[int, BodyReference] = dict(enumerate(ARENA_NAMES))
    bodies: list[Body] = []
    for slot in np.flatnonzero(world.bodies.active).tolist():
        if slot >= ARENA_BODIES:
            references[slot] = len(bodies) + 1
            bodies.append(_body_from(scene, slot, len(bodies) + 1, inertia_model))
    joints, thrusters, present = world.joints, world.thrusters, world.bodies.active
    ends_present = present[joints.body_a] & present[joints.body_b]
    hinges = np.flatnonzero(joints.active & ends_present).tolist()
    pushes = np.flatnonzero(thrusters.active & present[thrusters.body]).tolist()
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
            own = MassProperties(mass=1 / inverses[0], inertia=1 / inverses[1])
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
        motor=None if motor == NO_MOTOR else motor,
        limits=None if limits == NO_LIMITS else limits,
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
