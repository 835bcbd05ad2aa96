"""Rows, and small matrices of many worlds, against numpy."""

import jax.numpy as jnp
import numpy as np
import pytest

from kinetix.engine.maths import Vec
from kinetix.engine.solvers.rows import (
    Directions,
    Links,
    Masses,
    Velocity,
    apply,
    first_of_links,
    inverse,
    make_rows,
    matmul,
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
    right = random.normal(size=(shape[1], 2, WORLDS)).astype(np.float32)
    found = matvec(jnp.asarray(left), jnp.asarray(vector))
    np.testing.assert_allclose(found, np.einsum("ikn,kn->in", left, vector), atol=1e-5)
    product = matmul(jnp.asarray(left), jnp.asarray(right))
    np.testing.assert_allclose(product, np.einsum("ikn,kln->iln", left, right), atol=1e-5)


@pytest.mark.parametrize("size", [0, 1, 6])
def test_the_inverse_is_that_of_each_world(size: int) -> None:
    half = np.random.default_rng(1).normal(size=(size, size, WORLDS)).astype(np.float32)
    matrix = np.einsum("ikn,jkn->ijn", half, half) + np.eye(size, dtype=np.float32)[..., None]
    found = np.asarray(inverse(jnp.asarray(matrix)))
    unit = np.einsum("ikn,kjn->ijn", found, matrix)
    np.testing.assert_allclose(
        unit, np.broadcast_to(np.eye(size)[..., None], unit.shape), atol=1e-3
    )


@pytest.mark.parametrize("count", [0, 1, 5])
def test_impulses_do_the_work_that_the_rows_speeds_say(count: int) -> None:
    random = np.random.default_rng(2)

    def some(*shape: int) -> jnp.ndarray:
        return jnp.asarray(random.normal(size=(*shape, WORLDS)), jnp.float32)

    def links(number: int) -> Links:
        body_a = jnp.asarray(random.integers(0, BODIES, (number, WORLDS)), jnp.int32)
        return Links(body_a=body_a, body_b=(body_a + 1) % BODIES)

    def directions(number: int) -> Directions:
        return Directions(
            along=Vec(x=some(number), y=some(number)), turn_a=some(number), turn_b=some(number)
        )

    masses = Masses(linear=abs(some(BODIES)) + 0.1, angular=abs(some(BODIES)) + 0.1)
    twice = (links(count), [directions(count), directions(count)])
    once = (links(2 * count), [directions(2 * count)])
    rows = make_rows(masses, Store.beside(masses.linear), twice, once)
    before = Velocity(linear=Vec(x=some(BODIES), y=some(BODIES)), angular=some(BODIES))
    impulse = some(4 * count)
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
