"""Rows, and small matrices of many worlds, against numpy."""

import dataclasses
from collections.abc import Callable

import jax
import jax.numpy as jnp
import numpy as np
import pytest

from kinetix.engine.active_rows import InUse
from kinetix.engine.maths import Vec
from kinetix.engine.solvers.rows import (
    Directions,
    Links,
    Masses,
    Rows,
    Velocity,
    apply,
    first_of_links,
    inverse,
    make_rows,
    matvec,
    speeds,
)
from kinetix.engine.store import Store

WORLDS, BODIES = 3, 4


@pytest.mark.parametrize("shape", [(5, 7), (5, 0), (0, 7), (0, 0)])
def test_products_are_those_of_each_world(shape: tuple[int, int]) -> None:
    random = np.random.default_rng(0)
    left = random.normal(size=(*shape, WORLDS)).astype(np.float32)
    vector = random.normal(size=(shape[1], WORLDS)).astype(np.float32)
    found = matvec(jnp.asarray(left), jnp.asarray(vector))
    np.testing.assert_allclose(found, np.einsum("ikn,kn->in", left, vector), atol=1e-5)


@pytest.mark.parametrize("size", [0, 1, 6])
def test_the_inverse_is_that_of_each_world(size: int) -> None:
    half = np.random.default_rng(1).normal(size=(size, size, WORLDS)).astype(np.float32)
    matrix = np.einsum("ikn,jkn->ijn", half, half) + np.eye(size, dtype=np.float32)[..., None]
    found = np.asarray(inverse(jnp.asarray(matrix)))
    unit = np.einsum("ikn,kjn->ijn", found, matrix)
    np.testing.assert_allclose(
        unit, np.broadcast_to(np.eye(size)[..., None], unit.shape), atol=1e-3
    )


def some(random: np.random.Generator, *shape: int) -> jnp.ndarray:
    """Random numbers in every world."""
    return jnp.asarray(random.normal(size=(*shape, WORLDS)), jnp.float32)


def some_rows(random: np.random.Generator, masses: Masses, *groups: tuple[int, int, int]) -> Rows:
    """Random rows of groups, each given by its links, how many are in use, and rows of each."""

    def group(count: int, used: int, each: int) -> Links:
        body_a = jnp.asarray(random.integers(0, BODIES, (count, WORLDS)), jnp.int32)
        last = jnp.broadcast_to(jnp.arange(count)[:, None] == used - 1, (count, WORLDS))
        in_use = InUse.of((last, each))
        return Links(body_a=body_a, body_b=(body_a + 1) % BODIES, in_use=in_use)

    links = Links.joined(*(group(*sizes) for sizes in groups))
    directions = [
        Directions(
            along=Vec(x=some(random, count), y=some(random, count)),
            turn_a=some(random, count),
            turn_b=some(random, count),
        )
        for count, _, each in groups
        for _ in range(each)
    ]
    return make_rows(links, links.look_up(masses), directions, Store.beside(masses.linear))


def some_masses(random: np.random.Generator) -> Masses:
    """Inverse masses that are not small."""
    return Masses(linear=abs(some(random, BODIES)) + 0.1, angular=abs(some(random, BODIES)) + 0.1)


@pytest.mark.parametrize("count", [0, 1, 5])
def test_impulses_do_the_work_that_the_rows_speeds_say(count: int) -> None:
    random = np.random.default_rng(2)
    masses = some_masses(random)
    rows = some_rows(random, masses, (count, count, 2), (2 * count, 2 * count, 1))
    place = Vec(x=some(random, BODIES), y=some(random, BODIES))
    before = Velocity(linear=place, angular=some(random, BODIES))
    impulse = some(random, 4 * count)
    after = apply(rows, impulse, before, masses)

    def energy(velocity: Velocity) -> np.ndarray:
        x, y, turn = velocity.linear.x, velocity.linear.y, velocity.angular
        total = (x**2 + y**2) / masses.linear + turn**2 / masses.angular
        return np.asarray(jnp.sum(total, axis=0)) / 2

    # Kinetic energy changes by the impulses times the mean of the speeds before and after.
    mean = (speeds(rows, before) + speeds(rows, after)) / 2
    work = np.asarray(jnp.sum(impulse * mean, axis=0))
    np.testing.assert_allclose(energy(after) - energy(before), work, rtol=1e-3, atol=1e-4)
    if count == 0:
        np.testing.assert_array_equal(after.angular, before.angular)
    first = speeds(first_of_links(rows), before)
    every = np.asarray(speeds(rows, before))
    np.testing.assert_array_equal(first, np.concatenate([every[:count], every[2 * count :]]))


def test_links_that_no_world_uses_change_nothing() -> None:
    """Of three and two links two and one are used: the others might as well not be there."""
    masses = some_masses(np.random.default_rng(3))
    wide = some_rows(np.random.default_rng(4), masses, (3, 2, 2), (2, 1, 1))
    rows = [0, 1, 3, 4, 6]

    def used(x: jnp.ndarray) -> jnp.ndarray:
        return x[jnp.asarray(rows)] if x.shape[0] == 8 else x[jnp.asarray([0, 1, 3])]

    links = Links(
        body_a=used(wide.links.body_a),
        body_b=used(wide.links.body_b),
        in_use=InUse.of((jnp.ones((2, WORLDS), bool), 2), (jnp.ones((1, WORLDS), bool), 1)),
    )
    columns = jax.tree.map(used, dataclasses.replace(wide, links=None))
    narrow = dataclasses.replace(columns, links=links)
    random = np.random.default_rng(5)
    place = Vec(x=some(random, BODIES), y=some(random, BODIES))
    velocity = Velocity(linear=place, angular=some(random, BODIES))
    found = np.asarray(speeds(wide, velocity))
    np.testing.assert_array_equal(found[rows], speeds(narrow, velocity))
    np.testing.assert_array_equal(found[[2, 5, 7]], 0)
    impulse = some(random, 8)
    for one, other in zip(
        jax.tree.leaves(apply(wide, impulse, velocity, masses)),
        jax.tree.leaves(apply(narrow, used(impulse), velocity, masses)),
        strict=True,
    ):
        np.testing.assert_array_equal(one, other)


@pytest.mark.parametrize("counts", [(0, 0), (2, 0), (0, 1), (2, 1), (3, 2)])
def test_what_is_in_use_is_visited_in_the_order_of_the_rows(counts: tuple[int, int]) -> None:
    groups = [(3, counts[0], 2), (2, counts[1], 1)]
    in_use = InUse.of(
        *(
            (jnp.broadcast_to(jnp.arange(links)[:, None] < used, (links, WORLDS)), each)
            for links, used, each in groups
        )
    )

    def note(index: jnp.ndarray, carry: tuple) -> tuple:
        seen, number = carry
        return seen.at[number].set(index), number + 1

    def visited(loop: Callable) -> list[int]:
        seen, count = loop(note, (jnp.full(10, -1), jnp.zeros((), jnp.int32)))
        return np.asarray(seen)[: int(count)].tolist()

    of_rows = [start + k for start, used in ((0, counts[0]), (3, counts[0])) for k in range(used)]
    assert visited(in_use.each) == of_rows + [6 + k for k in range(counts[1])]
    of_links = list(range(counts[0])) + [3 + k for k in range(counts[1])]
    assert visited(in_use.each_link) == of_links
    random = np.random.default_rng(6)
    half = some(random, 8, 8)
    matrix = half + jnp.swapaxes(half, 0, 1)
    mask = (
        jnp.zeros((8, 1)).at[jnp.asarray(of_rows + [6 + k for k in range(counts[1])], int)].set(1)
    )
    vector = some(random, 8) * mask
    np.testing.assert_allclose(
        in_use.product(matrix, vector), jnp.einsum("ikn,kn->in", matrix, vector), atol=1e-5
    )
    np.testing.assert_allclose(in_use.inner(vector, vector), jnp.sum(vector**2, axis=0), rtol=1e-5)
