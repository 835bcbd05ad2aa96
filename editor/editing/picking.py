"""Entities under a point or in a box, and the handles of a selection. Plain Python, no toolkit."""

import math
from collections.abc import Collection, Iterator, Mapping
from typing import Final

from editor.base.memoise import remembers
from editor.base.overlay import Handle, HandleKind
from kinetix.level.geometry import (
    arena_body,
    bounds,
    bounds_of,
    circle_about_middle,
    contains,
    inside_box,
    inverse_mass,
    joint_place,
    rotate,
    signed_distance,
    to_world,
    touches_box,
)
from kinetix.level.model import (
    ARENA_NAMES,
    Body,
    BodyReference,
    Circle,
    Joint,
    Level,
    Point,
    Thruster,
)

EntityId = int | str
Selection = tuple[EntityId, ...]
Rectangle = tuple[float, float, float, float]
"""Left, bottom, right, top [m]."""

JOINT_RADIUS: Final = 0.06
"""Half the width of a joint's mark [m]."""
THRUSTER_RADIUS: Final = 0.10
"""Half the width of a thruster's mark [m]."""
PICK_PIXELS: Final = 8.0
"""Whatever the zoom, a thing this near to the pointer is under it [px at 100 %]."""
HANDLE_PIXELS: Final = 7.0
"""Half the width of a handle's catch area [px at 100 %]."""
ROTATE_PIXELS: Final = 28.0
"""Distance of the rotation handle [px at 100 %]."""


def joint_position(level: Level, joint: Joint) -> Point:
    """Return the place at which a joint is drawn, by the rule of the renderer [m].

    Raises:
        KeyError: A body is missing.
    """
    on_a = to_world(_end(level, joint.a), joint.anchor_a)
    on_b = to_world(_end(level, joint.b), joint.anchor_b)
    return joint_place(on_a, on_b, end_masses(level, joint))


def end_masses(level: Level, joint: Joint) -> tuple[float, float]:
    """Inverse masses of the bodies of a joint [1/kg]; 0 of one that is fixed or missing."""
    masses = _inverse_masses(level)
    return masses.get(joint.a, 0.0), masses.get(joint.b, 0.0)


@remembers(4)
def _inverse_masses(level: Level) -> Mapping[BodyReference, float]:
    return {body.id: inverse_mass(body, level.inertia_model)[0] for body in level.bodies}


def _end(level: Level, reference: BodyReference) -> Body:
    """Return what `referenced_body` does, without a search: a frame asks for hundreds."""
    if isinstance(reference, str):
        return arena_body(level.arena, reference)
    return bodies_by_id(level)[reference]


@remembers(4)
def bodies_by_id(level: Level) -> Mapping[int, Body]:
    """Return the bodies by their ids."""
    return {body.id: body for body in level.bodies}


def thruster_position(level: Level, thruster: Thruster) -> Point:
    """Return the place of a thruster [m].

    Raises:
        KeyError: The thruster's body is missing.
    """
    return to_world(bodies_by_id(level)[thruster.body], thruster.position)


def reach(body: Body) -> float:
    """Return the radius of the circle about a body's origin that holds the body [m]."""
    if isinstance(body.shape, Circle):
        return body.shape.radius
    return max(math.hypot(x, y) for x, y in body.shape.vertices)


def _under(body: Body, point: Point, radius: float) -> bool:
    if math.dist(body.position, point) > reach(body) + radius:
        return False
    middle, _ = circle_about_middle(body.shape)
    return math.dist(to_world(body, middle), point) <= radius or contains(body, point)


def stack(
    level: Level,
    point: Point,
    radius: float,
    *,
    without: Collection[EntityId] = (),
    arena: bool = False,
) -> Selection:
    """Everything under a point, the uppermost first.

    The order is the drawing order from above: joints and thrusters (the nearest first), circles,
    polygons, then the arena.

    Args:
        level: Where to look.
        point: The pointer [m].
        radius: What eight pixels cover [m].
        without: Entities to pass over (locked or hidden).
        arena: Whether the arena bodies count.

    Returns:
        Ids and arena names.
    """
    found: list[tuple[tuple[int, float], EntityId]] = []
    for joint in level.joints:
        distance = _joint_distance(level, joint, point)
        if distance <= max(radius, JOINT_RADIUS):
            found.append(((0, distance), joint.id))
    for thruster in level.thrusters:
        distance = _thruster_distance(level, thruster, point)
        if distance <= max(radius, THRUSTER_RADIUS):
            found.append(((1, distance), thruster.id))
    for index, body in enumerate(level.bodies):
        if _under(body, point, radius):
            layer = 2 if isinstance(body.shape, Circle) else 3
            found.append(((layer, -index), body.id))
    around = ARENA_NAMES if arena else ()
    found += [((4, 0.0), n) for n in around if contains(arena_body(level.arena, n), point)]
    found.sort(key=lambda item: item[0])
    return tuple(entity for _, entity in found if entity not in without)


def _thruster_distance(level: Level, thruster: Thruster, point: Point) -> float:
    body = bodies_by_id(level).get(thruster.body)
    return math.inf if body is None else math.dist(to_world(body, thruster.position), point)


def _joint_distance(level: Level, joint: Joint, point: Point) -> float:
    bodies = bodies_by_id(level)
    known = all(isinstance(end, str) or end in bodies for end in (joint.a, joint.b))
    return math.dist(joint_position(level, joint), point) if known else math.inf


def bodies_at(
    level: Level,
    point: Point,
    *,
    without: Collection[EntityId] = (),
    arena: bool = True,
    margin: float = 0.0,
) -> Selection:
    """Return the bodies that contain a point, the uppermost first; the arena's last.

    Args:
        level: Where to look.
        point: The point [m].
        without: Bodies to pass over (locked or hidden).
        arena: Whether the arena bodies count.
        margin: How far outside of a body the point may lie [m].
    """
    circles = [b for b in level.bodies if isinstance(b.shape, Circle)]
    polygons = [b for b in level.bodies if not isinstance(b.shape, Circle)]
    drawn = [b for b in (*reversed(circles), *reversed(polygons)) if b.id not in without]
    found: list[EntityId] = [b.id for b in drawn if signed_distance(b, point) <= margin]
    if arena:
        around = {name: arena_body(level.arena, name) for name in ARENA_NAMES}
        found += [name for name in ARENA_NAMES if signed_distance(around[name], point) <= margin]
    return tuple(found)


def inside(
    level: Level,
    box: Rectangle,
    *,
    touching: bool,
    without: Collection[EntityId] = (),
) -> Selection:
    """Return the entities in a rubber band: those wholly inside, or also those that it touches."""
    test = touches_box if touching else inside_box
    found: list[EntityId] = [b.id for b in level.bodies if test(b, box)]
    for entity_id, place in _places(level):
        if box[0] <= place[0] <= box[2] and box[1] <= place[1] <= box[3]:
            found.append(entity_id)
    return tuple(entity for entity in found if entity not in without)


def _places(level: Level) -> Iterator[tuple[int, Point]]:
    known = {body.id for body in level.bodies}
    for joint in level.joints:
        if all(isinstance(end, str) or end in known for end in (joint.a, joint.b)):
            yield joint.id, joint_position(level, joint)
    for thruster in level.thrusters:
        if thruster.body in known:
            yield thruster.id, thruster_position(level, thruster)


def selected_bodies(level: Level, selection: Collection[EntityId]) -> tuple[Body, ...]:
    """Return the selected bodies in list order, without the arena's."""
    return tuple(body for body in level.bodies if body.id in selection)


def selection_box(level: Level, selection: Collection[EntityId]) -> Rectangle | None:
    """Box around what is selected, or None when nothing with a place is."""
    bodies = selected_bodies(level, selection)
    boxes = [bounds_of(bodies)] if bodies else []
    boxes += [(*place, *place) for i, place in _places(level) if i in selection]
    boxes += [bounds(arena_body(level.arena, n)) for n in ARENA_NAMES if n in selection]
    if not boxes:
        return None
    low, high = (min(b[0] for b in boxes), min(b[1] for b in boxes)), boxes
    return *low, max(b[2] for b in high), max(b[3] for b in high)


def handles(level: Level, selection: Selection, metres: float) -> tuple[Handle, ...]:
    """Return the handles of a selection.

    One circle has its radius; one rectangle or quadrilateral corners and edges in its own axes; one
    triangle its vertices; a thruster its direction; a group the corners of the box around it. All
    bodies have a handle to rotate.

    Args:
        level: Where the entities are.
        selection: What is selected.
        metres: Width of a pixel at 100 % [m].
    """
    bodies = selected_bodies(level, selection)
    if len(bodies) == 0:
        thrusters = [t for t in level.thrusters if t.id in selection]
        if len(thrusters) != 1 or len(selection) != 1:
            return ()
        return (_aim_handle(level, thrusters[0], metres),)
    if len(bodies) > 1:
        left, bottom, right, top = bounds_of(bodies)
        corners = ((left, bottom), (right, bottom), (right, top), (left, top))
        above = ((left + right) / 2, top + ROTATE_PIXELS * metres)
        scale = (Handle(kind=HandleKind.SCALE, at=at, index=i) for i, at in enumerate(corners))
        return (Handle(kind=HandleKind.ROTATE, at=above), *scale)
    (body,) = bodies
    return _single_handles(body, metres)


def _single_handles(body: Body, metres: float) -> tuple[Handle, ...]:
    if isinstance(body.shape, Circle):
        radius = body.shape.radius
        above = to_world(body, (0.0, radius + ROTATE_PIXELS * metres))
        return (
            Handle(kind=HandleKind.ROTATE, at=above),
            Handle(kind=HandleKind.RADIUS, at=to_world(body, (radius, 0.0))),
        )
    vertices = body.shape.vertices
    left, right = min(x for x, _ in vertices), max(x for x, _ in vertices)
    bottom, top = min(y for _, y in vertices), max(y for _, y in vertices)
    above = to_world(body, ((left + right) / 2, top + ROTATE_PIXELS * metres))
    rotate_handle = Handle(kind=HandleKind.ROTATE, at=above)
    if len(vertices) == 3:
        return (
            rotate_handle,
            *(
                Handle(kind=HandleKind.VERTEX, at=to_world(body, vertex), index=i)
                for i, vertex in enumerate(vertices)
            ),
        )
    corners = ((left, bottom), (right, bottom), (right, top), (left, top))
    middle = ((left + right) / 2, (bottom + top) / 2)
    edges = (
        (HandleKind.SCALE_Y, (middle[0], bottom)),
        (HandleKind.SCALE_X, (right, middle[1])),
        (HandleKind.SCALE_Y, (middle[0], top)),
        (HandleKind.SCALE_X, (left, middle[1])),
    )
    return (
        rotate_handle,
        *(
            Handle(kind=HandleKind.SCALE, at=to_world(body, at), index=i)
            for i, at in enumerate(corners)
        ),
        *(Handle(kind=kind, at=to_world(body, at), index=i) for i, (kind, at) in enumerate(edges)),
    )


def _aim_handle(level: Level, thruster: Thruster, metres: float) -> Handle:
    body = level.body(thruster.body)
    x, y = to_world(body, thruster.position)
    dx, dy = rotate((2 * ROTATE_PIXELS * metres, 0.0), body.angle + thruster.angle)
    return Handle(kind=HandleKind.AIM, at=(x + dx, y + dy))


def pick_handle(candidates: Collection[Handle], point: Point, radius: float) -> Handle | None:
    """Return the handle under a point: the nearest within `radius` [m], or None."""
    near = [(math.dist(h.at, point), i, h) for i, h in enumerate(candidates)]
    near = [item for item in near if item[0] <= radius]
    return min(near)[2] if near else None
