"""Resizing: corners and edges of one shape, a circle's rim, a triangle's vertices, a group."""

import math
from typing import Final

from editor.base.events import Pointer, PointerEvent
from editor.base.overlay import Cursor, Handle, HandleKind, Label
from editor.documents.commands.base import Command
from editor.documents.commands.group import Scale, SetVertices, Stretch
from editor.documents.commands.sizes import SIDE_MIN
from editor.editing.picking import selected_bodies
from editor.editing.snapping import apart_from, measured, snap_point
from editor.editing.tools.base import Feedback, Gesture, ToolContext
from editor.editing.tools.circle import RADIUS_MIN
from kinetix.level.geometry import bounds_of, to_local, to_world, world_vertices
from kinetix.level.limits import FARTHEST
from kinetix.level.model import Body, Circle, Point, Polygon

_ROUNDING: Final = 1e-5
"""So much less does a group grow than would take it to where a level ends."""
_SCALING: Final = (HandleKind.SCALE, HandleKind.SCALE_X, HandleKind.SCALE_Y)


def resize(session: ToolContext, handle: Handle) -> Gesture:
    """Drag a handle of the selection: Shift keeps proportions, Alt holds the centre."""
    bodies = list(selected_bodies(session.document.level, session.document.unlocked))
    ids = tuple(body.id for body in bodies)
    available, snapped = session.targets(ids), None
    if len(bodies) == 1 and handle.kind in _SCALING:
        available = apart_from(available, _opposite(bodies[0], handle))
    feedback = Feedback(cursor=Cursor.RESIZE)
    while True:
        event = yield feedback
        snapped = snap_point(event.world, session.rules(event.modifiers), available, snapped)
        if len(bodies) > 1:
            command, text = _scaled_group(bodies, handle, snapped.point, event)
        elif handle.kind is HandleKind.VERTEX:
            command, text = _moved_vertex(bodies[0], handle, snapped.point)
        elif isinstance(bodies[0].shape, Circle):
            command, text = _resized_circle(bodies[0], bodies[0].shape, snapped.point, event)
        else:
            command, text = _stretched(bodies[0], bodies[0].shape, handle, snapped.point, event)
        if event.kind is Pointer.RELEASE:
            return command
        marks = (*measured(snapped.guides), Label(at=snapped.point, text=text))
        feedback = Feedback(command=command, marks=marks, cursor=Cursor.RESIZE)


def _scaled_group(
    bodies: list[Body], handle: Handle, pointer: Point, event: PointerEvent
) -> tuple[Command, str]:
    left, bottom, right, top = bounds_of(bodies)
    corners = ((left, bottom), (right, bottom), (right, top), (left, top))
    pivot = corners[(handle.index + 2) % 4]
    if event.modifiers.alt:
        pivot = ((left + right) / 2, (bottom + top) / 2)
    corner = corners[handle.index]
    arm = (corner[0] - pivot[0], corner[1] - pivot[1])
    reach = (pointer[0] - pivot[0], pointer[1] - pivot[1])
    along = (arm[0] * reach[0] + arm[1] * reach[1]) / max(arm[0] ** 2 + arm[1] ** 2, 1e-12)
    least = max(_least_factor(body) for body in bodies)
    dragged = min(max(along, least), _greatest_factor(bodies, pivot))
    factor = event.typed[0] if event.typed else dragged
    ids = tuple(body.id for body in bodies)
    return Scale(ids=ids, factor=factor, pivot=pivot), f"× {factor:.2f}"


def _moved_vertex(body: Body, handle: Handle, pointer: Point) -> tuple[Command, str]:
    vertices = list(world_vertices(body))
    vertices[handle.index] = pointer
    command = SetVertices(body=body.id, vertices=tuple(vertices))
    return command, f"{pointer[0]:.2f}, {pointer[1]:.2f} m"


def _resized_circle(
    body: Body, shape: Circle, pointer: Point, event: PointerEvent
) -> tuple[Command, str]:
    dragged = max(math.dist(body.position, pointer), RADIUS_MIN)
    radius = event.typed[0] if event.typed else dragged
    factor = radius / shape.radius
    return Stretch(body=body.id, factors=(factor, factor)), f"radius {radius:.2f} m"


def _stretched(
    body: Body, shape: Polygon, handle: Handle, pointer: Point, event: PointerEvent
) -> tuple[Command, str]:
    low, high = _extent(shape)
    corner, axes = _grip(handle, low, high)
    centre = ((low[0] + high[0]) / 2, (low[1] + high[1]) / 2)
    opposite = (2 * centre[0] - corner[0], 2 * centre[1] - corner[1])
    hold = centre if event.modifiers.alt else opposite
    local = to_local(body, pointer)
    size = (high[0] - low[0], high[1] - low[1])
    factors = [1.0, 1.0]
    for k in axes:
        least = min(SIDE_MIN / size[k], 1.0)
        factors[k] = max((local[k] - hold[k]) / (corner[k] - hold[k]), least)
    typed = event.typed[: len(axes)]
    for k, value in zip(axes, typed, strict=False):
        factors[k] = value / size[k]
    if event.modifiers.shift and len(typed) < 2:
        # A typed width leads the height, a dragged one only where it is the larger.
        largest = factors[axes[0]] if typed else max(factors[k] for k in axes)
        factors = [largest, largest]
    text = f"{size[0] * factors[0]:.2f} × {size[1] * factors[1]:.2f} m"
    return Stretch(body=body.id, factors=(factors[0], factors[1]), hold=hold), text


def _least_factor(body: Body) -> float:
    """Return how far a shape may shrink: a level holds nothing smaller."""
    if isinstance(body.shape, Circle):
        return min(RADIUS_MIN / body.shape.radius, 1.0)
    low, high = _extent(body.shape)
    return min(SIDE_MIN / min(high[0] - low[0], high[1] - low[1]), 1.0)


def _greatest_factor(bodies: list[Body], pivot: Point) -> float:
    """Return how far a group may grow about a point: a level reaches no farther."""
    ways = [
        (math.copysign(FARTHEST, x - hold) - hold) / (x - hold)
        for body in bodies
        for x, hold in zip(body.position, pivot, strict=True)
        if x != hold
    ]
    return max(min(ways, default=math.inf) - _ROUNDING, 1.0)


def _extent(shape: Polygon) -> tuple[Point, Point]:
    """Return the least and the greatest x and y of the corners, in the body's frame [m]."""
    xs, ys = [x for x, _ in shape.vertices], [y for _, y in shape.vertices]
    return (min(xs), min(ys)), (max(xs), max(ys))


def _opposite(body: Body, handle: Handle) -> Point:
    """Return the point of a polygon's box that lies opposite a handle, in the world [m]."""
    assert isinstance(body.shape, Polygon)
    low, high = _extent(body.shape)
    (x, y), _ = _grip(handle, low, high)
    return to_world(body, (low[0] + high[0] - x, low[1] + high[1] - y))


def _grip(handle: Handle, low: Point, high: Point) -> tuple[Point, tuple[int, ...]]:
    """Return the dragged point of the box and the axes along which it resizes."""
    if handle.kind is HandleKind.SCALE:
        corners = (low, (high[0], low[1]), high, (low[0], high[1]))
        return corners[handle.index], (0, 1)
    middle = ((low[0] + high[0]) / 2, (low[1] + high[1]) / 2)
    edges = ((middle[0], low[1]), (high[0], middle[1]), (middle[0], high[1]), (low[0], middle[1]))
    return edges[handle.index], (1,) if handle.kind is HandleKind.SCALE_Y else (0,)
