"""Programs that forbid themselves to mix ranks or types: they can play, and stay as strict."""

import jax
import jax.numpy as jnp
import numpy as np
import pytest

import kinetix
from kinetix.environment.env import make_kinetix_env
from kinetix.environment.params import EnvParams, static_env_params_of
from kinetix.environment.reset import make_reset_fn_sample_kinetix_level, make_reset_fn_sample_sizes
from kinetix.level.sizes import SIZES


@pytest.fixture(autouse=True)
def _strict():
    with jax.numpy_rank_promotion("raise"), jax.numpy_dtype_promotion("strict"):
        yield


@pytest.mark.parametrize("action", ["multi_discrete", "continuous"])
def test_random_levels_are_played(action):
    static = static_env_params_of(SIZES["s"])
    reset = make_reset_fn_sample_kinetix_level(EnvParams(), static)
    env = make_kinetix_env(action, "symbolic_flat", reset, EnvParams(), static)

    def play(key):
        _, state = env.reset(key)
        return env.step(key, state, env.action_space().sample(key))

    jax.jit(jax.vmap(play)).lower(jax.random.split(jax.random.key(0), 3))


def test_a_run_from_python():
    run = kinetix.simulate("s/goalkeeper", seconds=0.05)
    assert np.isfinite(run.position).all() and len(run.position) == len(run.time) > 1


def test_random_levels_are_drawn_where_numbers_are_no_keys():
    static = static_env_params_of(SIZES["s"])
    of_size = make_reset_fn_sample_kinetix_level(EnvParams(), static)
    for draw in (of_size, make_reset_fn_sample_sizes(static)):
        with jax.legacy_prng_key("error"):
            jax.jit(draw).lower(jax.random.key(0))


def test_the_callers_own_code_is_still_refused(small_env):
    key = jax.random.key(0)
    jax.jit(small_env.reset).lower(key)
    with pytest.raises(ValueError, match="rank_promotion"):
        _ = jnp.ones(3) + jnp.ones((2, 3))
