"""Constraint rows and what all solvers do with them. Worlds on the last axis.

A row acts on two bodies along one direction: with an impulse λ body b gains +direction·λ (and the
turn `turn_b`·λ), body a the opposite. Contacts, joints, motors and limits are all such rows, so one
function couples any two of them.
"""

import dataclasses
import functools
from collections.abc import Callable, Sequence
from typing import TypeVar

import jax
import jax.numpy as jnp
import numpy as np
from jaxtyping import Array, Bool, Float, Int, Shaped

from kinetix.engine.lookup import accumulate, column, put, row, take_pair
from kinetix.engine.maths import Vec, cross, dot
from kinetix.engine.store import Store
from kinetix.pytree import pytree, static

T = TypeVar("T")

WRITTEN_OUT = 48
"""Longest sum without a loop: all of size l's."""


@pytree
class Velocity:
    """Velocities of all bodies, or how far they move."""

    linear: Vec
    angular: Float[Array, "b n"]

    def __add__(self, other: "Velocity") -> "Velocity":
        return Velocity(linear=self.linear + other.linear, angular=self.angular + other.angular)

    def __mul__(self, scale: Float[Array, "..."]) -> "Velocity":
        """The same direction; with a duration: how far everything moves."""
        return Velocity(linear=self.linear * scale, angular=self.angular * scale)


@pytree
class Masses:
    """Inverse masses as the solver uses them."""

    linear: Float[Array, "b n"]
    angular: Float[Array, "b n"]


@pytree
class Links:
    """Pairs of bodies, each of which any number of rows may act on."""

    body_a: Int[Array, "k n"]
    body_b: Int[Array, "k n"]


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
    groups: tuple[tuple[int, int], ...] = static()
    """Of links that have as many rows each, as (links, rows of each): first rows of all links of
    the first group, then their second rows …, then the next group."""
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


def make_rows(masses: Masses, store: Store, *groups: tuple[Links, Sequence[Directions]]) -> Rows:
    """Rows along all directions of each group of links, with their bodies' masses looked up."""
    links = jax.tree.map(lambda *x: jnp.concatenate(x, axis=0), *(links for links, _ in groups))
    shape = tuple((links.body_a.shape[0], len(directions)) for links, directions in groups)
    parts = [part for _, directions in groups for part in directions]
    along = jax.tree.map(lambda *x: jnp.concatenate(x, axis=0), *parts)
    links, along = store((links, along))
    of_a, of_b = _of_rows(shape, take_pair(masses, links.body_a, links.body_b))
    bodies = _of_rows(shape, links)
    return Rows(
        links=links,
        groups=shape,
        body_a=bodies.body_a,
        body_b=bodies.body_b,
        direction=along.along,
        turn_a=along.turn_a,
        turn_b=along.turn_b,
        mass_a=of_a.linear,
        mass_b=of_b.linear,
        inertia_a=of_a.angular,
        inertia_b=of_b.angular,
    )


def first_of_links(rows: Rows) -> Rows:
    """The first row of every link."""
    kept, start = [], 0
    for links, each in rows.groups:
        kept.append(slice(start, start + links))
        start += links * each

    def keep(x: Shaped[Array, "m n"]) -> Shaped[Array, "k n"]:
        return jnp.concatenate([x[part] for part in kept], axis=0)

    return _picked(rows, keep, rows.links, tuple((links, 1) for links, _ in rows.groups))


def one_row(rows: Rows, index: Int[Array, ""]) -> Rows:
    """One of the rows, with a link of its own."""
    links = Links(body_a=row(rows.body_a, index), body_b=row(rows.body_b, index))
    return _picked(rows, lambda x: row(x, index), links, ((1, 1),))


def _picked(
    rows: Rows, pick: Callable[[Array], Array], links: Links, groups: tuple[tuple[int, int], ...]
) -> Rows:
    columns = jax.tree.map(pick, dataclasses.replace(rows, links=None))
    return dataclasses.replace(columns, links=links, groups=groups)


def _of_rows(groups: tuple[tuple[int, int], ...], of_links: T) -> T:
    """What links have, repeated for their rows."""

    def repeat(x: Shaped[Array, "k n"]) -> Shaped[Array, "m n"]:
        parts, start = [], 0
        for links, each in groups:
            parts += [x[start : start + links]] * each
            start += links
        return jnp.concatenate(parts, axis=0)

    return jax.tree.map(repeat, of_links)


def _of_links(groups: tuple[tuple[int, int], ...], of_rows: T) -> T:
    """The sums of what the rows of each link have."""

    def add(x: Float[Array, "m n"]) -> Float[Array, "k n"]:
        parts, start = [], 0
        for links, each in groups:
            starts = [start + links * number for number in range(each)]
            parts.append(functools.reduce(jnp.add, [x[at : at + links] for at in starts]))
            start += links * each
        return jnp.concatenate(parts, axis=0)

    return jax.tree.map(add, of_rows)


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


def diagonal(rows: Rows) -> Float[Array, "m n"]:
    """The diagonal of `coupling(rows, rows)`."""
    straight = dot(rows.direction, rows.direction)
    apart = (rows.mass_a + rows.mass_b) * straight + (
        rows.inertia_a * rows.turn_a**2 + rows.inertia_b * rows.turn_b**2
    )
    return jnp.where(rows.body_a == rows.body_b, 0, apart)


def speeds(rows: Rows, velocity: Velocity) -> Float[Array, "m n"]:
    """Speed of b relative to a along each row."""
    of_links = take_pair(velocity, rows.links.body_a, rows.links.body_b)
    of_a, of_b = _of_rows(rows.groups, of_links)
    along = dot(rows.direction, of_b.linear - of_a.linear)
    return along + rows.turn_b * of_b.angular - rows.turn_a * of_a.angular


def apply(rows: Rows, impulse: Float[Array, "m n"], velocity: Velocity, masses: Masses) -> Velocity:
    """The velocities after impulses on all rows."""
    bodies = np.arange(velocity.angular.shape[0], dtype=np.int32)[:, None]
    links = rows.links
    along_x, along_y, turn_a, turn_b = _of_links(
        rows.groups,
        (
            rows.direction.x * impulse,
            rows.direction.y * impulse,
            rows.turn_a * impulse,
            rows.turn_b * impulse,
        ),
    )

    def add(k: Int[Array, ""], total: tuple[Array, Array, Array]) -> tuple[Array, Array, Array]:
        x, y, turn = total
        on_a, on_b = bodies == row(links.body_a, k), bodies == row(links.body_b, k)

        def share(to_a: Array, to_b: Array) -> Array:
            return jnp.where(on_b, row(to_b, k), 0) - jnp.where(on_a, row(to_a, k), 0)

        return (
            x + share(along_x, along_x),
            y + share(along_y, along_y),
            turn + share(turn_a, turn_b),
        )

    nothing = jnp.zeros_like(velocity.angular)
    x, y, turn = accumulate(along_x.shape[0], add, (nothing, nothing, nothing))
    return Velocity(
        linear=Vec(
            x=velocity.linear.x + x * masses.linear, y=velocity.linear.y + y * masses.linear
        ),
        angular=velocity.angular + turn * masses.angular,
    )


def inner(left: Float[Array, "m n"], right: Float[Array, "m n"]) -> Float[Array, " n"]:
    """The sum over the rows of the products, in every world."""
    nothing = jnp.zeros(left.shape[1:], left.dtype)
    return _sum(left.shape[0], lambda k: (row(left, k) * row(right, k))[0], nothing)


def matvec(matrix: Float[Array, "m k n"], vector: Float[Array, "k n"]) -> Float[Array, "m n"]:
    """Matrix times vector in every world.

    Column by column: a sum over the columns is not vectorised over the worlds, and takes three
    times as long.
    """

    def add(k: Int[Array, ""], total: Float[Array, "m n"]) -> Float[Array, "m n"]:
        return total + column(matrix, k) * row(vector, k)

    nothing = jnp.zeros((matrix.shape[0], matrix.shape[2]), vector.dtype)
    return accumulate(matrix.shape[1], add, nothing)


def matmul(left: Float[Array, "m k n"], right: Float[Array, "k l n"]) -> Float[Array, "m l n"]:
    """Matrix times matrix in every world.

    Both are read from memory, so they must have been stored (`store.py`).
    """
    nothing = jnp.zeros((left.shape[0], *right.shape[1:]), right.dtype)
    return _sum(left.shape[1], lambda k: column(left, k)[:, None] * row(right, k), nothing)


def _sum(
    count: int,
    term: Callable[[Int[Array, ""] | int], Float[Array, "..."]],
    nothing: Float[Array, "..."],
) -> Float[Array, "..."]:
    """A sum of terms, written out where they are few, so that it stays in registers.

    A reduction is not vectorised over the worlds, and a loop writes its sum back after each term;
    but many terms written out would take minutes to compile.
    """
    if count > WRITTEN_OUT:
        return accumulate(count, lambda k, total: total + term(k), nothing)
    return sum((term(k) for k in range(count)), start=nothing)


def inverse(
    matrix: Float[Array, "m m n"], least_pivot: Float[Array, "m n"] | None = None
) -> Float[Array, "m m n"]:
    """Inverse of symmetric positive definite matrices by the sweep operator, no pivoting.

    Args:
        matrix: One a world.
        least_pivot: What remains of a row after the rows before it were eliminated is raised to
            this: a row that (nearly) depends on others becomes soft instead of being amplified.
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

    return -jax.lax.fori_loop(0, size, sweep, matrix)


def match(
    key: Int[Array, "c n"], old_key: Int[Array, "c n"], *values: Float[Array, "c n"]
) -> tuple[Float[Array, "c n"], ...]:
    """The old values of the entries whose key is still there, 0 for new ones and for key −1."""
    same = (key[:, None] == old_key[None]) & (key[:, None] >= 0)
    return tuple(jnp.sum(jnp.where(same, value[None], 0), axis=1) for value in values)


def any_true(mask: Bool[Array, "m n"]) -> Bool[Array, " n"]:
    """Whether any row's mask holds."""
    return jnp.any(mask, axis=0)
