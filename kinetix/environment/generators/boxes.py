"""Contact counts of levels without triangles: those of `contacts`, an order faster.

Every polygon is a rectangle there, so two axes and two half sides per body are enough. A test
compares both.
"""

from collections.abc import Callable

import jax
import jax.numpy as jnp
from jaxtyping import Array, Bool, Float, Int

from kinetix.engine.collision.jax2d import REFERENCE_BIAS
from kinetix.environment.generators.figures import Figures, bounds, rotate
from kinetix.pytree import pytree


@pytree
class Boxes:
    """Circles, and rectangles by centre, direction and half sides."""

    centre: Float[Array, "*r 2 n"]
    """Middle of the rectangle or circle in the world [m]."""
    direction: Float[Array, "*r 2 n"]
    """Unit vector of the rectangle's own x axis."""
    half: Float[Array, "*r 2 n"]
    """Half sides of the rectangle [m]."""
    radius: Float[Array, "*r n"]
    circle: Bool[Array, "*r n"]
    active: Bool[Array, "*r n"]


def boxes(figures: Figures) -> Boxes:
    """The boxes of bodies where they are; polygons must be rectangles along their own axes."""
    low, high = bounds(figures)
    direction = jnp.stack([jnp.cos(figures.rotation), jnp.sin(figures.rotation)], axis=-2)
    return Boxes(
        centre=figures.position + rotate((low + high) / 2, figures.rotation),
        direction=direction,
        half=(high - low) / 2,
        radius=figures.radius,
        circle=figures.circle,
        active=figures.active,
    )


def count_box_contacts(
    new: Boxes, rectangles: Boxes, discs: Boxes, rows: tuple[Int[Array, ""] | int, ...]
) -> Int[Array, "q n"]:
    """Count active contacts between each proposal and the first rectangles and discs.

    Args:
        new: The proposals.
        rectangles: Bodies that are no circles.
        discs: Circles.
        rows: How many rows of either are looked at; the others are not active.
    """

    def against(rectangle: Boxes) -> Int[Array, "q n"]:
        x, y = _apart(new, rectangle)
        pair = jnp.where(
            new.circle, _circle_box(new, rectangle, x, y), _two_boxes(rectangle, new, x, y)
        )
        return jnp.where(new.active & rectangle.active, pair, 0)

    def beside(disc: Boxes) -> Int[Array, "q n"]:
        x, y = _apart(new, disc)
        reach = new.radius + disc.radius
        circles = (x * x + y * y < reach * reach).astype(jnp.int32)
        pair = jnp.where(new.circle, circles, _circle_box(disc, new, x, y))
        return jnp.where(new.active & disc.active, pair, 0)

    polygons, circles = rows
    return _summed(against, rectangles, polygons, new) + _summed(beside, discs, circles, new)


def _summed(
    pair: Callable[[Boxes], Int[Array, "q n"]],
    others: Boxes,
    rows: Int[Array, ""] | int,
    new: Boxes,
) -> Int[Array, "q n"]:
    """One body at a time: a sum over bodies would keep XLA from vectorising over the worlds."""
    none = jnp.zeros(new.radius.shape, jnp.int32)
    if not others.radius.shape[0]:
        return none

    def add(row: Int[Array, ""], count: Int[Array, "q n"]) -> Int[Array, "q n"]:
        return count + pair(jax.tree.map(lambda x: jax.lax.dynamic_slice_in_dim(x, row, 1), others))

    return jax.lax.fori_loop(0, rows, add, none)


def _apart(new: Boxes, other: Boxes) -> tuple[Float[Array, "q n"], Float[Array, "q n"]]:
    return (
        new.centre[..., 0, :] - other.centre[..., 0, :],
        new.centre[..., 1, :] - other.centre[..., 1, :],
    )


def _in_frame(
    box: Boxes, x: Float[Array, "q n"], y: Float[Array, "q n"]
) -> tuple[Float[Array, "q n"], Float[Array, "q n"]]:
    """Distances along the box's two axes [m]."""
    c, s = box.direction[..., 0, :], box.direction[..., 1, :]
    return jnp.abs(c * x + s * y), jnp.abs(c * y - s * x)


def _circle_box(
    circle: Boxes, box: Boxes, x: Float[Array, "q n"], y: Float[Array, "q n"]
) -> Int[Array, "q n"]:
    along, across = _in_frame(box, x, y)
    out_x = jnp.maximum(along - box.half[..., 0, :], 0.0)
    out_y = jnp.maximum(across - box.half[..., 1, :], 0.0)
    return (out_x**2 + out_y**2 <= circle.radius**2).astype(jnp.int32)


def _two_boxes(
    a: Boxes, b: Boxes, x: Float[Array, "q n"], y: Float[Array, "q n"]
) -> Int[Array, "q n"]:
    c = a.direction[..., 0, :] * b.direction[..., 0, :]
    c = jnp.abs(c + a.direction[..., 1, :] * b.direction[..., 1, :])
    s = a.direction[..., 0, :] * b.direction[..., 1, :]
    s = jnp.abs(s - a.direction[..., 1, :] * b.direction[..., 0, :])
    separation_a, depth_a = _best_axis(a, b, _in_frame(a, x, y), c, s)
    separation_b, depth_b = _best_axis(b, a, _in_frame(b, x, y), c, s)
    second_depth = jnp.where(separation_a + REFERENCE_BIAS < separation_b, depth_b, depth_a)
    contacts = 1 + (second_depth > 0).astype(jnp.int32)
    return jnp.where(jnp.maximum(separation_a, separation_b) < 0, contacts, 0)


def _best_axis(
    reference: Boxes,
    incident: Boxes,
    distances: tuple[Float[Array, "q n"], Float[Array, "q n"]],
    c: Float[Array, "q n"],
    s: Float[Array, "q n"],
) -> tuple[Float[Array, "q n"], Float[Array, "q n"]]:
    """Greatest separation along the reference's axes, and depth of the second deepest corner [m].

    Args:
        reference: The box whose axes are tried.
        incident: The other one.
        distances: Of the centres, along the reference's two axes [m].
        c: |cosine| of the angle between the boxes.
        s: |sine| of it.
    """
    half_x, half_y = incident.half[..., 0, :], incident.half[..., 1, :]
    along_x = (c * half_x, s * half_y)
    along_y = (s * half_x, c * half_y)
    gap_x = distances[0] - reference.half[..., 0, :]
    gap_y = distances[1] - reference.half[..., 1, :]
    separation_x = gap_x - along_x[0] - along_x[1]
    separation_y = gap_y - along_y[0] - along_y[1]
    depth_x = jnp.abs(along_x[0] - along_x[1]) - gap_x
    depth_y = jnp.abs(along_y[0] - along_y[1]) - gap_y
    second = separation_y > separation_x
    return jnp.maximum(separation_x, separation_y), jnp.where(second, depth_y, depth_x)
