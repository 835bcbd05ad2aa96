"""From kinetix-env's level JSON to our documents; README.md lists what is not carried."""

import contextlib
import math
from collections.abc import Sequence
from typing import Any, Final

import msgspec

from kinetix.engine.spec import ARENA_BODIES
from kinetix.level.canonical import record_tree
from kinetix.level.faults import EnoughFaults, Fault, FaultCollector, fail
from kinetix.level.geometry import (
    STANDARD_ARENA,
    polygon_fault,
    reverse_winding,
    same_geometry,
    same_masses,
    shape_mass,
)
from kinetix.level.integrity import level_faults
from kinetix.level.kinetix_env.document import KinetixEnvDocument
from kinetix.level.kinetix_env.export import joint_position, world_anchor
from kinetix.level.kinetix_env.json_paths import body_place, peer_path, peer_places
from kinetix.level.kinetix_env.mend import frames_model, with_centres
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
    Polygon,
    Thruster,
)
from kinetix.level.schema import check_tree
from kinetix.level.sizes import size_hint, size_name

_CACHE_TOLERANCE: Final = 1e-3
"""Difference above which a cached anchor is no mere rounding [m]."""


MENDED: Final = "W210"
"""Code of what was mended when a file of kinetix-env became a document."""


def to_level(
    document: KinetixEnvDocument, *, name: str
) -> tuple[Level, tuple[Fault, ...], tuple[str, ...]]:
    """Return a document of ours from a file of kinetix-env.

    Args:
        document: What was read.
        name: The level's name; by convention the file's stem.

    Returns:
        The level, what was mended in it, and one sentence for each kind of content that it does
        not carry.

    Raises:
        LevelError: The file holds something that our format cannot represent.
    """
    faults = FaultCollector()
    level, places = None, peer_places(document)
    mended: tuple[int, ...] = ()
    with contextlib.suppress(EnoughFaults):
        level = _import_level(document, name, faults)
        if not faults.faults and _are_polygons(level):
            level, mended = with_centres(level)
        ranges = FaultCollector()
        with contextlib.suppress(EnoughFaults):
            check_tree(record_tree(level), Level, "$", ranges)
        for fault in ranges.faults or level_faults(level):
            faults.add(fault.code, peer_path(fault.path, places), fault.message)
    if faults.faults or level is None:
        fail(document.file, faults.faults)
    told = [_mended(k, places) for k, body in enumerate(level.bodies) if body.id in mended]
    return level, tuple(told), tuple(_import_warnings(document))


def _are_polygons(level: Level) -> bool:
    """Return whether all corners make polygons; what does not is a fault."""
    shapes = [body.shape for body in level.bodies]
    return not any(isinstance(s, Polygon) and polygon_fault(s.vertices) for s in shapes)


def _mended(index: int, places: dict[str, str]) -> Fault:
    return Fault(
        code=MENDED,
        path=f"{places[f'$.bodies[{index}]']}.vertices",
        message="the frame's origin was not the centre of mass; it is now, and the shape "
        "is where it was",
    )


def _import_level(document: KinetixEnvDocument, name: str, faults: FaultCollector) -> Level:
    references: dict[int, BodyReference] = dict(enumerate(ARENA_NAMES))
    bodies: list[Body] = []
    model = frames_model(document)
    for index, row in enumerate(document.bodies):
        if index < ARENA_BODIES or not row.active:
            continue
        path = body_place(document, index)
        references[index] = len(bodies) + 1
        bodies.append(_import_body(row, len(bodies) + 1, path, faults, model))
    next_id = len(bodies) + 1
    joints: list[Joint] = []
    for row in document.joints:
        if row.active:
            joints.append(_import_joint(row, next_id, references))
            next_id += 1
    thrusters: list[Thruster] = []
    for slot, row in enumerate(document.thrusters):
        if not row.active:
            continue
        path = f"$.env_state.thruster[{slot}]"
        reference = references[row.object_index]
        if isinstance(reference, str):
            faults.add("E009", f"{path}.object_index", "a thruster on an arena body does nothing")
            continue
        thrusters.append(
            Thruster(
                id=next_id,
                body=reference,
                position=row.relative_position,
                angle=row.rotation,
                power=row.power,
                binding=row.thruster_binding,
            )
        )
        next_id += 1
    return Level(
        name=name,
        size=size_name(document.capacity) or size_hint(document.capacity),
        gravity=document.gravity,
        max_timesteps=document.parameters["max_timesteps"],
        inertia_model=model,
        arena=_import_arena(document, faults),
        next_id=next_id,
        bodies=tuple(bodies),
        joints=tuple(joints),
        thrusters=tuple(thrusters),
    )


def _import_body(
    row: KinetixBody, body_id: int, path: str, faults: FaultCollector, model: InertiaModel
) -> Body:
    shape = (
        Circle(radius=row.radius)
        if path.startswith("$.env_state.circle")
        else Polygon(vertices=reverse_winding(row.vertices[: row.n_vertices]))
    )
    stored = (row.inverse_mass, row.inverse_inertia)
    mass_properties = None
    if (stored[0] == 0) != (stored[1] == 0) or min(stored) < 0:
        faults.add(
            "E007",
            f"{path}.inverse_inertia",
            f"expected both or none of inverse_mass and inverse_inertia to be positive, "
            f"got {stored[0]:g} and {stored[1]:g}",
        )
    elif stored[0] > 0:
        derived = shape_mass(shape, row.density, model)
        if not same_masses(stored, derived):
            mass_properties = MassProperties(mass=1 / stored[0], inertia=1 / stored[1])
    return Body(
        id=body_id,
        shape=shape,
        position=row.position,
        angle=row.rotation,
        velocity=row.velocity,
        angular_velocity=row.angular_velocity,
        density=row.density,
        friction=row.friction,
        restitution=row.restitution,
        role=ROLES[row.role],
        fixed=stored == (0.0, 0.0),
        collision=COLLISIONS[row.collision_mode],
        mass_properties=mass_properties,
    )


def _import_joint(row: KinetixJoint, joint_id: int, references: dict[int, BodyReference]) -> Joint:
    motor: Motor | None = Motor(
        on=row.motor_on, speed=row.motor_speed, power=row.motor_power, binding=row.motor_binding
    )
    limits: Limits | None = Limits(
        on=row.motor_has_joint_limits, min=row.min_rotation, max=row.max_rotation
    )
    return Joint(
        id=joint_id,
        kind="fixed" if row.is_fixed_joint else "revolute",
        a=references[row.a_index],
        b=references[row.b_index],
        anchor_a=row.a_relative_pos,
        anchor_b=row.b_relative_pos,
        reference_angle=row.rotation,
        motor=None if motor == Motor(on=False) else motor,
        limits=None if limits == Limits(on=False) else limits,
    )


def _import_arena(document: KinetixEnvDocument, faults: FaultCollector) -> Arena:
    parts: dict[str, ArenaBody] = {}
    for slot, name in enumerate(ARENA_NAMES):
        row = document.polygons[slot]
        path = f"$.env_state.polygon[{slot}]"
        if not row.active:
            # Its other numbers mean nothing, and may be anything.
            faults.expect("E007", f"{path}.active", "true for a body of the arena", value=False)
            parts[name] = ArenaBody()
            continue
        for field in ("inverse_mass", "inverse_inertia", "rotation", "angular_velocity"):
            if getattr(row, field) != 0:
                faults.expect(
                    "E007", f"{path}.{field}", "0 for a body of the arena", getattr(row, field)
                )
        if row.velocity != (0.0, 0.0):
            faults.add("E007", f"{path}.velocity", "expected 0 for a body of the arena")
        count = min(max(row.n_vertices, 3), VERTEX_ROWS)
        geometry = Geometry(position=row.position, vertices=reverse_winding(row.vertices[:count]))
        parts[name] = ArenaBody(
            role=ROLES[row.role],
            friction=row.friction,
            restitution=row.restitution,
            density=row.density,
            collision=COLLISIONS[row.collision_mode],
            geometry=None if same_geometry(geometry, STANDARD_ARENA[name]) else geometry,
        )
    return Arena(**parts)


def _import_warnings(document: KinetixEnvDocument) -> list[str]:
    """Return one sentence for each kind of content that a document of ours does not carry."""
    movable = document.polygons[ARENA_BODIES:]
    hinges = [joint for joint in document.joints if joint.active]
    contacts = (
        document.polygon_contacts + document.circle_polygon_contacts + document.circle_contacts
    )
    unused = (
        [body for body in movable if not body.active and not _blank(body)]
        + [body for body in document.circles if not body.active and not _blank(body)]
        + [j for j in document.joints if not j.active and not _blank(j)]
        + [t for t in document.thrusters if not t.active and not _blank(t)]
    )
    parameters = {k: v for k, v in document.parameters.items() if k != "max_timesteps"}
    plain = {k: v for k, v in ENV_PARAMS.items() if k != "max_timesteps"}
    standard = static_env_params(document.capacity) | {"screen_dim": (500.0, 500.0)}
    other = [k for k, v in parameters.items() if v != plain[k]]
    other += [
        k
        for k, v in document.static.items()
        if v != standard[k] and not (k == "screen_dim" and v == {"0": 500, "1": 500})
    ]
    rows = (movable, document.circles, document.joints, document.thrusters)
    told = (
        (any(_has_gap(part) for part in rows), "gaps between slots"),
        (bool(unused), "what unused slots hold"),
        (any(body.highlighted for body in document.bodies), "highlights"),
        (any(contact != KinetixContact() for contact in contacts), "contacts"),
        (
            any(joint.acc_impulse != (0.0, 0.0) or joint.acc_r_impulse for joint in hinges),
            "accumulated impulses of joints",
        ),
        (_stale_caches(document), "cached positions of joints and thrusters"),
        (
            any(any(v != (0.0, 0.0) for v in c.vertices) for c in document.circles if c.active),
            "leftover vertices of circles",
        ),
        (
            any(body.radius for body in document.polygons if body.active),
            "leftover radii of polygons",
        ),
        (bool(other), f"the parameters {', '.join(other)}"),
    )
    return [f"not carried: {what}" for applies, what in told if applies]


def _blank(row: KinetixBody | KinetixJoint | KinetixThruster) -> bool:
    """Return whether an unused slot holds what we or kinetix-env write there."""
    values = msgspec.structs.asdict(row)
    defaults = msgspec.structs.asdict(type(row)())
    return all(
        value == defaults[name]
        or not value
        or value == ((0.0, 0.0),) * VERTEX_ROWS
        or (name == "n_vertices" and value == VERTEX_ROWS)
        or value == (0.0, 0.0)
        for name, value in values.items()
    )


def _has_gap(rows: Sequence[Any]) -> bool:
    used = [row.active for row in rows]
    return used != sorted(used, reverse=True)


def _stale_caches(document: KinetixEnvDocument) -> bool:
    bodies = document.bodies
    for joint in document.joints:
        if joint.active:
            a, b = bodies[joint.a_index], bodies[joint.b_index]
            place = joint_position(
                (a, joint.a_relative_pos, a.inverse_mass), (b, joint.b_relative_pos, b.inverse_mass)
            )
            if math.dist(place, joint.global_position) > _CACHE_TOLERANCE:
                return True
    return any(
        math.dist(world_anchor(bodies[t.object_index], t.relative_position), t.global_position)
        > _CACHE_TOLERANCE
        for t in document.thrusters
        if t.active
    )
