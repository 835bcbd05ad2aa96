"""One-world functions that hit a kernel with the worlds on the last axis."""

import jax
import jax.numpy as jnp
import numpy as np
import pytest

from kinetix.engine.batch import TILE, where_marked, worlds_first, worlds_last
from kinetix.engine.batch import marked as made_anew
from kinetix.errors import KinetixError


@pytest.fixture(scope="module")
def function():
    def kernel(matrix, vector, scale):
        assert matrix.shape[-1] == vector.shape[-1] == scale.shape[-1]
        return {"product": jnp.sum(matrix * vector[None], axis=1) * scale, "first": vector[0]}

    return worlds_last(kernel)


def reference(matrix, vector, scale):
    return {"product": matrix @ vector * scale, "first": vector[0]}


def arguments(*batch):
    random = np.random.default_rng(0)
    return (
        random.normal(size=(*batch, 3, 4)).astype(np.float32),
        random.normal(size=(*batch, 4)).astype(np.float32),
    )


def assert_equal(found, wanted):
    for name, value in wanted.items():
        np.testing.assert_allclose(found[name], value, rtol=1e-5, atol=1e-5)


def test_alone(function):
    matrix, vector = arguments()
    assert_equal(function(matrix, vector, 2.0), reference(matrix, vector, 2.0))


@pytest.mark.parametrize("count", [0, 1, 3, TILE, TILE + 1, 3 * TILE + 7])
def test_batched_with_a_shared_argument(function, count):
    matrix, vector = arguments(count)
    found = jax.vmap(function, in_axes=(0, 0, None))(matrix, vector, 2.0)
    assert_equal(found, jax.vmap(reference, in_axes=(0, 0, None))(matrix, vector, 2.0))


def test_nested(function):
    matrix, vector = arguments(5, 7)
    found = jax.jit(jax.vmap(jax.vmap(function, in_axes=(0, None, None)), in_axes=(0, 0, None)))(
        matrix, vector[:, 0], 0.5
    )
    wanted = jax.vmap(jax.vmap(reference, in_axes=(0, None, None)), in_axes=(0, 0, None))(
        matrix, vector[:, 0], 0.5
    )
    assert_equal(found, wanted)


def test_nested_where_there_is_no_room():
    """Worlds without thrusters, say, have arrays without elements."""
    function = worlds_first(lambda tree: {"more": tree["some"] + 1, "none": tree["none"]})
    tree = {"some": np.ones((2, 3, 4)), "none": np.ones((2, 3, 0))}
    found = jax.vmap(jax.vmap(function))(tree)
    assert found["none"].shape == (2, 3, 0)
    np.testing.assert_array_equal(found["more"], tree["some"] + 1)


@pytest.mark.parametrize("count", [TILE, 3 * TILE + 7])
def test_worlds_come_back_in_their_order_whatever_their_effort(count):
    """Numbers, truth values and scalars, with the hardest worlds in between."""

    def kernel(tree):
        return {
            "total": jnp.sum(tree["numbers"], axis=0),
            "flipped": ~tree["flags"],
            "index": tree["index"] + 1,
        }

    random = np.random.default_rng(1)
    tree = {
        "numbers": random.normal(size=(count, 5, 2)).astype(np.float32),
        "flags": random.uniform(size=(count, 3)) < 0.5,
        "index": np.arange(count, dtype=np.int32),
    }
    effort = random.integers(0, 4, count)
    tree["effort"] = effort.astype(np.int32)
    seen = []

    def remembered(tree):
        seen.append(tree["effort"].shape)
        return tree["effort"]

    found = jax.vmap(worlds_last(kernel, remembered))(tree)
    np.testing.assert_allclose(found["total"], tree["numbers"].sum(axis=1), rtol=1e-5, atol=1e-5)
    np.testing.assert_array_equal(found["flipped"], ~tree["flags"])
    np.testing.assert_array_equal(found["index"], np.arange(count) + 1)
    assert bool(seen) == (count > TILE)


def test_worlds_of_like_effort_share_a_tile():
    """A kernel that tells each world the largest effort in its tile."""
    effort = np.arange(4 * TILE, dtype=np.int32) % 4

    def hardest(effort):
        return jnp.broadcast_to(jnp.max(effort, axis=-1), effort.shape)

    mixed = jax.vmap(worlds_last(lambda e, x: (hardest(e), x)))(effort, effort.astype(np.float32))
    grouped = jax.vmap(worlds_last(lambda e, x: (hardest(e), x), lambda e, x: e))(
        effort, effort.astype(np.float32)
    )
    np.testing.assert_array_equal(mixed[0], 3)
    np.testing.assert_array_equal(grouped[0], effort)


def test_a_kernel_is_traced_once():
    traced = []

    def kernel(tree):
        traced.append(tree["x"].shape)
        return {"x": tree["x"] + 1}

    function = worlds_last(kernel, like=lambda tree: tree)
    twice = jax.vmap(jax.vmap(lambda tree: function(function(tree))))
    found = jax.jit(twice)({"x": np.zeros((3, 5, 2), np.float32)})
    np.testing.assert_array_equal(found["x"], 2)
    assert traced == [(2, 15)]


def test_a_kernel_runs_where_jit_is_switched_off():
    with jax.disable_jit():
        np.testing.assert_array_equal(worlds_last(lambda x: 2 * x)(jnp.ones(3)), 2.0)


def test_marked_worlds_alone_are_made_anew():
    old = jnp.zeros((70, 3))
    marked = jnp.arange(70) % 2 == 0
    seeds = jnp.arange(70.0)
    made = jax.vmap(where_marked(lambda seed: jnp.full(3, seed + 1)))(old, marked, seeds)
    np.testing.assert_array_equal(made, jnp.where(marked[:, None], (seeds + 1)[:, None], old))


def test_of_no_worlds_none_is_made_anew():
    step = jax.jit(jax.vmap(where_marked(lambda seed: jnp.full(3, seed))))
    assert step(jnp.zeros((0, 3)), jnp.zeros(0, bool), jnp.zeros(0)).shape == (0, 3)


def test_what_is_made_anew_is_never_half_of_what_was_there():
    mark = jnp.ones(2, bool)
    one = jax.vmap(where_marked(lambda seed: jnp.full(1, seed)))
    np.testing.assert_array_equal(one(jnp.zeros((2, 4)), mark, jnp.ones(2)), jnp.ones((2, 4)))
    with pytest.raises(ValueError, match=r"[Ii]ncompatible"):
        jax.vmap(where_marked(lambda seed: jnp.full(2, seed)))(jnp.zeros((2, 4)), mark, jnp.ones(2))


@pytest.mark.parametrize("differentiate", [jax.grad, jax.jacfwd])
def test_that_there_is_no_derivative_is_one_sentence(function, differentiate):
    matrix, vector = arguments()
    with pytest.raises(KinetixError, match=r"no derivative.*stop_gradient"):
        differentiate(lambda v: function(matrix, v, 2.0)["first"])(vector)


def test_what_counts_as_a_constant_has_no_slope(function):
    matrix, vector = arguments()
    slope = jax.grad(lambda v: function(matrix, jax.lax.stop_gradient(v), 2.0)["first"])(vector)
    assert not np.any(slope)


@pytest.mark.parametrize("worlds", [1, 5, 70])
def test_worlds_are_replaced_alike_on_processors_and_accelerators(worlds):
    random = np.random.default_rng(worlds)
    old = {"a": jnp.arange(worlds * 3.0).reshape(worlds, 3), "b": jnp.arange(worlds)}
    new = {"a": -jnp.arange(12.0).reshape(4, 3), "b": jnp.arange(4, dtype=jnp.int8) + 90}
    for count in range(min(worlds, 4) + 1):
        inside = random.permutation(worlds)[:count]
        # What is not needed has a place outside.
        places = jnp.asarray([*inside, *[worlds] * (4 - count)], jnp.int32)
        wanted = made_anew._replaced_in_turn(old, new, places)
        found = jax.jit(made_anew._replaced_at_once)(old, new, places)
        for a, b in zip(jax.tree.leaves(wanted), jax.tree.leaves(found), strict=True):
            np.testing.assert_array_equal(a, b)
            assert a.dtype == b.dtype
        expected = np.arange(worlds)
        expected[inside] = np.arange(count) + 90
        np.testing.assert_array_equal(found["b"], expected)
