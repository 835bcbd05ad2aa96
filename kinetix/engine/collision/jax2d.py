"""kinetix-env's contact conventions, for the preset `jax2d` only: one depth, no clipping.

Worlds are on the last axis. Contacts of a kind are listed in the order of `pairs.candidate_pairs`.
"""

import jax.numpy as jnp
import numpy as np
from jaxtyping import Array, Bool, Float, Int

from kinetix.engine import maths
from kinetix.engine.maths import Vec, cross, dot, length, nonzero, rotate, vec
from kinetix.engine.types import Bodies, State
from kinetix.pytree import pytree

REFERENCE_BIAS = 0.01
"""By how much the second polygon's separation must be larger for it to become the reference [m]."""


@pytree
class Manifold:
    """One contact point of each pair of a kind; `normal` points from body a to body b."""

    normal: Vec
    point: Vec
    depth: Float[Array, "q n"]
    """Overlap [m], positive when the bodies overlap."""
    active: Bool[Array, "q n"]


@pytree
class Shapes:
    """The moved shapes of all worlds: world vertices and outward edge normals of the polygons."""

    vertices: Vec
    """(p, v, n)."""
    following: Vec
    """The vertex after each vertex, (p, v, n)."""
    normals: Vec
    """Of the edge that starts at each vertex, (p, v, n)."""
    used: Bool[Array, "p v n"]
    """True for vertices (and edges) that count."""


def move_shapes(bodies: Bodies, state: State) -> Shapes:
    """Return the world geometry of the polygons at the state's poses."""
    count = bodies.vertices.shape[0]
    return moved_polygons(
        bodies.vertices, bodies.vertex_count, state.position[:count], state.rotation[:count]
    )


def moved_polygons(
    corners: Float[Array, "p v 2 n"],
    vertex_count: Int[Array, "p n"],
    position: Float[Array, "p 2 n"],
    rotation: Float[Array, "p n"],
) -> Shapes:
    """Return the world geometry of polygons with these corners in their own frames [m]."""
    angle = rotation[:, None]
    local = Vec(x=corners[:, :, 0], y=corners[:, :, 1])
    vertices = rotate(jnp.cos(angle), jnp.sin(angle), local) + vec(position)[:, None]
    count = vertex_count[:, None]
    index = jnp.arange(corners.shape[1])[None, :, None]
    last = index == count - 1
    rolled = Vec(x=jnp.roll(vertices.x, -1, axis=1), y=jnp.roll(vertices.y, -1, axis=1))
    following = maths.where(last, vertices[:, :1], rolled)
    edge = following - vertices
    normals = Vec(x=-edge.y, y=edge.x) / nonzero(length(edge))
    return Shapes(vertices=vertices, following=following, normals=normals, used=index < count)


def circle_circle(
    a: Int[np.ndarray, " q"], b: Int[np.ndarray, " q"], centre: Vec, radius: Float[Array, "r n"]
) -> Manifold:
    """Return contacts between circles; indices count circles.

    Coincident centres give a zero normal.
    """
    apart = centre[b] - centre[a]
    distance = length(apart)
    normal = apart / nonzero(distance)
    depth = radius[a] + radius[b] - distance
    return Manifold(
        normal=normal, point=centre[a] + normal * radius[a], depth=depth, active=depth > 0
    )


def circle_polygon(
    a: Int[np.ndarray, " q"],
    b: Int[np.ndarray, " q"],
    centre: Vec,
    radius: Float[Array, "r n"],
    shapes: Shapes,
) -> Manifold:
    """Contacts of circles (indices `a`) with polygons (indices `b`): the nearest boundary point.

    A centre inside the polygon has the constant depth r.
    """
    start, end, used = shapes.vertices[b], shapes.following[b], shapes.used[b]
    c, r = centre[a], radius[a]
    edge = end - start
    along = dot(c[:, None] - start, edge) / nonzero(dot(edge, edge))
    nearest = start + edge * jnp.clip(along, 0, 1)
    away = c[:, None] - nearest
    squared = jnp.where(used, dot(away, away), jnp.inf)
    best = jnp.argmin(squared, axis=1)
    point = _pick(nearest, best)
    offset = c - point
    distance = length(offset)
    inside = jnp.all((cross(edge, c[:, None] - start) < 0) | ~used, axis=1)
    outward = offset / nonzero(distance)
    return Manifold(
        normal=maths.where(inside, outward, -outward),
        point=point,
        depth=jnp.where(inside, r, r - distance),
        active=(distance <= r) | inside,
    )


def polygon_polygon(
    a: Int[np.ndarray, " q"], b: Int[np.ndarray, " q"], shapes: Shapes
) -> tuple[Manifold, Manifold]:
    """Contacts between polygons: the deeper point, and a second where both corners overlap."""
    separation_a, edge_a = _largest_separation(shapes, a, b)
    separation_b, edge_b = _largest_separation(shapes, b, a)
    swap = separation_a + REFERENCE_BIAS < separation_b
    depth = -jnp.maximum(separation_a, separation_b)
    colliding = depth > 0

    def chosen(array: Vec, first: np.ndarray, second: np.ndarray) -> Vec:
        return maths.where(swap[:, None], array[second], array[first])

    edge = jnp.where(swap, edge_b, edge_a)
    normal = _pick(chosen(shapes.normals, a, b), edge)
    start = _pick(chosen(shapes.vertices, a, b), edge)
    stop = _pick(chosen(shapes.following, a, b), edge)
    incident = chosen(shapes.vertices, b, a)
    incident_used = jnp.where(swap[:, None], shapes.used[a], shapes.used[b])

    projection = jnp.where(incident_used, dot(normal[:, None], incident), jnp.inf)
    first = jnp.argmin(projection, axis=1)
    corners = np.arange(projection.shape[1])[None, :, None]
    second = jnp.argmin(jnp.where(corners == first[:, None], jnp.inf, projection), axis=1)

    span = stop - start
    extent = length(span)
    direction = span / nonzero(extent)

    def clamped(which: Int[Array, "q n"]) -> tuple[Float[Array, "q n"], Vec]:
        offset = _pick(incident, which) - start
        inward = -dot(normal, offset)
        along = jnp.clip(dot(direction, offset), 0, extent)
        return inward, start + direction * along - normal * inward

    depth_1, point_1 = clamped(first)
    depth_2, point_2 = clamped(second)
    swapped = depth_2 > depth_1
    outward = maths.where(swap, -normal, normal)
    deeper = Manifold(
        normal=outward,
        point=maths.where(swapped, point_2, point_1),
        depth=depth,
        active=colliding,
    )
    other = Manifold(
        normal=outward,
        point=maths.where(swapped, point_1, point_2),
        depth=depth,
        active=colliding & (depth_1 > 0) & (depth_2 > 0),
    )
    return deeper, other


def _largest_separation(
    shapes: Shapes, a: Int[np.ndarray, " q"], b: Int[np.ndarray, " q"]
) -> tuple[Float[Array, "q n"], Int[Array, "q n"]]:
    """Over the edge normals of a: the largest gap between a and b along it, and its edge."""
    normals = shapes.normals[a][:, :, None]
    own = dot(normals, shapes.vertices[a][:, None])
    theirs = dot(normals, shapes.vertices[b][:, None])
    nearest = jnp.min(jnp.where(shapes.used[b][:, None], theirs, jnp.inf), axis=2)
    farthest = jnp.max(jnp.where(shapes.used[a][:, None], own, -jnp.inf), axis=2)
    gap = jnp.where(shapes.used[a], nearest - farthest, -jnp.inf)
    return jnp.max(gap, axis=1), jnp.argmax(gap, axis=1)


def _pick(array: Vec, index: Int[Array, "q n"]) -> Vec:
    """Return the row `index` of the second axis, for each pair and world."""
    mask = np.arange(array.x.shape[1])[None, :, None] == index[:, None]
    return Vec(
        x=jnp.sum(jnp.where(mask, array.x, 0), axis=1),
        y=jnp.sum(jnp.where(mask, array.y, 0), axis=1),
    )
