"""Problems of a level as a whole: what `kinetix validate` and the editor's problem list show.

README.md lists the codes. Nothing here prevents saving. A level of 50
entities takes well below 5 ms, so that the list can follow every edit.
"""

import contextlib
import dataclasses
import functools
import math
from collections.abc import Iterator
from typing import Final, Literal

import numpy as np

from kinetix.engine.pairs import touching_points
from kinetix.engine.spec import ARENA_BODIES
from kinetix.level.canonical import record_tree
from kinetix.level.faults import EnoughFaults, FaultCollector
from kinetix.level.geometry import (
    ARENA_WIDTH,
    arena_bodies,
    bounds,
    extent,
    overlap_depth,
    polygon_fault,
    to_world,
)
from kinetix.level.graph import components, may_push, modes_meet
from kinetix.level.integrity import centre_fault, entity_paths
from kinetix.level.model import (
    ARENA_NAMES,
    MOTOR_BINDINGS,
    THRUSTER_BINDINGS,
    Arena,
    Body,
    BodyReference,
    Entity,
    Geometry,
    Joint,
    Level,
    Polygon,
    Record,
    Thruster,
)
from kinetix.level.schema import check_tree
from kinetix.level.sizes import capacity_of, describe_capacity, needed_capacity, shortages

Severity = Literal["error", "warning", "info"]

TOUCH_SLOP: Final = 5e-3
"""Two bodies that can push each other count as touching up to this distance [m]."""
OVERLAP_TOLERANCE: Final = 0.01
"""Overlap that no solver notices: the published levels' slop [m]."""
MOST_OVERLAPS: Final = 200
"""Most pairs of overlapping bodies that are listed: a pile of hundreds has tens of thousands."""
ANCHOR_TOLERANCE: Final = 1e-3
"""Distance of a joint's anchors that counts as none [m]."""
MAX_SHAPE_SIZE: Final = 2.0
"""Largest extent of a shape in random levels [m]."""
_ROUNDING: Final = 1e-3


@dataclasses.dataclass(frozen=True, kw_only=True)
class Issue:
    """One problem of a level."""

    code: str
    severity: Severity
    path: str
    """JSON path of what it is about, `$` for the whole level."""
    message: str
    """One sentence for people."""
    ids: tuple[BodyReference, ...] = ()
    """The entities that it is about: ids, or names of arena bodies."""
    fix: str = ""
    """Label of the button that mends it; empty where nothing can be offered."""


@dataclasses.dataclass(frozen=True, kw_only=True)
class _Placed:
    """A body with what all checks of pairs need."""

    reference: BodyReference
    body: Body
    box: tuple[float, float, float, float]
    path: str


def validate(level: Level) -> tuple[Issue, ...]:
    """All static problems of a level, errors first, in the order of their codes."""
    issues = list(value_issues(level))
    # Geometry of numbers that are not finite, or of missing corners, means nothing.
    broken: set[BodyReference] = {reference for issue in issues for reference in issue.ids}
    for check in (_role_issues, _joint_reference_issues, _size_issues, _control_issues):
        issues += check(level)
    placed = _placed_bodies(level, broken)
    issues += _joint_issues(level, placed, broken)
    issues += _pair_issues(level, placed)
    issues += _place_issues(placed)
    return tuple(sorted(issues, key=lambda issue: issue.code))


def has_errors(issues: tuple[Issue, ...]) -> bool:
    """Return whether any of the issues is an error."""
    return any(issue.severity == "error" for issue in issues)


def _issue(
    code: str, message: str, *, path: str = "$", ids: tuple[BodyReference, ...] = (), fix: str = ""
) -> Issue:
    severities: dict[str, Severity] = {"E": "error", "W": "warning"}
    return Issue(
        code=code, severity=severities[code[0]], path=path, message=message, ids=ids, fix=fix
    )


def describe(reference: BodyReference, entity: Entity | None = None) -> str:
    """Return its own name, or what it is: `green circle 4`, `weld 8`, `the left wall`."""
    if isinstance(reference, str):
        return f"the {reference.replace('_', ' ')}"
    if entity is not None and entity.name:
        return entity.name
    kind = "entity"
    if isinstance(entity, Body):
        kind = _shape_word(entity)
    elif isinstance(entity, Joint):
        kind = "weld" if entity.kind == "fixed" else "joint"
    elif isinstance(entity, Thruster):
        kind = "thruster"
    return f"{kind} {reference}"


def _shape_word(body: Body) -> str:
    """Role and shape; any four corners are called a rectangle."""
    noun = "circle"
    if isinstance(body.shape, Polygon):
        noun = "triangle" if len(body.shape.vertices) == 3 else "rectangle"
    return noun if body.role == "none" else f"{body.role} {noun}"


def _capital(text: str) -> str:
    return text[:1].upper() + text[1:]


def _placed_bodies(level: Level, broken: set[BodyReference]) -> list[_Placed]:
    """The bodies that have a place, the arena's first."""
    listed: list[tuple[BodyReference, Body, str]] = [
        (name, body, f"$.arena.{name}")
        for name, body in zip(ARENA_NAMES, arena_bodies(level.arena), strict=True)
    ]
    listed += [(body.id, body, f"$.bodies[{k}]") for k, body in enumerate(level.bodies)]
    return [
        _Placed(reference=reference, body=body, box=bounds(body), path=path)
        for reference, body, path in listed
        if reference not in broken
    ]


# Entities are immutable, so what is wrong with one by itself is found once.
@functools.lru_cache(maxsize=4096)
def _own_faults(entity: Record) -> tuple[tuple[str, str, str], ...]:
    """Faults of a record's own values as (code, path within it, sentence)."""
    found: list[tuple[str, str, str]] = []
    faults = FaultCollector()
    with contextlib.suppress(EnoughFaults):
        check_tree(record_tree(entity), type(entity), "", faults)
    for fault in faults.faults:
        # Bindings have E110; a wrong number of corners has E107.
        if not fault.path.endswith(("binding", ".vertices")):
            found.append(("E106", fault.path, f"{fault.path[1:]}: {fault.message}"))
    for name in ("shape", "geometry"):
        shape = getattr(entity, name, None)
        reason = isinstance(shape, (Polygon, Geometry)) and polygon_fault(shape.vertices)
        if reason and not found:
            found.append(("E107", f".{name}.vertices", reason))
    return tuple(found)


def value_issues(level: Level) -> Iterator[Issue]:
    """Yield the problems of values by themselves: what no file could hold."""
    frame = level.replace(bodies=(), joints=(), thrusters=(), arena=Arena(), next_id=1)
    for code, inner, message in _own_faults(frame):
        yield _issue(code, f"Level: {message}.", path=f"${inner}")
    for arena_name in ARENA_NAMES:
        part = getattr(level.arena, arena_name)
        for code, inner, message in _own_faults(part):
            path = f"$.arena.{arena_name}{inner}"
            sentence = f"{_capital(describe(arena_name))}: {message}."
            yield _issue(code, sentence, path=path, ids=(arena_name,))
    for path, entity in entity_paths(level):
        name = _capital(describe(entity.id, entity))
        for code, inner, message in _own_faults(entity):
            fix = "Fix order" if code == "E107" else ""
            yield _issue(code, f"{name}: {message}.", path=path + inner, ids=(entity.id,), fix=fix)
        if isinstance(entity, Body) and not _own_faults(entity):
            off_centre = centre_fault(entity, level.inertia_model)
            if off_centre:
                where, message = f"{path}.shape.vertices", f"{name}: {off_centre}."
                yield _issue("E107", message, path=where, ids=(entity.id,), fix="Recentre")
        if isinstance(entity, Joint) and entity.motor:
            yield from _binding_issues(
                entity, entity.motor.binding, MOTOR_BINDINGS, f"{path}.motor.binding"
            )
        if isinstance(entity, Thruster):
            yield from _binding_issues(entity, entity.binding, THRUSTER_BINDINGS, f"{path}.binding")


def _binding_issues(entity: Entity, binding: int, count: int, path: str) -> Iterator[Issue]:
    if not 0 <= binding < count:
        name = describe(entity.id, entity)
        message = f"Binding {binding} of {name} is out of range 0–{count - 1}."
        yield _issue("E110", message, path=path, ids=(entity.id,), fix="Use binding 0")


def _role_issues(level: Level) -> Iterator[Issue]:
    holders: dict[str, list[BodyReference]] = {"green": [], "blue": [], "red": [], "none": []}
    fixed: dict[str, bool] = {"green": True, "blue": True}
    for name in ARENA_NAMES:
        holders[getattr(level.arena, name).role].append(name)
    for body in level.bodies:
        holders[body.role].append(body.id)
        if body.role in fixed:
            fixed[body.role] = fixed[body.role] and body.fixed
    green, blue = holders["green"], holders["blue"]
    if not green:
        message = "No green shape: the level cannot be won."
        yield _issue("E101", message, fix="Make selected green")
    if not blue:
        yield _issue("E102", "No blue shape: nothing to reach.", fix="Make selected blue")
    if len(green) > 1 or len(blue) > 1:
        message = (
            f"{len(green)} green and {len(blue)} blue shapes; expected exactly one each "
            f"(true of all published levels)."
        )
        yield _issue("E103", message, ids=(*green, *blue), fix="Keep first")
    if green and blue and all(fixed.values()):
        message = "Green and blue are both fixed: unwinnable unless another shape moves."
        yield _issue("W204", message, ids=(*green, *blue))


def _joint_reference_issues(level: Level) -> Iterator[Issue]:
    bodies = {body.id for body in level.bodies}
    for k, joint in enumerate(level.joints):
        missing = [r for r in (joint.a, joint.b) if isinstance(r, int) and r not in bodies]
        if missing or joint.a == joint.b:
            what = "missing" if missing else "identical"
            yield _issue(
                "E108",
                f"Joint {joint.id}: bodies {what}.",
                path=f"$.joints[{k}]",
                ids=(joint.id,),
                fix="Delete",
            )
    for k, thruster in enumerate(level.thrusters):
        if thruster.body not in bodies:
            yield _issue(
                "E108",
                f"Thruster {thruster.id}: body missing.",
                path=f"$.thrusters[{k}].body",
                ids=(thruster.id,),
                fix="Delete",
            )


def _size_issues(level: Level) -> Iterator[Issue]:
    for sentence in shortages(needed_capacity(level), capacity_of(level)):
        yield _issue("E109", sentence, path="$.size", fix="Choose the size automatically")


def _joint_issues(
    level: Level, placed: list[_Placed], broken: set[BodyReference]
) -> Iterator[Issue]:
    bodies = {each.reference: each.body for each in placed}
    for k, joint in enumerate(level.joints):
        path, a, b = f"$.joints[{k}]", bodies.get(joint.a), bodies.get(joint.b)
        if a is None or b is None or joint.a == joint.b or joint.id in broken:
            continue
        name = _capital(describe(joint.id, joint))
        if a.fixed and b.fixed:
            message = f"{name} between two fixed shapes has no effect."
            yield _issue("W207", message, path=path, ids=(joint.id,))
        gap = math.dist(to_world(a, joint.anchor_a), to_world(b, joint.anchor_b))
        if gap > ANCHOR_TOLERANCE:
            message = f"{name}: anchor mismatch {gap:.3g} m, will be pulled together."
            yield _issue("W209", message, path=path, ids=(joint.id,), fix="Re-anchor")
        if joint.kind == "revolute":
            yield from _limit_issues(joint, path)


def _limit_issues(joint: Joint, path: str) -> Iterator[Issue]:
    limits = joint.limits
    if limits is None or not limits.on:
        return
    path = f"{path}.limits"
    if limits.min > limits.max:
        message = f"Joint {joint.id}: the limits are swapped, min > max."
        yield _issue("W205", message, path=path, ids=(joint.id,), fix="Swap limits")
    elif limits.max - limits.min >= 2 * math.pi:
        message = f"Joint {joint.id}: the limits span 360° or more."
        yield _issue("W205", message, path=path, ids=(joint.id,), fix="Switch limits off")


def _control_issues(level: Level) -> Iterator[Issue]:
    controlled = False
    for k, joint in enumerate(level.joints):
        motor = joint.motor
        if motor is None or not motor.on or joint.kind == "fixed":
            continue
        idle = [name for name in ("speed", "power") if getattr(motor, name) == 0]
        if idle:
            message = f"{_capital(describe(joint.id, joint))}: motor {' and '.join(idle)} 0."
            yield _issue("W208", message, path=f"$.joints[{k}].motor", ids=(joint.id,))
        else:
            controlled = controlled or not motor.auto
    for k, thruster in enumerate(level.thrusters):
        if thruster.power == 0:
            message = f"{_capital(describe(thruster.id, thruster))}: power 0."
            path = f"$.thrusters[{k}].power"
            yield _issue("W208", message, path=path, ids=(thruster.id,))
        controlled = controlled or thruster.power > 0
    if not controlled:
        yield _issue("W201", "Nothing is controllable (no powered motor or thruster).")


def _pair_issues(level: Level, placed: list[_Placed]) -> Iterator[Issue]:
    component = components(level)
    capacity = capacity_of(level)
    room = touching_points(capacity.polygons - ARENA_BODIES, capacity.circles)
    contacts = overlaps = 0
    for a, b in _pairs_of_boxes(placed):
        enough = overlaps > MOST_OVERLAPS and contacts > room
        green = "green" in (a.body.role, b.body.role)
        if (enough and not green) or not modes_meet(a.body, b.body):
            continue
        pushing = may_push((a.reference, a.body), (b.reference, b.body), component)
        if not (pushing or green):
            continue
        depth = overlap_depth(a.body, b.body)
        if pushing and depth >= -TOUCH_SLOP:
            both = isinstance(a.body.shape, Polygon) and isinstance(b.body.shape, Polygon)
            contacts += 2 if both else 1
        yield from _touch_issues(a, b, depth, pushing=pushing)
        if pushing and depth > OVERLAP_TOLERANCE:
            overlaps += 1
            if overlaps <= MOST_OVERLAPS:
                yield _overlap_issue(a, b, depth)
    if overlaps > MOST_OVERLAPS:
        message = f"More shapes overlap than the {MOST_OVERLAPS} pairs that are listed."
        yield _issue("W202", message)
    yield from _crowd_issues(level, contacts, room)


def _pairs_of_boxes(placed: list[_Placed]) -> Iterator[tuple[_Placed, _Placed]]:
    """Return the pairs whose boxes meet, but for those of the arena, in order."""
    low, high = (
        np.array([each.box[part] for each in placed], float).reshape(-1, 2)
        for part in (slice(0, 2), slice(2, 4))
    )
    arena = np.array([isinstance(each.reference, str) for each in placed], bool)
    for index, each in enumerate(placed):
        rest = slice(index + 1, None)
        meets = (low[rest] <= high[index] + TOUCH_SLOP) & (low[index] <= high[rest] + TOUCH_SLOP)
        for later in np.flatnonzero(meets.all(axis=1) & ~(arena[rest] & arena[index])):
            yield each, placed[index + 1 + later]


def _crowd_issues(level: Level, contacts: int, room: int) -> Iterator[Issue]:
    if contacts > room:
        capacity = capacity_of(level)
        message = (
            f"Bodies overlap so much that {contacts} contact points or more meet at the start; "
            f"size {describe_capacity(capacity)} has room for {room}: some will be left out. Move "
            f"bodies apart."
        )
        yield _issue("W211", message)


def _touch_issues(a: _Placed, b: _Placed, depth: float, *, pushing: bool) -> Iterator[Issue]:
    roles = {a.body.role, b.body.role}
    ids = (a.reference, b.reference)
    path = b.path
    if depth >= -TOUCH_SLOP if pushing else depth > 0:
        if roles == {"green", "blue"}:
            message = "Green already touches blue at the start: solved at t=0."
            yield _issue("E104", message, path=path, ids=ids)
        if roles == {"green", "red"}:
            message = "Green already touches red at the start: lost at t=0."
            yield _issue("E105", message, path=path, ids=ids)


def _overlap_issue(a: _Placed, b: _Placed, depth: float) -> Issue:
    first, second = describe(a.reference, a.body), describe(b.reference, b.body)
    message = f"{_capital(first)} and {second} overlap by {depth:.3g} m and will be pushed apart."
    return _issue("W202", message, path=b.path, ids=(a.reference, b.reference))


def _place_issues(placed: list[_Placed]) -> Iterator[Issue]:
    for each in placed:
        if isinstance(each.reference, str):
            continue
        name = describe(each.reference, each.body)
        left, bottom, right, top = each.box
        if right <= 0 or top <= 0 or left >= ARENA_WIDTH or bottom >= ARENA_WIDTH:
            message = f"{_capital(name)} lies outside the arena."
            yield _issue("W203", message, path=f"{each.path}.position", ids=(each.reference,))
        size = extent(each.body.shape)
        if size > MAX_SHAPE_SIZE + _ROUNDING:
            message = (
                f"{_capital(name)} is larger than {MAX_SHAPE_SIZE:g} m: training generators will "
                f"not produce it."
            )
            yield _issue("W206", message, path=f"{each.path}.shape", ids=(each.reference,))
