"""Snapping: what a dragged point or body is drawn to, and the guides that show it.

Each axis snaps by itself to the nearest coordinate of interest; slanted edges catch corners as
points. A snap never moves anything further than its threshold.
"""

import bisect
import dataclasses
import itertools
import math
from collections.abc import Collection, Iterable, Sequence
from typing import Final

from editor.base.overlay import Label, Line, Style
from editor.editing.flush import flush
from kinetix.level.geometry import FLOOR_TOP, bounds, world_vertices
from kinetix.level.model import Body, Circle, Level, Point

CATCH_PIXELS: Final = 8.0
"""A target nearer than this catches [px at 100 %]."""
RELEASE_PIXELS: Final = 12.0
"""A target that has caught holds up to this [px at 100 %]."""
ARENA_X: Final = (0.0, 2.5, 5.0)
ARENA_Y: Final = (FLOOR_TOP, 2.5, 5.0)
"""Edges and middle of the playable square, the floor's surface below [m]."""
_SAME: Final = 1e-9
_GAP_NOISE: Final = 1e-4
"""Gaps that differ by less are equal [m]."""
Rectangle = tuple[float, ...]
"""Left, bottom, right, top [m]."""
_SHORTEST: Final = 0.1
"""Shorter guides have no length beside them [m]."""


@dataclasses.dataclass(frozen=True, kw_only=True)
class Coordinate:
    """Something to align with on one axis."""

    value: float
    """x or y [m]."""
    at: Point
    """The point that it belongs to, where its guide begins."""


@dataclasses.dataclass(frozen=True, kw_only=True)
class Targets:
    """Points and lines to snap to; made once per gesture."""

    x: tuple[Coordinate, ...]
    """Sorted by value."""
    y: tuple[Coordinate, ...]
    segments: tuple[tuple[Point, Point], ...]
    """Slanted edges."""
    boxes: tuple[tuple[float, float, float, float], ...]
    """Bounding boxes of the bodies, for equal spacing."""
    apart: Point | None = None
    """A point whose lines the grid leaves alone too."""


@dataclasses.dataclass(frozen=True, kw_only=True)
class Snapped:
    """Result of a snap."""

    point: Point
    """The snapped point, or the snapped shift of a body [m]."""
    guides: tuple[Line, ...] = ()
    held_x: float | None = None
    """The x that caught: the next snap of the gesture holds it longer."""
    held_y: float | None = None


@dataclasses.dataclass(frozen=True, kw_only=True)
class Rules:
    """Active snaps and their reach."""

    smart: bool
    """Centres, edges, vertices, arena and spacing."""
    grid: float | None
    """Width of the grid [m], or None for no grid."""
    catch: float
    """Distance at which a target catches [m]."""
    release: float
    """Distance at which a caught target lets go [m]."""


APART: Final = 0.015
"""Coordinates nearer than this to what must keep its distance catch nothing [m]."""
NO_SNAPPING: Final = Rules(smart=False, grid=None, catch=0.0, release=0.0)


def features(body: Body) -> tuple[Point, ...]:
    """The points of a body that others align with: centre, vertices, edge midpoints, quadrants."""
    if isinstance(body.shape, Circle):
        (x, y), r = body.position, body.shape.radius
        return (x, y), (x + r, y), (x, y + r), (x - r, y), (x, y - r)
    corners = world_vertices(body)
    middles = tuple(
        ((p[0] + q[0]) / 2, (p[1] + q[1]) / 2)
        for p, q in zip(corners, (*corners[1:], corners[0]), strict=True)
    )
    centre = (
        sum(x for x, _ in corners) / len(corners),
        sum(y for _, y in corners) / len(corners),
    )
    return (centre, *corners, *middles)


def targets(level: Level, moving: Collection[int | str] = ()) -> Targets:
    """Everything that the bodies which stay put and the arena offer."""
    resting = [body for body in level.bodies if body.id not in moving]
    points = [point for body in resting for point in features(body)]
    x = [Coordinate(value=p[0], at=p) for p in points]
    x += [Coordinate(value=value, at=(value, FLOOR_TOP)) for value in ARENA_X]
    y = [Coordinate(value=p[1], at=p) for p in points]
    y += [Coordinate(value=value, at=(0.0, value)) for value in ARENA_Y]
    return Targets(
        x=tuple(sorted(x, key=lambda c: c.value)),
        y=tuple(sorted(y, key=lambda c: c.value)),
        segments=tuple(_slanted(resting)),
        boxes=tuple(bounds(body) for body in resting),
    )


def _slanted(bodies: Iterable[Body]) -> Iterable[tuple[Point, Point]]:
    for body in bodies:
        corners = world_vertices(body)
        for p, q in zip(corners, (*corners[1:], *corners[:1]), strict=True):
            if abs(p[0] - q[0]) > 1e-3 and abs(p[1] - q[1]) > 1e-3:
                yield p, q


def snap_point(
    point: Point, rules: Rules, available: Targets, previous: Snapped | None = None
) -> Snapped:
    """Return where a single dragged point goes."""
    return _snap((point,), (point,), point, rules, available, previous)


def apart_from(available: Targets, point: Point) -> Targets:
    """Return the targets that do not lie on the lines through a point.

    A corner that snapped to the line on which the opposite corner lies would leave a shape of no
    width or height.

    Args:
        available: What to snap to.
        point: What must keep its distance on both axes.
    """
    return dataclasses.replace(
        available,
        x=tuple(c for c in available.x if abs(c.value - point[0]) > APART),
        y=tuple(c for c in available.y if abs(c.value - point[1]) > APART),
        apart=point,
    )


def straightened(point: Point, start: Point, rules: Rules) -> Point:
    """Return a point on the line through another where it lies next to it, else the point itself.

    A pointer stands on whole pixels: without this, what is drawn along a line would be a hair
    longer than the grid says.

    Args:
        point: What was snapped, apart from the lines through `start`.
        start: Where the gesture began.
        rules: What is on.
    """
    (x, y), (sx, sy) = point, start
    beside_x, beside_y = abs(x - sx) <= APART, abs(y - sy) <= APART
    if beside_x == beside_y or not (rules.smart or rules.grid):
        return point
    return (sx, y) if beside_x else (x, sy)


def snap_shift(
    bodies: Sequence[Body],
    shift: Point,
    rules: Rules,
    available: Targets,
    previous: Snapped | None = None,
) -> Snapped:
    """Return the shift of dragged bodies.

    Bounding-box edges, centre and vertices of the bodies are drawn to the targets; the grid takes
    the centre of the first body.

    Args:
        bodies: The bodies where they were before the drag.
        shift: How far the pointer has moved [m].
        rules: What is on.
        available: What to snap to.
        previous: The result of the gesture's last move, whose snap holds longer.

    Returns:
        The corrected shift and its guides.
    """
    if not bodies:
        return Snapped(point=shift)
    moved = [(x + shift[0], y + shift[1]) for body in bodies for x, y in features(body)]
    boxes = [bounds(body) for body in bodies]
    left, bottom = min(b[0] for b in boxes) + shift[0], min(b[1] for b in boxes) + shift[1]
    right, top = max(b[2] for b in boxes) + shift[0], max(b[3] for b in boxes) + shift[1]
    middle = ((left + right) / 2, (bottom + top) / 2)
    moved += [(left, middle[1]), (right, middle[1]), (middle[0], bottom), (middle[0], top), middle]
    x, y = bodies[0].position
    anchor = (x + shift[0], y + shift[1])
    box = (left, bottom, right, top)
    snapped = _snap(tuple(moved), (anchor,), anchor, rules, available, previous, box)
    return dataclasses.replace(snapped, point=(snapped.point[0] - x, snapped.point[1] - y))


def snap_angle(angle: float, step: float) -> float:
    """Return the nearest multiple of `step` [rad]."""
    return round(angle / step) * step


@dataclasses.dataclass(frozen=True, kw_only=True)
class _Catch:
    shift: float
    value: float
    start: Point | None
    """Start of the guide; None for the grid, which needs none."""
    feature: Point
    gaps: tuple[Line, ...] = ()
    """Equal gaps, shown instead of the guide."""


def _snap(
    points: tuple[Point, ...],
    grid_points: tuple[Point, ...],
    anchor: Point,
    rules: Rules,
    available: Targets,
    previous: Snapped | None,
    box: tuple[float, float, float, float] | None = None,
) -> Snapped:
    """Snap each axis; then, if neither caught, a corner to a slanted edge."""
    catches: list[_Catch | None] = []
    for axis, coordinates in ((0, available.x), (1, available.y)):
        held = None if previous is None else (previous.held_x, previous.held_y)[axis]
        catch = _aligned(points, axis, coordinates, rules, held) if rules.smart else None
        if catch is None and rules.smart and box is not None:
            catch = _spaced(box, axis, available.boxes, rules)
        catches.append(catch)
    if rules.smart and catches == [None, None]:
        slide = flush(points, available.segments, rules.catch)
        if slide is not None:
            return Snapped(point=(anchor[0] + slide[0], anchor[1] + slide[1]))
    if rules.grid is not None:
        for axis in (0, 1):
            if catches[axis] is None:
                catches[axis] = _gridded(grid_points, axis, rules, available.apart)
    dx, dy = (0.0 if catch is None else catch.shift for catch in catches)
    return Snapped(
        point=(anchor[0] + dx, anchor[1] + dy),
        guides=tuple(_guides(catches, (dx, dy))),
        held_x=None if catches[0] is None else catches[0].value,
        held_y=None if catches[1] is None else catches[1].value,
    )


def _aligned(
    points: tuple[Point, ...],
    axis: int,
    coordinates: tuple[Coordinate, ...],
    rules: Rules,
    held: float | None,
) -> _Catch | None:
    """Return the nearest coordinate to any of the points; one that is held reaches further."""
    values = [coordinate.value for coordinate in coordinates]
    best: tuple[float, _Catch] | None = None
    for point in points:
        low = bisect.bisect_left(values, point[axis] - rules.release)
        high = bisect.bisect_right(values, point[axis] + rules.release)
        for coordinate in coordinates[low:high]:
            shift = coordinate.value - point[axis]
            holds = held is not None and abs(coordinate.value - held) < _SAME
            if abs(shift) > (rules.release if holds else rules.catch):
                continue
            # What holds already wins over what is a little nearer: no flicker between two guides.
            cost = abs(shift) - (rules.release if holds else 0.0)
            if best is None or cost < best[0] - _SAME:
                best = (
                    cost,
                    _Catch(shift=shift, value=coordinate.value, start=coordinate.at, feature=point),
                )
    return best[1] if best else None


def _spaced(
    box: tuple[float, float, float, float],
    axis: int,
    boxes: tuple[tuple[float, float, float, float], ...],
    rules: Rules,
) -> _Catch | None:
    """Return equal gaps: in the middle between two neighbours, or as far off as they are apart."""
    low, high, other = axis, axis + 2, 1 - axis
    row = [b for b in boxes if b[other] < box[other + 2] and b[other + 2] > box[other]]
    before = sorted((b for b in row if b[high] <= box[low] + rules.catch), key=lambda b: -b[high])
    after = sorted((b for b in row if b[low] >= box[high] - rules.catch), key=lambda b: b[low])
    width = box[high] - box[low]
    wanted = []
    if before and after:
        wanted.append((before[0][high] + after[0][low] - width) / 2)
    if len(before) > 1 and before[0][low] > before[1][high]:
        wanted.append(before[0][high] + (before[0][low] - before[1][high]))
    if len(after) > 1 and after[1][low] > after[0][high]:
        wanted.append(after[0][low] - (after[1][low] - after[0][high]) - width)
    near = [(abs(value - box[low]), value) for value in wanted]
    near = [item for item in near if item[0] <= rules.catch]
    if not near:
        return None
    value = min(near)[1]
    middle = ((box[0] + box[2]) / 2, (box[1] + box[3]) / 2)
    neighbour = (before or after)[0]
    start = ((neighbour[0] + neighbour[2]) / 2, (neighbour[1] + neighbour[3]) / 2)
    shift = value - box[low]
    gaps = _gaps(box, axis, shift, before[:2], after[:2])
    return _Catch(shift=shift, value=value, start=start, feature=middle, gaps=gaps)


def _gaps(
    box: Rectangle,
    axis: int,
    shift: float,
    before: Sequence[Rectangle],
    after: Sequence[Rectangle],
) -> tuple[Line, ...]:
    """Return the equal gaps of a row of boxes, as lines from edge to edge."""
    low, high = axis, axis + 2
    moved = tuple(value + (shift if k % 2 == axis else 0.0) for k, value in enumerate(box))
    row = [*reversed(before), moved, *after]
    height = (box[1 - axis] + box[3 - axis]) / 2
    found = [(a[high], b[low]) for a, b in itertools.pairwise(row) if b[low] > a[high]]
    beside = [(p, q) for p, q in found if moved[low] in (p, q) or moved[high] in (p, q)]
    width = min((q - p for p, q in beside), default=0.0)
    equal = [(p, q) for p, q in found if abs(q - p - width) < _GAP_NOISE]
    ends = [((p, height), (q, height)) for p, q in equal]
    flipped = [tuple((y, x) for x, y in pair) for pair in ends] if axis else ends
    return tuple(Line(a=pair[0], b=pair[1], style=Style.GUIDE, arrow=True) for pair in flipped)


def _gridded(
    points: tuple[Point, ...], axis: int, rules: Rules, apart: Point | None
) -> _Catch | None:
    assert rules.grid is not None
    point = points[0]
    value = round(point[axis] / rules.grid) * rules.grid
    if abs(value - point[axis]) > rules.catch:
        return None
    if apart is not None and abs(value - apart[axis]) <= APART:
        return None
    return _Catch(shift=value - point[axis], value=value, start=None, feature=point)


def measured(guides: Iterable[Line]) -> tuple[Line | Label, ...]:
    """Return guides with their lengths beside them; very short ones stay without."""
    marks: list[Line | Label] = []
    for guide in guides:
        marks.append(guide)
        length = math.dist(guide.a, guide.b)
        if length >= _SHORTEST:
            middle = ((guide.a[0] + guide.b[0]) / 2, (guide.a[1] + guide.b[1]) / 2)
            marks.append(Label(at=middle, text=f"{length:.2f} m"))
    return tuple(marks)


def _guides(catches: Sequence[_Catch | None], shift: Point) -> Iterable[Line]:
    for axis, catch in enumerate(catches):
        if catch is None or catch.start is None:
            continue
        if catch.gaps:
            yield from catch.gaps
            continue
        end = (catch.feature[0] + shift[0], catch.feature[1] + shift[1])
        start = catch.start
        if axis == 0:
            start = (catch.value, start[1]) if abs(end[0] - catch.value) < 1e-6 else start
        else:
            start = (start[0], catch.value) if abs(end[1] - catch.value) < 1e-6 else start
        yield Line(a=start, b=end, style=Style.GUIDE)
