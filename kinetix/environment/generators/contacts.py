"""How many contacts a new body would have: what proposals are compared by.

Only the yes-or-no part of the contact rules, for one new body (`q` proposals of it) against the
bodies that are there (`b`). The contacts among those are the same for all proposals.

Source: physics.md 2.6.
"""

import jax
import jax.numpy as jnp
from jaxtyping import Array, Bool, Float, Int

from kinetix.environment.generators.figures import VERTICES, Figures, has_vertex, rotate
from kinetix.pytree import pytree

REFERENCE_BIAS = 0.01
"""How much the second polygon's best axis must be better to become the reference [m]."""


@pytree
class Outlines:
    """Bodies as the contact tests want them: in the world's frame, normals made."""

    centre: Float[Array, "*r 2 n"]
    """Position of the body [m]."""
    corners: Float[Array, "*r 4 2 n"]
    """Corners of a polygon; the missing corner of a triangle repeats the first [m]."""
    normals: Float[Array, "*r 4 2 n"]
    """Outward unit normals of the edges; 0 for the missing edge of a triangle."""
    offsets: Float[Array, "*r 4 n"]
    """Where the edges lie along their normals [m]; huge for a missing edge."""
    triangle: Bool[Array, "*r n"]
    radius: Float[Array, "*r n"]
    circle: Bool[Array, "*r n"]
    active: Bool[Array, "*r n"]


def outlines(figures: Figures) -> Outlines:
    """The outlines of bodies where they are."""
    angles = figures.rotation[..., None, :]
    corners = rotate(figures.vertices, angles) + figures.position[..., None, :, :]
    triangle = (figures.vertex_count == 3) & ~figures.circle
    missing = jnp.stack([~has_vertex(figures, k) for k in range(VERTICES)], axis=-2)
    corners = jnp.where(missing[..., None, :], corners[..., :1, :, :], corners)
    edges = jnp.roll(corners, -1, axis=-3) - corners
    x, y = edges[..., 0, :], edges[..., 1, :]
    length = jnp.sqrt(jnp.maximum(x * x + y * y, 1e-12))
    # Clockwise corners: outward is to the left of the edge.
    normals = jnp.stack([-y / length, x / length], axis=-2)
    along = normals[..., 0, :] * corners[..., 0, :] + normals[..., 1, :] * corners[..., 1, :]
    return Outlines(
        centre=figures.position,
        corners=corners,
        normals=normals,
        offsets=jnp.where(missing, 1e6, along),
        triangle=triangle,
        radius=figures.radius,
        circle=figures.circle,
        active=figures.active,
    )


def count_contacts(
    new: Outlines, others: Outlines, rows: Int[Array, ""] | int
) -> Int[Array, "q n"]:
    """Active contacts between each proposal and the active ones of the first `rows` bodies.

    A pair of polygons counts 1 or 2 (its two contact slots), any other pair 1. Whether the pair is
    jointed or fixed plays no part.
    """

    def add(row: Int[Array, ""], count: Int[Array, "q n"]) -> Int[Array, "q n"]:
        other = jax.tree.map(
            lambda leaf: jax.lax.dynamic_slice_in_dim(leaf, row, 1, axis=0), others
        )
        return count + _pair_contacts(new, other)

    # One body at a time: a reduction over bodies would keep XLA from vectorising over the worlds.
    return jax.lax.fori_loop(0, rows, add, jnp.zeros(new.radius.shape, jnp.int32))


def _pair_contacts(new: Outlines, other: Outlines) -> Int[Array, "q n"]:
    pairs = jnp.where(
        new.circle,
        jnp.where(other.circle, _circles(new, other), _circle_polygon(new, other)),
        jnp.where(other.circle, _circle_polygon(other, new), _polygons(other, new)),
    )
    return jnp.where(new.active & other.active, pairs, 0)


def _circles(a: Outlines, b: Outlines) -> Int[Array, "q n"]:
    x = a.centre[..., 0, :] - b.centre[..., 0, :]
    y = a.centre[..., 1, :] - b.centre[..., 1, :]
    reach = a.radius + b.radius
    return (x * x + y * y < reach * reach).astype(jnp.int32)


def _circle_polygon(circle: Outlines, polygon: Outlines) -> Int[Array, "q n"]:
    cx, cy = circle.centre[..., 0, :], circle.centre[..., 1, :]
    nearest, inside = jnp.inf, True
    for k in range(VERTICES):
        x, y = polygon.corners[..., k, 0, :], polygon.corners[..., k, 1, :]
        following = (k + 1) % VERTICES
        ex = polygon.corners[..., following, 0, :] - x
        ey = polygon.corners[..., following, 1, :] - y
        wx, wy = cx - x, cy - y
        share = jnp.clip((wx * ex + wy * ey) / jnp.maximum(ex * ex + ey * ey, 1e-12), 0.0, 1.0)
        dx, dy = wx - share * ex, wy - share * ey
        nearest = jnp.minimum(nearest, dx * dx + dy * dy)
        inner = ex * wy - ey * wx < 0
        inside = inside & (inner | polygon.triangle if k == VERTICES - 1 else inner)
    return ((nearest <= circle.radius * circle.radius) | inside).astype(jnp.int32)


def _polygons(a: Outlines, b: Outlines) -> Int[Array, "q n"]:
    separation_a, depth_a = _best_axis(a, b)
    separation_b, depth_b = _best_axis(b, a)
    second_depth = jnp.where(separation_a + REFERENCE_BIAS < separation_b, depth_b, depth_a)
    contacts = 1 + (second_depth > 0).astype(jnp.int32)
    return jnp.where(jnp.maximum(separation_a, separation_b) < 0, contacts, 0)


def _best_axis(
    reference: Outlines, incident: Outlines
) -> tuple[Float[Array, "q n"], Float[Array, "q n"]]:
    """The axis of greatest separation among the reference's normals.

    Returns:
        The separation [m], negative when overlapping, and how deep the second deepest corner of the
        other polygon lies behind that edge [m].
    """
    best = jnp.full_like(reference.radius, -jnp.inf)
    second_depth = jnp.zeros_like(best)
    for k in range(VERTICES):
        nx, ny = reference.normals[..., k, 0, :], reference.normals[..., k, 1, :]
        least, second = jnp.inf, jnp.inf
        for j in range(VERTICES):
            along = nx * incident.corners[..., j, 0, :] + ny * incident.corners[..., j, 1, :]
            if j == VERTICES - 1:
                along = jnp.where(incident.triangle, jnp.inf, along)
            second = jnp.minimum(second, jnp.maximum(least, along))
            least = jnp.minimum(least, along)
        offset = reference.offsets[..., k, :]
        separation = least - offset
        better = separation > best
        best = jnp.where(better, separation, best)
        second_depth = jnp.where(better, offset - second, second_depth)
    return best, second_depth
