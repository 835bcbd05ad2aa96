"""Constraint rows and what all solvers do with them. Worlds on the last axis.

A row acts on two bodies along one direction: with an impulse λ body b gains +direction·λ (and the
turn `turn_b`·λ), body a the opposite. Contacts, joints, motors and limits are all such rows, so one
function couples any two of them.
"""

import dataclasses
from collections.abc import Callable, Sequence
from functools import reduce
from operator import add
from typing import TypeVar

import jax
import jax.numpy as jnp
import numpy as np
from jaxtyping import Array, Bool, Float, Int, Shaped

from kinetix.engine.active_rows import InUse
from kinetix.engine.lookup import accumulate, column, put, row, take
from kinetix.engine.maths import Vec, cross, dot
from kinetix.engine.store import Store
from kinetix.pytree import pytree

T = TypeVar("T")


@pytree
class Velocity:
    """Velocities of all bodies, or how far they move."""

    linear: Vec
    angular: Float[Array, "b n"]

    def __add__(self, other: "Velocity") -> "Velocity":
        return Velocity(linear=self.linear + other.linear, angular=self.angular + other.angular)

    def __mul__(self, scale: Float[Array, "..."]) -> "Velocity":
        """Return the same direction; with a duration: how far everything moves."""
        return Velocity(linear=self.linear * scale, angular=self.angular * scale)


@pytree
class Masses:
    """Inverse masses as the solver uses them."""

    linear: Float[Array, "b n"]
    angular: Float[Array, "b n"]


@pytree
class Links:
    """Pairs of bodies, each of which one or several rows act on."""

    body_a: Int[Array, "k n"]
    body_b: Int[Array, "k n"]
    in_use: InUse

    @staticmethod
    def joined(*groups: "Links") -> "Links":
        """Return the links of several groups, one after the other."""
        return Links(
            body_a=jnp.concatenate([links.body_a for links in groups], axis=0),
            body_b=jnp.concatenate([links.body_b for links in groups], axis=0),
            in_use=InUse(
                counts=tuple(count for links in groups for count in links.in_use.counts),
                groups=tuple(group for links in groups for group in links.in_use.groups),
            ),
        )

    def look_up(self, bodies: T) -> tuple[T, T]:
        """Look up the two ends of every link in use in tables of bodies; 0 for the others.

        Args:
            bodies: Arrays (b, …, n) in any pytree.

        Returns:
            Two trees of arrays (k, …, n): of bodies a, and of bodies b.
        """
        count = self.body_a.shape[0]

        def visit(k: Int[Array, ""], found: T) -> T:
            ends = jnp.concatenate([row(self.body_a, k), row(self.body_b, k)], axis=0)
            return jax.tree.map(lambda x, into: put(into, x[None], k, 0), take(bodies, ends), found)

        def room(x: Shaped[Array, "b *rest n"]) -> Shaped[Array, "k 2 *rest n"]:
            return jnp.zeros((count, 2, *x.shape[1:]), x.dtype)

        found = self.in_use.each_link(visit, jax.tree.map(room, bodies))
        return jax.tree.map(lambda x: x[:, 0], found), jax.tree.map(lambda x: x[:, 1], found)


@pytree
class Directions:
    """One row for each of some links, the bodies' masses left aside."""

    along: Vec
    turn_a: Float[Array, "k n"]
    """arm_a × direction [m]; 1 for a row that acts on angles alone."""
    turn_b: Float[Array, "k n"]


@pytree
class Rows:
    """`m` rows. Bodies and masses are repeated for each, so that coupling needs no look-up."""

    links: Links
    """Without repetition: what is looked up in the bodies' tables is looked up once a link."""
    body_a: Int[Array, "m n"]
    body_b: Int[Array, "m n"]
    direction: Vec
    turn_a: Float[Array, "m n"]
    turn_b: Float[Array, "m n"]
    mass_a: Float[Array, "m n"]
    mass_b: Float[Array, "m n"]
    inertia_a: Float[Array, "m n"]
    inertia_b: Float[Array, "m n"]


def through_points(direction: Vec, arm_a: Vec, arm_b: Vec) -> Directions:
    """Directions that go through a point of each body."""
    return Directions(
        along=direction, turn_a=cross(arm_a, direction), turn_b=cross(arm_b, direction)
    )


def turning(turn: Float[Array, "k n"]) -> Directions:
    """Directions that turn two bodies against each other."""
    return Directions(
        along=Vec(x=jnp.zeros_like(turn), y=jnp.zeros_like(turn)), turn_a=turn, turn_b=turn
    )


def make_rows(
    links: Links, masses: tuple[Masses, Masses], directions: Sequence[Directions], store: Store
) -> Rows:
    """Return the rows of some links.

    Args:
        links: Whom they act on.
        masses: Of bodies a and of bodies b, a link.
        directions: In the order of the rows (`InUse`).
        store: Keeps what the rows are made from.
    """
    groups = links.in_use.groups
    along = jax.tree.map(lambda *x: jnp.concatenate(x, axis=0), *directions)
    links, along = store((links, along))
    of_a, of_b = _of_rows(groups, masses)
    body_a, body_b = _of_rows(groups, (links.body_a, links.body_b))
    return Rows(
        links=links,
        body_a=body_a,
        body_b=body_b,
        direction=along.along,
        turn_a=along.turn_a,
        turn_b=along.turn_b,
        mass_a=of_a.linear,
        mass_b=of_b.linear,
        inertia_a=of_a.angular,
        inertia_b=of_b.angular,
    )


def first_of_links(rows: Rows) -> Rows:
    """Return the first row of every link."""
    kept, start = [], 0
    for links, each in rows.links.in_use.groups:
        kept.append(slice(start, start + links))
        start += links * each

    def keep(x: Shaped[Array, "m n"]) -> Shaped[Array, "k n"]:
        return jnp.concatenate([x[part] for part in kept], axis=0)

    links = dataclasses.replace(rows.links, in_use=rows.links.in_use.one_row_each())
    return _picked(rows, keep, links)


def one_row(rows: Rows, index: Int[Array, ""]) -> Rows:
    """Return one of the rows, with a link of its own."""
    body_a, body_b = row(rows.body_a, index), row(rows.body_b, index)
    in_use = InUse.of((jnp.ones(body_a.shape, bool), 1))
    return _picked(
        rows, lambda x: row(x, index), Links(body_a=body_a, body_b=body_b, in_use=in_use)
    )


def _picked(rows: Rows, pick: Callable[[Array], Array], links: Links) -> Rows:
    columns = jax.tree.map(pick, dataclasses.replace(rows, links=None))
    return dataclasses.replace(columns, links=links)


def _of_rows(groups: tuple[tuple[int, int], ...], of_links: T) -> T:
    """Repeat the values of links for their rows."""

    def repeat(x: Shaped[Array, "k n"]) -> Shaped[Array, "m n"]:
        parts, start = [], 0
        for links, each in groups:
            part = x[None, start : start + links]
            parts.append(jnp.broadcast_to(part, (each, links, x.shape[1])).reshape(-1, x.shape[1]))
            start += links
        return _in_a_row(parts)

    return jax.tree.map(repeat, of_links)


def _in_a_row(parts: list[Shaped[Array, "_ n"]]) -> Shaped[Array, "m n"]:
    """Return one after the other; nothing to do for one part alone, and for empty ones.

    Parts that are concatenated within arithmetic are not free: every entry looks up its part.
    """
    filled = [part for part in parts if part.shape[0]] or parts[:1]
    return filled[0] if len(filled) == 1 else jnp.concatenate(filled, axis=0)


def coupling(left: Rows, right: Rows) -> Float[Array, "m k n"]:
    """J_left M⁻¹ J_rightᵀ: change of the left rows' speeds per unit of the right rows' impulses."""
    i, j = (slice(None), None), (None, slice(None))
    straight = dot(left.direction[i], right.direction[j])

    def share(
        body_left: Array,
        body_right: Array,
        mass: Array,
        inertia: Array,
        turn_left: Array,
        turn_right: Array,
    ) -> Array:
        same = body_left[i] == body_right[j]
        return jnp.where(same, mass[i] * straight + inertia[i] * turn_left[i] * turn_right[j], 0)

    return (
        share(left.body_a, right.body_a, left.mass_a, left.inertia_a, left.turn_a, right.turn_a)
        + share(left.body_b, right.body_b, left.mass_b, left.inertia_b, left.turn_b, right.turn_b)
        - share(left.body_a, right.body_b, left.mass_a, left.inertia_a, left.turn_a, right.turn_b)
        - share(left.body_b, right.body_a, left.mass_b, left.inertia_b, left.turn_b, right.turn_a)
    )


def put_coupling(
    matrix: Float[Array, "m m n"],
    index: Int[Array, ""],
    line: Float[Array, "1 m n"],
    live: Bool[Array, "m n"],
    own: Float[Array, "m n"],
    store: Store,
) -> Float[Array, "m m n"]:
    """The matrix of a system with one more row: `line`, where both rows live, and its diagonal."""
    line = jnp.where(row(live, index)[None] & live[None], line, 0)
    here = (np.arange(live.shape[0]) == index)[None, :, None]
    return put(matrix, store(jnp.where(here, own[None], line)), index, 0)


def diagonal(rows: Rows) -> Float[Array, "m n"]:
    """Return the diagonal of `coupling(rows, rows)`."""
    straight = dot(rows.direction, rows.direction)
    apart = (rows.mass_a + rows.mass_b) * straight + (
        rows.inertia_a * rows.turn_a**2 + rows.inertia_b * rows.turn_b**2
    )
    return jnp.where(rows.body_a == rows.body_b, 0, apart)


def speeds(rows: Rows, velocity: Velocity) -> Float[Array, "m n"]:
    """Return the speed of b relative to a along each row of the links in use; 0 for the others."""
    links = rows.links

    def visit(
        link: Int[Array, ""], of_link: list[Int[Array, ""]], found: Float[Array, "m n"]
    ) -> Float[Array, "m n"]:
        ends = jnp.concatenate([row(links.body_a, link), row(links.body_b, link)], axis=0)
        moving = take(velocity, ends)
        apart, (turn_a, turn_b) = moving.linear[1:] - moving.linear[:1], moving.angular
        for index in of_link:
            direction = Vec(x=row(rows.direction.x, index), y=row(rows.direction.y, index))
            turning = row(rows.turn_b, index) * turn_b - row(rows.turn_a, index) * turn_a
            found = put(found, dot(direction, apart) + turning, index, 0)
        return found

    return links.in_use.each_of_link(visit, jnp.zeros_like(rows.turn_a))


def apply(rows: Rows, impulse: Float[Array, "m n"], velocity: Velocity, masses: Masses) -> Velocity:
    """Return the velocities after impulses on all rows of the links in use."""
    bodies = np.arange(velocity.angular.shape[0], dtype=np.int32)[:, None]
    links = rows.links

    def visit(
        link: Int[Array, ""], of_link: list[Int[Array, ""]], total: tuple[Array, Array, Array]
    ) -> tuple[Array, Array, Array]:
        def pushed(direction: Float[Array, "m n"]) -> Float[Array, "1 n"]:
            return reduce(add, [row(direction, index) * row(impulse, index) for index in of_link])

        on_a, on_b = bodies == row(links.body_a, link), bodies == row(links.body_b, link)

        def share(to_a: Array, to_b: Array) -> Array:
            return jnp.where(on_b, to_b, 0) - jnp.where(on_a, to_a, 0)

        x, y, turn = total
        along_x, along_y = pushed(rows.direction.x), pushed(rows.direction.y)
        return (
            x + share(along_x, along_x),
            y + share(along_y, along_y),
            turn + share(pushed(rows.turn_a), pushed(rows.turn_b)),
        )

    nothing = jnp.zeros_like(velocity.angular)
    x, y, turn = links.in_use.each_of_link(visit, (nothing, nothing, nothing))
    return Velocity(
        linear=Vec(
            x=velocity.linear.x + x * masses.linear, y=velocity.linear.y + y * masses.linear
        ),
        angular=velocity.angular + turn * masses.angular,
    )


def matvec(matrix: Float[Array, "m k n"], vector: Float[Array, "k n"]) -> Float[Array, "m n"]:
    """Matrix times vector in every world.

    Column by column: a sum over the columns is not vectorised over the worlds, and takes three
    times as long.
    """

    def add(k: Int[Array, ""], total: Float[Array, "m n"]) -> Float[Array, "m n"]:
        return total + column(matrix, k) * row(vector, k)

    nothing = jnp.zeros((matrix.shape[0], matrix.shape[2]), vector.dtype)
    return accumulate(matrix.shape[1], add, nothing)


def inverse(matrix: Float[Array, "m m n"]) -> Float[Array, "m m n"]:
    """Return the inverse of symmetric positive definite matrices."""
    return -minus_inverse(matrix)


def minus_inverse(
    matrix: Float[Array, "m m n"],
    least_pivot: Float[Array, "m n"] | None = None,
    in_use: InUse | None = None,
) -> Float[Array, "m m n"]:
    """Minus the inverse of symmetric positive definite matrices: the sweep operator, no pivoting.

    Args:
        matrix: One a world.
        least_pivot: What remains of a row after the rows before it were eliminated is raised to
            this: a row that (nearly) depends on others becomes soft instead of being amplified.
        in_use: Which rows are coupled to any other; the inverse of the others is not defined.
    """
    size = matrix.shape[0]
    if size == 0:
        return matrix

    store = Store.beside(matrix)

    def sweep(k: Int[Array, ""], m: Float[Array, "m m n"]) -> Float[Array, "m m n"]:
        of_row = row(m, k)[0]
        pivot = row(of_row, k)
        if least_pivot is not None:
            pivot = jnp.maximum(pivot, row(least_pivot, k))
        here = (np.arange(size) == k)[:, None]
        # Once these are stored, the matrix changes in place; else it would be copied.
        others = jnp.where(here, 0, of_row)
        others, scaled, line = store(
            (others, others / pivot, jnp.where(here, -1 / pivot, others / pivot))
        )
        m = m - others[:, None] * scaled[None]
        return put(put(m, line[None], k, 0), line[:, None], k, 1)

    if in_use is None:
        return jax.lax.fori_loop(0, size, sweep, matrix)
    return in_use.each(sweep, matrix)


def match(
    key: Int[Array, "c n"], old_key: Int[Array, "c n"], *values: Float[Array, "c n"]
) -> tuple[Float[Array, "c n"], ...]:
    """Return the old values of the entries whose key is still there; 0 for new ones and key −1."""
    known = old_key >= 0

    def carry_over(k: Int[Array, ""], found: tuple[Array, ...]) -> tuple[Array, ...]:
        same = (key == row(old_key, k)) & row(known, k)
        return tuple(jnp.where(same, row(x, k), old) for x, old in zip(values, found, strict=True))

    return InUse.of((known, 1)).each(
        carry_over, tuple(jnp.zeros(key.shape, x.dtype) for x in values)
    )
