"""Bodies while a level is drawn: rows of any shape, worlds on the last axis.

The generator is natively batched: every array ends with the axis `n` of worlds, so that a thousand
levels are one vector operation. The axes `*r` before it list bodies (`b`), or proposals (`q`) for
one new body, or are absent (one body a world). Nothing here depends on slots.
"""

from typing import Final

import jax.numpy as jnp
from jaxtyping import Array, Bool, Float, Int

from kinetix.engine.spec import ARENA_BODIES
from kinetix.level.model import InertiaModel
from kinetix.pytree import pytree

VERTICES: Final = 4
"""Rows for the corners of a polygon."""


@pytree
class Figures:
    """Shape, place and part of bodies."""

    position: Float[Array, "*r 2 n"]
    """Origin of the body's frame [m]."""
    rotation: Float[Array, "*r n"]
    """Angle [rad]."""
    vertices: Float[Array, "*r 4 2 n"]
    """Corners of polygons in their own frame [m], clockwise; zero where there is none."""
    vertex_count: Int[Array, "*r n"]
    """3 or 4; 4 for circles."""
    radius: Float[Array, "*r n"]
    """Radius of circles [m]; 0 for polygons."""
    circle: Bool[Array, "*r n"]
    """Circle, not polygon."""
    role: Int[Array, "*r n"]
    """0 none, 1 green, 2 blue, 3 red."""
    density: Float[Array, "*r n"]
    """Mass per area [kg/m²]."""
    fixed: Bool[Array, "*r n"]
    """Infinite mass."""
    active: Bool[Array, "*r n"]
    """True where there is a body at all."""


def pick(rows: Array, index: Int[Array, "*q n"]) -> Array:
    """In each world the rows with these indexes.

    Args:
        rows: Anything listed along the first axis, worlds last: `b … n`.
        index: Which row, per world, with one axis `q` or none.

    Returns:
        `q … n`, or `… n`.
    """
    single = index.ndim == 1
    if single:
        index = index[None]
    middle = (1,) * (rows.ndim - 2)
    found = jnp.take_along_axis(
        rows, index.reshape(index.shape[0], *middle, index.shape[1]), axis=0, mode="clip"
    )
    return found[0] if single else found


def is_arena(figures: Figures) -> Bool[Array, "b 1"]:
    """Mark the floor, the walls and the ceiling: always the first four rows."""
    return (jnp.arange(figures.rotation.shape[0]) < ARENA_BODIES)[:, None]


def movable_rows(figures: Figures) -> Bool[Array, "b n"]:
    """Return active bodies besides the arena."""
    return figures.active & ~is_arena(figures)


def rotate(
    vector: Float[Array, "... 2 n"], angle: Float[Array, "... n"]
) -> Float[Array, "... 2 n"]:
    """The vectors turned counter-clockwise by the angle [rad] (same rank without the axis of 2)."""
    c, s = jnp.cos(angle), jnp.sin(angle)
    x, y = vector[..., 0, :], vector[..., 1, :]
    return jnp.stack([c * x - s * y, s * x + c * y], axis=-2)


def has_vertex(figures: Figures, vertex: int) -> Bool[Array, "*r n"]:
    """Return whether this corner counts."""
    return figures.vertex_count > vertex


def area(figures: Figures) -> Float[Array, "*r n"]:
    """Area of each body [m²], whether active or not."""
    corners = [figures.vertices[..., k, :, :] for k in range(VERTICES)]
    polygon = _triangle_area(*corners[:3])
    polygon = polygon + jnp.where(
        has_vertex(figures, 3), _triangle_area(corners[0], *corners[2:]), 0.0
    )
    return jnp.where(figures.circle, jnp.pi * figures.radius**2, polygon)


def mass(figures: Figures) -> Float[Array, "*r n"]:
    """Density times area [kg]: what the body weighs, or would weigh if it were not fixed."""
    return figures.density * area(figures)


def inertia(figures: Figures, inertia_model: InertiaModel) -> Float[Array, "*r n"]:
    """Return the moment of inertia about the frame's origin [kg m²], as if not fixed.

    Args:
        figures: Bodies whose frame's origin is their centre of mass.
        inertia_model: `"kinetix"` halves that of discs and leaves out the closing edge of
            triangles, as kinetix-env does; `"exact"` is the true one.
    """
    x, y = figures.vertices[..., 0, :], figures.vertices[..., 1, :]
    total = jnp.zeros_like(figures.rotation)
    for k in range(VERTICES):
        following = (k + 1) % VERTICES
        next_x, next_y = x[..., following, :], y[..., following, :]
        if inertia_model == "exact":
            closes = figures.vertex_count == k + 1
            next_x = jnp.where(closes, x[..., 0, :], next_x)
            next_y = jnp.where(closes, y[..., 0, :], next_y)
        here_x, here_y = x[..., k, :], y[..., k, :]
        cross = jnp.abs(here_x * next_y - here_y * next_x)
        squares = here_x * (here_x + next_x) + here_y * (here_y + next_y)
        edge = cross * (squares + next_x**2 + next_y**2) / 12
        total = total + jnp.where(has_vertex(figures, k), edge, 0.0)
    disc = (jnp.pi / (4 if inertia_model == "kinetix" else 2)) * figures.radius**4
    return figures.density * jnp.where(figures.circle, disc, total)


def centroid(figures: Figures, inertia_model: InertiaModel) -> Float[Array, "*r 2 n"]:
    """Return the centre of mass of polygons in their own frame [m]; 0 for circles.

    Args:
        figures: The bodies.
        inertia_model: `"kinetix"` takes the mean of the corners, `"exact"` the area's centre.
    """
    corners = [figures.vertices[..., k, :, :] for k in range(VERTICES)]
    fourth = has_vertex(figures, 3)[..., None, :]
    three = corners[0] + corners[1] + corners[2]
    if inertia_model == "kinetix":
        centre = jnp.where(fourth, (three + corners[3]) / 4, three / 3)
    else:
        first, second = (
            _triangle_area(corners[0], corners[k], corners[k + 1])[..., None, :] for k in (1, 2)
        )
        second = jnp.where(fourth, second, 0.0)
        total = jnp.maximum(first + second, 1e-12)
        moments = first * three + second * (corners[0] + corners[2] + corners[3])
        centre = moments / (3 * total)
    return jnp.where(figures.circle[..., None, :], 0.0, centre)


def _triangle_area(a: Array, b: Array, c: Array) -> Array:
    p, q = b - a, c - a
    return jnp.abs(p[..., 0, :] * q[..., 1, :] - p[..., 1, :] * q[..., 0, :]) / 2


def bounds(figures: Figures) -> tuple[Float[Array, "*r 2 n"], Float[Array, "*r 2 n"]]:
    """Return the least and greatest coordinates of a polygon's corners in its own frame [m]."""
    counts = jnp.stack([has_vertex(figures, k) for k in range(VERTICES)], axis=-2)
    real = counts[..., :, None, :]
    low = jnp.min(jnp.where(real, figures.vertices, jnp.inf), axis=-3)
    high = jnp.max(jnp.where(real, figures.vertices, -jnp.inf), axis=-3)
    return low, high
