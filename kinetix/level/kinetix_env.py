"""The peer's level JSON (kinetix-env 3): reading, writing, and the way to and from our documents.

With `kinetix_env_schema` beside it, the only code that knows this format. Source: level_format.md
parts A and C.
"""

import contextlib
import dataclasses
import json
import math
from collections.abc import Sequence
from typing import Any, Final

import msgspec
import numpy as np

from kinetix.engine.pairs import collision_matrix, pair_counts
from kinetix.engine.spec import ARENA_BODIES, Capacity
from kinetix.errors import LevelError
from kinetix.level.canonical import record_tree
from kinetix.level.faults import EnoughFaults, FaultCollector, bounds_text, fail
from kinetix.level.geometry import (
    STANDARD_ARENA,
    arena_bodies,
    inverse_mass,
    reverse_winding,
    rotate,
    same_geometry,
    same_masses,
    shape_mass,
)
from kinetix.level.integrity import level_faults
from kinetix.level.json_text import DuplicateKeys, parse_json
from kinetix.level.kinetix_env_schema import (
    ENV_PARAMS,
    VERTEX_ROWS,
    KinetixBody,
    KinetixContact,
    KinetixJoint,
    KinetixThruster,
    read_array,
    read_contacts,
    read_parameters,
    read_point,
    read_rows,
    read_static,
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
    round_real,
)
from kinetix.level.schema import check_tree
from kinetix.level.sizes import capacity_of, size_hint, size_name
from kinetix.level.slots import body_slots

STANDARD_GRAVITY: Final = (0.0, round_real(-9.81))
"""What the peer's reader always uses, whatever a file says [m/s²]."""

_CACHE_TOLERANCE: Final = 1e-3
"""Difference above which a cached anchor is no mere rounding [m]."""

# Native names of fields (in paths of faults) and what the peer calls them.
_PEER_NAMES: Final = {
    "angle": "rotation",
    "reference_angle": "rotation",
    "shape.vertices": "vertices",
    "shape.radius": "radius",
    "mass_properties.mass": "inverse_mass",
    "mass_properties.inertia": "inverse_inertia",
    "anchor_a": "a_relative_pos",
    "anchor_b": "b_relative_pos",
    "a": "a_index",
    "b": "b_index",
    "motor.speed": "motor_speed",
    "motor.power": "motor_power",
    "motor.binding": "motor_binding",
    "limits.min": "min_rotation",
    "limits.max": "max_rotation",
    "binding": "thruster_binding",
    "geometry.vertices": "vertices",
    "geometry.position": "position",
}


@dataclasses.dataclass(frozen=True, kw_only=True, eq=False)
class KinetixEnvDocument:
    """A file of the peer: its text, byte for byte, and its content slot by slot."""

    file: str
    """Where it came from, for messages."""
    text: str
    """The file as it was read; writing this again changes nothing."""
    polygons: tuple[KinetixBody, ...]
    circles: tuple[KinetixBody, ...]
    joints: tuple[KinetixJoint, ...]
    thrusters: tuple[KinetixThruster, ...]
    polygon_contacts: tuple[KinetixContact, ...]
    """Two for each polygon pair: entries 2i and 2i+1."""
    circle_polygon_contacts: tuple[KinetixContact, ...]
    circle_contacts: tuple[KinetixContact, ...]
    gravity: tuple[float, float]
    """As the file says; the standard one where it says nothing [m/s²]."""
    parameters: dict[str, Any]
    """The block `env_params`."""
    static: dict[str, Any]
    """The block `static_env_params`."""

    @property
    def capacity(self) -> Capacity:
        """How many slots the file has."""
        return Capacity(
            polygons=len(self.polygons),
            circles=len(self.circles),
            joints=len(self.joints),
            thrusters=len(self.thrusters),
        )

    @property
    def bodies(self) -> tuple[KinetixBody, ...]:
        """All bodies in global order: polygons, then circles."""
        return self.polygons + self.circles


def parse_kinetix_env(text: str, file: str = "text") -> KinetixEnvDocument:
    """Read a level of the peer, checking keys, types, lengths, finiteness and indices.

    Args:
        text: The JSON text.
        file: Name for messages.

    Raises:
        LevelError: The text is bad; the sentence has file and JSON path.
    """
    return document_from_tree(parse_json(text, file), text, file)


def document_from_tree(tree: Any, text: str, file: str) -> KinetixEnvDocument:
    """Like `parse_kinetix_env`, for text that has been parsed already.

    Raises:
        LevelError: The content is bad; the sentence has file and JSON path.
    """
    faults = FaultCollector()
    document = None
    with contextlib.suppress(EnoughFaults):
        document = _read_document(tree, text, file, faults)
    if faults.faults or document is None:
        fail(file, faults.faults)
    return document


def _read_document(
    tree: Any, text: str, file: str, faults: FaultCollector
) -> KinetixEnvDocument | None:
    if not isinstance(tree, dict) or not isinstance(tree.get("env_state"), dict):
        faults.add("E002", "$", 'expected an object with the key "env_state"')
        return None
    for path, part in (("$", tree), ("$.env_state", tree["env_state"])):
        if isinstance(part, DuplicateKeys):
            faults.add("E005", f"{path}.{part.key[:60]}", "the key stands twice")
    for name in ("env_params", "static_env_params"):
        if name not in tree:
            faults.add("E004", "$", f'the key "{name}" is missing')
    if faults.faults:
        return None
    static = read_static(tree["static_env_params"], "$.static_env_params", faults)
    parameters = read_parameters(tree["env_params"], "$.env_params", faults)
    if faults.faults:
        return None
    state = tree["env_state"]
    capacity = Capacity(
        polygons=static["num_polygons"],
        circles=static["num_circles"],
        joints=static["num_joints"],
        thrusters=static["num_thrusters"],
    )
    content = _read_state(state, capacity, faults)
    if content is None:
        return None
    made = KinetixEnvDocument(file=file, text=text, parameters=parameters, static=static, **content)
    _check_rows(made, faults)
    return made


_STATE_KEYS = (
    "polygon",
    "circle",
    "joint",
    "thruster",
    "collision_matrix",
    "acc_rr_manifolds",
    "acc_cr_manifolds",
    "acc_cc_manifolds",
)


def _read_state(
    state: dict[str, Any], capacity: Capacity, faults: FaultCollector
) -> dict[str, Any] | None:
    path = "$.env_state"
    for name in _STATE_KEYS:
        if name not in state:
            faults.add("E004", path, f'the key "{name}" is missing')
    for name in state:
        if name not in _STATE_KEYS and name != "gravity":
            faults.add("E005", f"{path}.{name[:60]}", "unknown key")
    if faults.faults:
        return None
    rr, cr, cc = pair_counts(capacity)
    matrix = read_array(state["collision_matrix"], f"{path}.collision_matrix", faults)
    if matrix is not None and len(matrix) < capacity.bodies:
        faults.expect(
            "E007", f"{path}.collision_matrix", f"an array of at least {capacity.bodies}", matrix
        )
    gravity = state.get("gravity", list(STANDARD_GRAVITY))
    return {
        "polygons": read_rows(
            state["polygon"], KinetixBody, capacity.polygons, f"{path}.polygon", faults
        ),
        "circles": read_rows(
            state["circle"], KinetixBody, capacity.circles, f"{path}.circle", faults
        ),
        "joints": read_rows(state["joint"], KinetixJoint, capacity.joints, f"{path}.joint", faults),
        "thrusters": read_rows(
            state["thruster"], KinetixThruster, capacity.thrusters, f"{path}.thruster", faults
        ),
        "polygon_contacts": read_contacts(
            state["acc_rr_manifolds"], 2 * rr, f"{path}.acc_rr_manifolds", faults
        ),
        "circle_polygon_contacts": read_contacts(
            state["acc_cr_manifolds"], cr, f"{path}.acc_cr_manifolds", faults
        ),
        "circle_contacts": read_contacts(
            state["acc_cc_manifolds"], cc, f"{path}.acc_cc_manifolds", faults
        ),
        "gravity": read_point(gravity, f"{path}.gravity", faults),
    }


def _check_rows(document: KinetixEnvDocument, faults: FaultCollector) -> None:
    """Ranges of numbers that stand for something else, in rows that are in use."""
    ranges = (("role", 0, len(ROLES) - 1), ("collision_mode", 0, len(COLLISIONS) - 1))
    corners = ("n_vertices", 3, VERTEX_ROWS)
    for kind, rows, limits in (
        ("polygon", document.polygons, (*ranges, corners)),
        ("circle", document.circles, ranges),
    ):
        for k, body in enumerate(rows):
            for name, low, high in limits:
                value = getattr(body, name)
                if body.active and not low <= value <= high:
                    path = f"$.env_state.{kind}[{k}].{name}"
                    faults.expect("E007", path, bounds_text(low, high), value)
    for kind, rows, names, channels in (
        ("joint", document.joints, ("a_index", "b_index"), "motor_binding"),
        ("thruster", document.thrusters, ("object_index",), "thruster_binding"),
    ):
        for k, row in enumerate(rows):
            if row.active:
                _check_links(document, row, (*names, channels), f"$.env_state.{kind}[{k}]", faults)


def _check_links(
    document: KinetixEnvDocument,
    row: KinetixJoint | KinetixThruster,
    names: tuple[str, ...],
    path: str,
    faults: FaultCollector,
) -> None:
    """Indices of bodies, and the number of the action channel (the last name), of one row."""
    *indices, channel = names
    bodies = document.bodies
    for name, count in [(name, len(bodies)) for name in indices] + [
        (channel, document.static[f"num_{channel}s"])
    ]:
        value = getattr(row, name)
        if not 0 <= value < count:
            faults.expect("E007", f"{path}.{name}", f"0 ≤ x < {count}", value)
        elif name in indices and not bodies[value].active:
            faults.add("E009", f"{path}.{name}", f"expected a body in use, got slot {value}")


def to_level(document: KinetixEnvDocument, *, name: str) -> tuple[Level, tuple[str, ...]]:
    """A document of ours from a file of the peer.

    Args:
        document: What was read.
        name: The level's name; by convention the file's stem.

    Returns:
        The level, and one sentence for each kind of content that it does not carry.

    Raises:
        LevelError: The file holds something that our format cannot say.
    """
    faults = FaultCollector()
    level, places = None, {}
    with contextlib.suppress(EnoughFaults):
        level, places = _import_level(document, name, faults)
        ranges = FaultCollector()
        with contextlib.suppress(EnoughFaults):
            check_tree(record_tree(level), Level, "$", ranges)
        for fault in ranges.faults or level_faults(level):
            faults.add(fault.code, _peer_path(fault.path, places), fault.message)
    if faults.faults or level is None:
        fail(document.file, faults.faults)
    return level, tuple(_import_warnings(document))


def _import_level(
    document: KinetixEnvDocument, name: str, faults: FaultCollector
) -> tuple[Level, dict[str, str]]:
    places: dict[str, str] = {}
    references: dict[int, BodyReference] = dict(enumerate(ARENA_NAMES))
    bodies: list[Body] = []
    for index, row in enumerate(document.bodies):
        if index < ARENA_BODIES or not row.active:
            continue
        kind, slot = _collection(document, index)
        path = f"$.env_state.{kind}[{slot}]"
        places[f"$.bodies[{len(bodies)}]"] = path
        references[index] = len(bodies) + 1
        bodies.append(_import_body(row, len(bodies) + 1, path, faults, circle=kind == "circle"))
    next_id = len(bodies) + 1
    joints: list[Joint] = []
    for slot, row in enumerate(document.joints):
        if row.active:
            places[f"$.joints[{len(joints)}]"] = f"$.env_state.joint[{slot}]"
            joints.append(_import_joint(row, next_id, references))
            next_id += 1
    thrusters: list[Thruster] = []
    for slot, row in enumerate(document.thrusters):
        if not row.active:
            continue
        path = f"$.env_state.thruster[{slot}]"
        places[f"$.thrusters[{len(thrusters)}]"] = path
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
    for slot, arena_name in enumerate(ARENA_NAMES):
        places[f"$.arena.{arena_name}"] = f"$.env_state.polygon[{slot}]"
    level = Level(
        name=name,
        size=size_name(document.capacity) or size_hint(document.capacity),
        gravity=document.gravity,
        max_timesteps=document.parameters["max_timesteps"],
        inertia_model="kinetix",
        arena=_import_arena(document, faults),
        next_id=next_id,
        bodies=tuple(bodies),
        joints=tuple(joints),
        thrusters=tuple(thrusters),
    )
    return level, places


def _collection(document: KinetixEnvDocument, index: int) -> tuple[str, int]:
    polygons = len(document.polygons)
    return ("polygon", index) if index < polygons else ("circle", index - polygons)


def _import_body(
    row: KinetixBody, body_id: int, path: str, faults: FaultCollector, *, circle: bool
) -> Body:
    shape = (
        Circle(radius=row.radius)
        if circle
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
        derived = shape_mass(shape, row.density, "kinetix")
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
            faults.expect("E007", f"{path}.active", "true for a body of the arena", value=False)
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


def _peer_path(path: str, places: dict[str, str]) -> str:
    """The place in the peer's file that a path in the imported level came from."""
    for ours, theirs in places.items():
        if path == ours or path.startswith(f"{ours}."):
            field = path[len(ours) + 1 :]
            stem = field.split("[")[0]
            renamed = _PEER_NAMES.get(stem, stem) + field[len(stem) :]
            return f"{theirs}.{renamed}" if field else theirs
    return {"$.max_timesteps": "$.env_params.max_timesteps"}.get(
        path, path.replace("$.gravity", "$.env_state.gravity")
    )


def _import_warnings(document: KinetixEnvDocument) -> list[str]:
    """One sentence for each kind of content that a document of ours does not carry."""
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
    """Whether an unused slot holds what we or an expansion by the peer would write there."""
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
            place = _joint_position(
                (a, joint.a_relative_pos, a.inverse_mass), (b, joint.b_relative_pos, b.inverse_mass)
            )
            if math.dist(place, joint.global_position) > _CACHE_TOLERANCE:
                return True
    return any(
        math.dist(_anchor(bodies[t.object_index], t.relative_position), t.global_position)
        > _CACHE_TOLERANCE
        for t in document.thrusters
        if t.active
    )


def from_level(level: Level, *, stem: str | None = None) -> tuple[str, tuple[str, ...]]:
    """The peer's JSON text for a level, and what that text cannot say.

    Args:
        level: The document.
        stem: The file's name without suffix, which is all the name that the peer knows.

    Returns:
        The text, and the names of the fields that the peer loses.

    Raises:
        LevelError: The level does not fit its own size, or refers to a missing body.
    """
    capacity = capacity_of(level)
    faults = [fault for fault in level_faults(level) if fault.code in ("E009", "E011", "E013")]
    if faults:
        raise LevelError(f"level {level.name!r} cannot be written for the peer: {faults[0]}")
    return dump_tree(_export_tree(level, capacity)), lost_fields(level, stem=stem)


def lost_fields(level: Level, *, stem: str | None = None) -> tuple[str, ...]:
    """What the peer's file cannot say, or its reader ignores, of a level.

    Args:
        level: The document.
        stem: The name of the file to be written, without suffix.
    """
    told = (
        (any(j.motor and j.motor.auto for j in level.joints), "automatic motors"),
        (level.gravity != STANDARD_GRAVITY, "gravity"),
        (level.max_timesteps != ENV_PARAMS["max_timesteps"], "max_timesteps"),
        (stem is not None and level.name != stem, "name"),
        (bool(level.description), "description"),
        (bool(level.tags), "tags"),
        (level.solution is not None, "solution"),
    )
    return tuple(what for applies, what in told if applies)


def dump_tree(tree: Any) -> str:
    """A tree as JSON text the way the peer writes it: one line, no newline at the end."""
    return json.dumps(tree)


def _keyed(values: Sequence[Any]) -> dict[str, Any]:
    """An array in the peer's form: an object with decimal keys."""
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
        collision_mode=COLLISIONS.index(body.collision),
        active=True,
        n_vertices=len(vertices),
        vertices=vertices + ((0.0, 0.0),) * (VERTEX_ROWS - len(vertices)),
        radius=radius,
        role=ROLES.index(body.role),
        density=body.density,
    )


def _anchor(body: KinetixBody, local: tuple[float, float]) -> tuple[float, float]:
    x, y = rotate(local, body.rotation)
    return round_real(body.position[0] + x), round_real(body.position[1] + y)


_End = tuple[KinetixBody, tuple[float, float], float]


def _joint_position(a: _End, b: _End) -> tuple[float, float]:
    """World place of a joint: a fixed body's anchor counts, else the inverse-mass weighted mean."""
    (body_a, local_a, weight_a), (body_b, local_b, weight_b) = a, b
    place_a, place_b = _anchor(body_a, local_a), _anchor(body_b, local_b)
    if weight_a == 0:
        return place_a
    if weight_b == 0:
        return place_b
    total = weight_a + weight_b
    x, y = (
        round_real((weight_a * p + weight_b * q) / total)
        for p, q in zip(place_a, place_b, strict=True)
    )
    return x, y


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
        global_position=_joint_position(
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
        global_position=_anchor(bodies[index], thruster.position),
        active=True,
        thruster_binding=thruster.binding,
    )
