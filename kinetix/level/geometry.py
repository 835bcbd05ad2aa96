"""Plane geometry of level documents: places, areas, masses, overlaps and pick tests.

Plain Python: a level has few corners, and a picture of it is needed long before numpy pays off.
Polygons are counter-clockwise here; `reverse_winding` leads to the engine's order and back.
"""

import itertools
import math
from collections.abc import Callable, Sequence
from typing import Final

from kinetix.level.model import (
    ARENA_NAMES,
    Arena,
    ArenaName,
    Body,
    BodyReference,
    Circle,
    Geometry,
    InertiaModel,
    Joint,
    Level,
    Point,
    Polygon,
    Shape,
    round_real,
)

Points = Sequence[Point]

ARENA_WIDTH: Final = 5.0
"""Side of the playable square [m]."""
FLOOR_TOP: Final = 0.4
"""Height of the floor's surface [m]."""
MIN_VERTEX_DISTANCE: Final = 1e-3
"""Two corners closer than this make a polygon degenerate [m]."""
MIN_AREA: Final = 1e-4
"""A polygon smaller than this is degenerate [m²]."""
CENTRE_TOLERANCE: Final = 1e-4
"""Largest distance of a free body's centre of mass from the origin of its frame [m]."""
MASS_TOLERANCE: Final = 1e-5
"""Relative difference below which a stored mass is the derived one (rounding stays below 1e-6)."""
PLACE_TOLERANCE: Final = 1e-6
"""Difference below which an arena body is where it always is [m]."""

_SLAB = ((2.5, 5.2), (-2.5, 5.2), (-2.5, -5.2), (2.5, -5.2))
STANDARD_ARENA: Final[dict[ArenaName, Geometry]] = {
    "floor": Geometry(position=(2.5, -4.8), vertices=_SLAB),
    "left_wall": Geometry(
        position=(0.0, 0.0), vertices=((-5.0, 5.0), (-5.0, 0.0), (0.0, 0.0), (0.0, 5.0))
    ),
    "right_wall": Geometry(
        position=(0.0, 0.0), vertices=((5.0, 5.0), (5.0, 0.0), (10.0, 0.0), (10.0, 5.0))
    ),
    "ceiling": Geometry(position=(2.5, 10.2), vertices=_SLAB),
}
"""Arena bodies, unless a level places them otherwise; vertices counter-clockwise."""


def reverse_winding(vertices: Points) -> tuple[Point, ...]:
    """Return the same corners in the other turning sense: keep vertex 0, reverse the rest."""
    return (vertices[0], *reversed(vertices[1:]))


def cross(a: Point, b: Point) -> float:
    """Return the third component of the cross product."""
    return a[0] * b[1] - a[1] * b[0]


def rotate(point: Point, angle: float) -> Point:
    """Return a vector turned counter-clockwise by `angle` [rad]."""
    c, s = math.cos(angle), math.sin(angle)
    return c * point[0] - s * point[1], s * point[0] + c * point[1]


def to_world(body: Body, point: Point) -> Point:
    """Return a point of the body's frame in world coordinates [m]."""
    x, y = rotate(point, body.angle)
    return body.position[0] + x, body.position[1] + y


def to_local(body: Body, point: Point) -> Point:
    """Return a world point in the body's frame [m]."""
    offset = (point[0] - body.position[0], point[1] - body.position[1])
    return rotate(offset, -body.angle)


def arena_body(arena: Arena, name: ArenaName) -> Body:
    """An arena body in the form of a fixed body with id 0, at its standard place or its own."""
    part = getattr(arena, name)
    geometry = part.geometry or STANDARD_ARENA[name]
    return Body(
        id=0,
        shape=Polygon(vertices=geometry.vertices),
        position=geometry.position,
        density=part.density,
        friction=part.friction,
        restitution=part.restitution,
        role=part.role,
        fixed=True,
        collision=part.collision,
    )


def arena_bodies(arena: Arena) -> tuple[Body, Body, Body, Body]:
    """Floor, left wall, right wall and ceiling as fixed bodies."""
    floor, left, right, ceiling = (arena_body(arena, name) for name in ARENA_NAMES)
    return floor, left, right, ceiling


def referenced_body(level: Level, reference: BodyReference) -> Body:
    """Return the body that a joint's `a` or `b` means, an arena body included.

    Raises:
        KeyError: No body has this id.
    """
    if isinstance(reference, str):
        return arena_body(level.arena, reference)
    return level.body(reference)


def relative_angle(level: Level, joint: Joint) -> float:
    """Return the angle of a joint's body b against its body a, as they are drawn [rad].

    Raises:
        KeyError: A body is missing.
    """
    return referenced_body(level, joint.b).angle - referenced_body(level, joint.a).angle


def joint_place(on_a: Point, on_b: Point, inverse_masses: tuple[float, float]) -> Point:
    """Return where a joint is drawn [m]: on a body that is fixed, else between its two anchors.

    Args:
        on_a: Its anchor on body a, in the world [m].
        on_b: Likewise on body b.
        inverse_masses: Of a and b [1/kg]: they weight the mean; 0 for a fixed body.
    """
    a, b = inverse_masses
    if a == 0 or b == 0:
        return on_a if a == 0 else on_b
    return (a * on_a[0] + b * on_b[0]) / (a + b), (a * on_a[1] + b * on_b[1]) / (a + b)


def signed_area(vertices: Points) -> float:
    """Area [m²], positive when the corners run counter-clockwise."""
    return sum(cross(vertices[k - 1], vertices[k]) for k in range(len(vertices))) / 2


def vertex_mean(vertices: Points) -> Point:
    """Return the arithmetic mean of the corners."""
    n = len(vertices)
    return sum(x for x, _ in vertices) / n, sum(y for _, y in vertices) / n


def area_centroid(vertices: Points) -> Point:
    """Centre of mass of the polygon's area. Source: the shoelace formula for first moments."""
    x = y = area = 0.0
    # Measured from corner 0, so that a polygon far from its origin loses no digits.
    ox, oy = vertices[0]
    corners = [(px - ox, py - oy) for px, py in vertices]
    for a, b in itertools.pairwise(corners):
        twice = cross(a, b)
        area += twice
        x += (a[0] + b[0]) * twice
        y += (a[1] + b[1]) * twice
    if area == 0.0:
        return vertex_mean(vertices)
    return ox + x / (3 * area), oy + y / (3 * area)


def centre_of_mass(shape: Shape, inertia_model: InertiaModel) -> Point:
    """Return the centre of mass in the frame of the shape, by the level's inertia model."""
    if isinstance(shape, Circle):
        return 0.0, 0.0
    return centre_of_corners(shape.vertices, inertia_model)


def centre_of_corners(corners: Sequence[Point], inertia_model: InertiaModel) -> Point:
    """Return the centre of mass of a polygon, by the level's inertia model."""
    return (area_centroid if inertia_model == "exact" else vertex_mean)(corners)


def _second_moment(edges: Sequence[tuple[Point, Point]]) -> float:
    return (
        sum(
            abs(cross(p, q))
            * (p[0] ** 2 + p[1] ** 2 + p[0] * q[0] + p[1] * q[1] + q[0] ** 2 + q[1] ** 2)
            for p, q in edges
        )
        / 12
    )


def shape_mass(shape: Shape, density: float, inertia_model: InertiaModel) -> tuple[float, float]:
    """Return the mass [kg] and moment of inertia [kg m²] about the origin of the shape's frame.

    The model `kinetix` follows the published levels: half the true inertia of a disc, and for
    triangles a sum over the corner pairs (0,1), (1,2), (2,3) of the clockwise list padded with the
    origin, which misses the closing edge.

    Source: the published level files, which store both numbers (equal to 5e-7).
    """
    if isinstance(shape, Circle):
        mass = density * math.pi * shape.radius**2
        return mass, mass * shape.radius**2 / (2 if inertia_model == "exact" else 4)
    corners = shape.vertices
    mass = density * abs(signed_area(corners))
    if inertia_model == "kinetix" and len(corners) == 3:
        first, second, third = reverse_winding(corners)
        edges = [(first, second), (second, third)]
    else:
        edges = [(corners[k - 1], corners[k]) for k in range(len(corners))]
    return mass, density * _second_moment(edges)


def body_mass(body: Body, inertia_model: InertiaModel) -> tuple[float, float]:
    """Mass and inertia of a body as if it were free; `mass_properties` overrides its shape."""
    if body.mass_properties:
        return body.mass_properties.mass, body.mass_properties.inertia
    return shape_mass(body.shape, body.density, inertia_model)


def inverse_mass(body: Body, inertia_model: InertiaModel) -> tuple[float, float]:
    """1/mass and 1/inertia, rounded to binary32; both 0 for a fixed body.

    A zero mass or inertia counts as 1, as in the published levels.
    """
    if body.fixed:
        return 0.0, 0.0
    mass, inertia = body_mass(body, inertia_model)
    return round_real(1 / (mass or 1.0)), round_real(1 / (inertia or 1.0))


def same_masses(inverses: tuple[float, float], derived: tuple[float, float]) -> bool:
    """Return whether inverse mass and inertia follow from shape and density, but for rounding."""
    return all(
        abs(inverse * value - 1) <= MASS_TOLERANCE
        for inverse, value in zip(inverses, derived, strict=True)
    )


def same_geometry(a: Geometry, b: Geometry) -> bool:
    """Return whether two arena bodies have the same place and shape, but for rounding."""
    return len(a.vertices) == len(b.vertices) and all(
        math.dist(p, q) <= PLACE_TOLERANCE
        for p, q in zip((a.position, *a.vertices), (b.position, *b.vertices), strict=True)
    )


def recentred(body: Body, inertia_model: InertiaModel) -> Body:
    """Return the same body in the same place, with the origin of its frame at its centre of mass.

    Anchors and thrusters of the body must be shifted by the caller.
    """
    shift = centre_of_mass(body.shape, inertia_model)
    if isinstance(body.shape, Circle) or shift == (0.0, 0.0):
        return body
    vertices = tuple((x - shift[0], y - shift[1]) for x, y in body.shape.vertices)
    return body.replace(position=to_world(body, shift), shape=Polygon(vertices=vertices))


def polygon_fault(vertices: Points) -> str | None:
    """Return why these corners are no polygon of the format; None when they are one."""
    n = len(vertices)
    if n not in (3, 4):
        return f"expected 3 or 4 vertices, got {n}"
    if not all(math.isfinite(value) for vertex in vertices for value in vertex):
        return "expected finite vertices"
    for i in range(n):
        for j in range(i):
            if math.dist(vertices[i], vertices[j]) < MIN_VERTEX_DISTANCE:
                return f"vertices {j} and {i} are closer than {MIN_VERTEX_DISTANCE} m"
    edges = [(q[0] - p[0], q[1] - p[1]) for p, q in _edges(vertices)]
    turns = [cross(edges[k - 1], edges[k]) for k in range(n)]
    area = signed_area(vertices)
    if abs(area) < MIN_AREA:
        return f"expected an area of at least {MIN_AREA} m², got {abs(area):.3g}"
    if all(turn < 0 for turn in turns):
        return "expected counter-clockwise vertices, got clockwise ones"
    if not all(turn > 0 for turn in turns):
        return "expected a strictly convex polygon"
    return None


def _edges(vertices: Points) -> list[tuple[Point, Point]]:
    return [(vertices[k - 1], vertices[k]) for k in range(len(vertices))]


def world_vertices(body: Body) -> tuple[Point, ...]:
    """Return the corners of a polygon body in world coordinates [m]; none for a circle."""
    if isinstance(body.shape, Circle):
        return ()
    c, s = math.cos(body.angle), math.sin(body.angle)
    px, py = body.position
    return tuple((px + c * x - s * y, py + s * x + c * y) for x, y in body.shape.vertices)


def bounds(body: Body) -> tuple[float, float, float, float]:
    """World bounding box: left, bottom, right, top [m]."""
    if isinstance(body.shape, Circle):
        (x, y), r = body.position, body.shape.radius
        return x - r, y - r, x + r, y + r
    corners = world_vertices(body)
    xs, ys = [x for x, _ in corners], [y for _, y in corners]
    return min(xs), min(ys), max(xs), max(ys)


def outside_arena(box: tuple[float, float, float, float]) -> bool:
    """Return whether a bounding box has nothing in the arena's square, all that pictures show."""
    left, bottom, right, top = box
    return right <= 0 or top <= 0 or left >= ARENA_WIDTH or bottom >= ARENA_WIDTH


def extent(shape: Shape) -> float:
    """Return the largest distance between two points of a shape [m]."""
    if isinstance(shape, Circle):
        return 2 * shape.radius
    return max(math.dist(p, q) for p in shape.vertices for q in shape.vertices)


def segment_distance(point: Point, start: Point, end: Point) -> float:
    """Return the distance of a point from a segment [m]."""
    dx, dy = end[0] - start[0], end[1] - start[1]
    squared = dx * dx + dy * dy
    along = ((point[0] - start[0]) * dx + (point[1] - start[1]) * dy) / squared if squared else 0.0
    along = min(max(along, 0.0), 1.0)
    return math.dist(point, (start[0] + along * dx, start[1] + along * dy))


def circle_about_middle(shape: Shape) -> tuple[Point, float]:
    """Return the middle of a shape in its frame and the distance from there to its edge [m]."""
    if isinstance(shape, Circle):
        return (0.0, 0.0), shape.radius
    middle = area_centroid(shape.vertices)
    return middle, min(segment_distance(middle, p, q) for p, q in _edges(shape.vertices))


def signed_distance(body: Body, point: Point) -> float:
    """Return the distance of a world point from a body's outline [m], negative inside."""
    if isinstance(body.shape, Circle):
        return math.dist(point, body.position) - body.shape.radius
    edges = _edges(body.shape.vertices)
    local = to_local(body, point)
    distance = min(segment_distance(local, p, q) for p, q in edges)
    inside = all(
        cross((q[0] - p[0], q[1] - p[1]), (local[0] - p[0], local[1] - p[1])) >= 0 for p, q in edges
    )
    return -distance if inside else distance


def contains(body: Body, point: Point) -> bool:
    """Return whether a world point lies in a body."""
    return signed_distance(body, point) <= 0.0


def inside_box(body: Body, box: tuple[float, float, float, float]) -> bool:
    """Return whether a body lies wholly in a box (left, bottom, right, top)."""
    left, bottom, right, top = bounds(body)
    return left >= box[0] and bottom >= box[1] and right <= box[2] and top <= box[3]


def touches_box(body: Body, box: tuple[float, float, float, float]) -> bool:
    """Return whether a body and a box (left, bottom, right, top) have a point in common."""
    left, bottom, right, top = box
    corners = ((right, top), (left, top), (left, bottom), (right, bottom))
    if isinstance(body.shape, Circle):
        nearest = (min(max(body.position[0], left), right), min(max(body.position[1], bottom), top))
        return math.dist(nearest, body.position) <= body.shape.radius
    return _polygon_overlap(corners, world_vertices(body)) >= 0.0


def overlap_depth(a: Body, b: Body) -> float:
    """Return the depth by which two bodies overlap [m]; 0 when they touch, negative when apart.

    The depth is the least shift that parts them; apart, its negative is the distance.
    Source: separating axis theorem (Ericson, Real-Time Collision Detection, 5.2.1).
    """
    if isinstance(a.shape, Circle):
        if isinstance(b.shape, Circle):
            return a.shape.radius + b.shape.radius - math.dist(a.position, b.position)
        return a.shape.radius - signed_distance(b, a.position)
    if isinstance(b.shape, Circle):
        return b.shape.radius - signed_distance(a, b.position)
    return _polygon_overlap(world_vertices(a), world_vertices(b))


def _polygon_overlap(a: Points, b: Points) -> float:
    depth = min(_least_overlap(a, b), _least_overlap(b, a))
    return depth if depth >= 0 else -min(_least_distance(a, b), _least_distance(b, a))


def _least_distance(a: Points, b: Points) -> float:
    """Return the least distance of a corner of one polygon from an edge of another [m]."""
    return min(segment_distance(corner, *edge) for corner in a for edge in _edges(b))


def _least_overlap(a: Points, b: Points) -> float:
    """Return the least overlap of two counter-clockwise polygons along the normals of `a`."""
    least = math.inf
    for (px, py), (qx, qy) in _edges(a):
        length = math.hypot(qx - px, qy - py) or 1.0
        nx, ny = (qy - py) / length, (px - qx) / length
        least = min(least, nx * px + ny * py - min(nx * x + ny * y for x, y in b))
    return least


def bounds_of(bodies: Sequence[Body]) -> tuple[float, float, float, float]:
    """Box around several bodies: left, bottom, right, top [m]."""
    boxes = [bounds(body) for body in bodies]
    pick: tuple[Callable[..., float], ...] = (min, min, max, max)
    left, bottom, right, top = (f(box[k] for box in boxes) for k, f in enumerate(pick))
    return left, bottom, right, top
