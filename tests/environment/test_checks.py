"""Wrong arguments of `reset` and `step` get one sentence with what to do."""

import functools

import jax
import jax.numpy as jnp
import numpy as np
import pytest

from kinetix import EnvParams, StaticEnvParams, make_kinetix_env
from kinetix.environment.params import static_env_params_from_size
from kinetix.environment.reset import level_state
from kinetix.errors import KinetixError
from tests.environment.conftest import small_level

KEY = jax.random.key(0)
ACTION = jnp.zeros(6, jnp.int32)


def sentence(env, *arguments):
    with pytest.raises(KinetixError) as error:
        env.step(*arguments)
    return str(error.value)


def test_actions(small_env, small_state):
    step = (KEY, small_state)
    assert sentence(small_env, *step, ACTION[:5]) == (
        "action of shape (5,): expected (6,) (multi_discrete); see env.action_space()"
    )
    assert "use jax.vmap(env.step) for a batch" in sentence(small_env, *step, ACTION[None])
    assert "expected integers (multi_discrete)" in sentence(small_env, *step, ACTION * 1.0)


def test_arguments_in_another_order(small_env, small_state):
    assert "state: expected an EnvState, got an array of shape (6,)" in sentence(
        small_env, KEY, ACTION, small_state
    )
    assert "env_params: expected EnvParams, got StaticEnvParams" in sentence(
        small_env, KEY, small_state, ACTION, StaticEnvParams()
    )
    with pytest.raises(KinetixError, match=r"got EnvState; the order is .*reset\(key, env_params"):
        small_env.reset(KEY, small_state, EnvParams())


def test_a_level_where_only_one_argument_can_be_passed(small_env, small_state):
    """Wrappers such as Stoa's pass whatever they get in the place of the parameters."""
    _, state = small_env.reset(KEY, small_state)
    _, same = small_env.reset(KEY, None, small_state)
    jax.tree.map(np.testing.assert_array_equal, state, same)


def test_states_of_something_else(small_env, small_state):
    batch = jax.tree.map(lambda x: jnp.asarray(x)[None], small_state)
    assert "got a batch of shape (1,): use jax.vmap(env.step" in sentence(
        small_env, KEY, batch, ACTION
    )
    larger = level_state(small_level(), static_env_params_from_size("m", physics="drift"))
    assert "s (polygons, circles, joints, thrusters), got m: " in sentence(
        small_env, KEY, larger, ACTION
    )
    other = level_state(small_level(), static_env_params_from_size("s", physics="jax2d"))
    assert "another physics than the environment's: start from env.reset" in sentence(
        small_env, KEY, other, ACTION
    )
    # And that is what works.
    _, state = small_env.reset(KEY, None, other)
    small_env.step(KEY, state, ACTION)


def test_no_reset_function(small_static, small_state):
    env = make_kinetix_env("multi_discrete", "blind", None, EnvParams(), small_static)
    assert "auto_reset=False, so that episodes end" in sentence(env, KEY, small_state, ACTION)


def test_texts_of_records_are_short(small_env, small_state):
    assert repr(EnvParams()) == "EnvParams()"
    assert repr(StaticEnvParams(num_circles=3)) == "StaticEnvParams(num_circles=3)"
    assert repr(small_state) == (
        "<EnvState: slots for 5 polygons, 2 circles, 1 joints, 1 thrusters>"
    )
    batch = jax.tree.map(lambda x: jnp.asarray(x)[None], small_state)
    assert repr(batch).endswith(", batch (1,)>")
    assert repr(small_env) == "<KinetixEnv: symbolic_entity → multi_discrete, size s, drift>"


def test_keys_and_what_is_no_array(small_env, small_state):
    action = jnp.zeros(6, int)
    key = jax.random.PRNGKey(0)
    for bad in (0, None, jnp.zeros(2)):
        with pytest.raises(KinetixError, match=r"key: expected jax\.random\.key\(seed\), got"):
            small_env.step(bad, small_state, action)
    with pytest.raises(KinetixError, match=r"key: expected one key, got .*\(3, 2\): use jax\.vmap"):
        small_env.step(jax.random.split(key, 3), small_state, action)
    with pytest.raises(KinetixError, match="step: expected arrays and numbers, got 'left'"):
        small_env.step(key, small_state, "left")
    with pytest.raises(KinetixError, match=r"action: .* \(6,\) .*, got list; .* jnp\.array"):
        small_env.step(key, small_state, [0] * 6)
    with pytest.raises(KinetixError, match="action of type complex64: expected integers"):
        small_env.step(key, small_state, jnp.zeros(6, jnp.complex64))
    with pytest.raises(KinetixError, match="state: expected an EnvState, got NoneType"):
        small_env.get_obs(None)


def test_parts_of_an_environment_in_wrong_places(small_static):
    params = EnvParams()
    make = functools.partial(make_kinetix_env, "discrete", "symbolic_flat")
    with pytest.raises(KinetixError, match="expected EnvParams, got StaticEnvParams; the order is"):
        make(None, small_static, params)
    with pytest.raises(KinetixError, match="expected StaticEnvParams, got EnvParams; the order is"):
        make(None, params, params)
    for level in ("s/goalkeeper", ["s/goalkeeper"]):
        with pytest.raises(KinetixError, match=r"reset_fn: .*make_reset_fn_list_of_levels"):
            make(level, params, small_static)
    with pytest.raises(KinetixError, match="expected a number as dense_reward_scale, got 'a'"):
        make(None, EnvParams(dense_reward_scale="a"), small_static)
