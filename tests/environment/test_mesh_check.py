"""Meshes that an environment does not take are refused in a sentence, and others are not."""

import jax
import numpy as np
import pytest
from jax.sharding import AxisType, NamedSharding
from jax.sharding import PartitionSpec as P

import kinetix
from kinetix.errors import KinetixError


@pytest.fixture(scope="module")
def env():
    _, static, params = kinetix.load_from_json_file("s/goalkeeper")
    reset = kinetix.make_reset_fn_list_of_levels(["s/goalkeeper"], static)
    return kinetix.make_kinetix_env("multi_discrete", "symbolic_flat", reset, params, static)


@pytest.fixture(scope="module")
def states(env):
    return jax.jit(jax.vmap(env.reset))(jax.random.split(jax.random.key(0), 2))[1]


def mesh(kind):
    return jax.make_mesh((1,), ("x",), axis_types=(kind,))


def test_a_shard_map_that_checks_what_varies_is_refused(env, states):
    def observed(**options):
        share = jax.shard_map(
            jax.vmap(env.get_obs),
            mesh=mesh(AxisType.Auto),
            in_specs=P("x"),
            out_specs=P("x"),
            **options,
        )
        return jax.jit(share)(states)

    with pytest.raises(KinetixError, match="check_vma=False"):
        observed()
    expected = jax.jit(jax.vmap(env.get_obs))(states)
    np.testing.assert_array_equal(observed(check_vma=False), expected)


def test_explicit_axes_are_refused(env):
    explicit = mesh(AxisType.Explicit)
    keys = jax.random.split(jax.random.key(0), 2)
    shared = jax.device_put(keys, NamedSharding(explicit, P("x")))
    for reset in (jax.jit(jax.vmap(env.reset)), kinetix.vectorize(env).reset):
        with pytest.raises(KinetixError, match=r"AxisType\.Auto"):
            reset(shared)
    with jax.set_mesh(explicit), pytest.raises(KinetixError, match=r"AxisType\.Auto"):
        env.reset(keys[0])


def test_a_mesh_with_automatic_axes_is_taken(env, states):
    with jax.set_mesh(mesh(AxisType.Auto)):
        env.get_obs(jax.tree.map(lambda x: x[0], states))
