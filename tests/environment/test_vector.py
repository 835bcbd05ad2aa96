"""`vectorize` steps every world as `vmap` does, on as many devices as there are."""

import json
import os
import subprocess
import sys

import jax
import jax.numpy as jnp
import numpy as np
import pytest

import kinetix
from kinetix.environment.reset import static_env_params_for_levels

_PROGRAM = """
import json, sys
import kinetix

kinetix.use_all_cores(int(sys.argv[1]))
import jax

static = kinetix.static_env_params_from_size("4,1,0,0", physics="jax2d")
params = kinetix.EnvParams()
draw = kinetix.make_reset_fn_sample_kinetix_level(params, static)
env = kinetix.make_kinetix_env("discrete", "symbolic_flat", draw, params, static)
env = kinetix.LogWrapper(env)
many = kinetix.vectorize(env)


@jax.jit
def rollout(key):
    _, states = many.reset(jax.random.split(key, 4))

    def step(states, key):
        keys = jax.random.split(key, 4)
        actions = jax.vmap(many.action_space().sample)(keys)
        observation, states, *_ = many.step(keys, states, actions)
        return states, observation

    return jax.lax.scan(step, states, jax.random.split(key, 3))


states, seen = rollout(jax.random.key(0))
again = many.get_obs(states.env_state)
on = len(seen.sharding.device_set)
print(json.dumps({"on": on, "seen": seen.tolist(), "last": again.tolist()}))
try:
    many.reset(jax.random.split(jax.random.key(0), 3))
except kinetix.KinetixError as error:
    print(error, file=sys.stderr)
"""


def _on(devices: int) -> tuple[dict, str]:
    variables = {name: value for name, value in os.environ.items() if name != "XLA_FLAGS"}
    done = subprocess.run(
        [sys.executable, "-c", _PROGRAM, str(devices)],
        env=variables,
        capture_output=True,
        text=True,
        check=True,
    )
    return json.loads(done.stdout), done.stderr


@pytest.mark.slow
def test_many_worlds_on_two_devices_are_those_on_one():
    one, _ = _on(1)
    two, said = _on(2)
    assert (one["on"], two["on"]) == (1, 2)
    np.testing.assert_allclose(two["seen"], one["seen"], atol=1e-5)
    np.testing.assert_allclose(two["last"], np.array(two["seen"])[-1], atol=1e-6)
    assert "3 worlds: expected a multiple of the 2 devices, such as 4" in said


@pytest.fixture(scope="module")
def batch():
    """A vectorised environment whose step is never compiled, and arguments that fit it."""
    static = kinetix.static_env_params_from_size("4,1,0,0", physics="jax2d")
    params = kinetix.EnvParams()
    draw = kinetix.make_reset_fn_sample_kinetix_level(params, static)
    env = kinetix.make_kinetix_env("discrete", "symbolic_flat", draw, params, static)
    keys = jax.random.split(jax.random.key(0), 4)
    state = jax.tree.map(lambda leaf: jnp.stack([leaf] * 4), draw(keys[0]))
    return kinetix.vectorize(env), keys, state, jnp.zeros(4, int)


def test_a_wrong_batch_gets_one_sentence(batch):
    many, keys, states, actions = batch
    one = jax.tree.map(lambda leaf: leaf[0], states)
    fewer = jax.tree.map(lambda leaf: leaf[:3], states)
    wrong = {
        "action: expected one per world, 4 of them, got 3": (keys, states, actions[:3]),
        "action: expected one per world, got a single one": (keys, states, actions[0]),
        "action: expected an array, got a list": (keys, states, [0, 0, 0, 0]),
        "state: expected one per world, 3 of them, got 4": (keys[:3], states, actions),
        "state: expected one per world, got a single one": (keys, one, actions),
        "key: expected one per world, got a single one: jax.random.split": (
            keys[0],
            states,
            actions,
        ),
        "key: expected one per world, got none": (keys[:0], states, actions),
        "override_reset_state: expected one per world, 4 of them": (
            keys,
            states,
            actions,
            None,
            fewer,
        ),
        "step: expected arrays and numbers, got 'left'": (keys, states, "left"),
        "action of type float32: expected integers": (keys, states, actions * 1.0),
    }
    for sentence, arguments in wrong.items():
        with pytest.raises(kinetix.KinetixError) as told:
            many.step(*arguments)
        assert str(told.value).startswith(sentence)
    with pytest.raises(kinetix.KinetixError, match="key: expected one per world"):
        many.reset(jax.random.PRNGKey(0))
    with pytest.raises(kinetix.KinetixError, match="state: expected one per world"):
        many.get_obs(one)


def test_vectorised_twice_is_once(batch):
    many, *_ = batch
    assert kinetix.vectorize(many) is many
    with pytest.raises(kinetix.KinetixError, match="env: it steps many worlds already"):
        kinetix.vectorize(kinetix.LogWrapper(many))


def test_a_vectorised_environment_can_be_logged(batch):
    """Counters are one a world from the start, as a loop needs its state."""
    many, keys, _, actions = batch
    logged = kinetix.LogWrapper(many)
    begun, shapes = (
        jax.eval_shape(function, keys)
        for function in (
            lambda keys: logged.reset(keys)[1],
            lambda keys: logged.step(keys, logged.reset(keys)[1], actions)[1],
        )
    )
    assert begun == shapes
    assert {leaf.shape[0] for leaf in jax.tree.leaves(begun)} == {4}


def test_methods_by_others_names_are_those_of_many_worlds(batch):
    many, keys, states, actions = batch
    one = jax.tree.map(lambda leaf: leaf[0], states)
    for env in (many, kinetix.LogWrapper(many), kinetix.vectorize(kinetix.LogWrapper(many.env))):
        begun = jax.eval_shape(env.reset, keys)[1]
        for function, arguments in (
            (env.reset_to_level, (keys, one)),
            (env.reset_to_level, (keys, states, kinetix.EnvParams())),
            (env.reset_env, (keys,)),
            (env.step_env, (keys, begun, actions)),
        ):
            assert jax.eval_shape(function, *arguments)[1] == begun
    with pytest.raises(kinetix.KinetixError, match="action: expected one per world, 4 of them"):
        many.step_env(keys, states, actions[:3])


def test_values_are_looked_at_in_calls_from_python(batch):
    many, keys, states, actions = batch
    actions = np.array(actions)  # JAX's own are not waited for
    bad = np.where(np.arange(4) == 2, 11, actions)
    params = kinetix.EnvParams()
    logged = kinetix.vectorize(kinetix.LogWrapper(many.env))
    for each in (many, logged):
        with pytest.raises(kinetix.KinetixError, match=r"action of world 2, 11: .* up to 10"):
            each.step(keys, states, bad)
        with pytest.raises(kinetix.KinetixError, match=r"action of world 2, 11: .* up to 10"):
            each.step(keys, states, jax.block_until_ready(jnp.array(bad)))
        with pytest.raises(kinetix.KinetixError, match=r"env_params\.dt: expected seconds above 0"):
            each.step(keys, states, actions, params.replace(dt=-1.0))
        with pytest.raises(kinetix.KinetixError, match=r"env_params\.dt: expected seconds above 0"):
            each.reset(keys, env_params=params.replace(dt=-1.0))
    mapped = kinetix.vectorize(_Mapped(many.env))
    mapped.check_values((keys, states, actions + 11), {})
    with pytest.raises(kinetix.KinetixError, match=r"env_params\.dt: expected seconds above 0"):
        mapped.step(keys, states, actions + 11, params.replace(dt=-1.0))


class _Mapped:
    """A wrapper with actions of its own."""

    def __init__(self, env):
        self.env = env

    def __getattr__(self, name):
        return getattr(self.env, name)


def test_a_batch_that_a_step_would_leave_parts_out_of_is_refused():
    builder = kinetix.LevelBuilder("Ball")
    builder.circle(1, 1, 0.3, role="green")
    ball = builder.build()
    builder.rectangle(1, 0.2, 1, 0.2, fixed=True)
    plank = builder.build()
    full = kinetix.static_env_params_from_size("5,1,0,0", physics="jax2d")
    static = static_env_params_for_levels(ball, full)
    draw = kinetix.make_reset_fn_list_of_levels(ball, static)
    params = kinetix.EnvParams()
    env = kinetix.make_kinetix_env("discrete", "blind", draw, params, static)
    keys = jax.random.split(jax.random.key(0), 2)
    balls, mixed = (
        kinetix.make_reset_fn_list_of_levels(levels, full).levels
        for levels in ([ball, ball], [ball, plank])
    )
    one = jax.tree.map(lambda leaf: leaf[1], mixed)
    for each in (kinetix.vectorize(env), kinetix.vectorize(kinetix.LogWrapper(env))):
        for start in (mixed, one):
            with pytest.raises(kinetix.KinetixError, match="leaves out some of its contacts"):
                each.reset(keys, params, start)
            with pytest.raises(kinetix.KinetixError, match="leaves out some of its contacts"):
                each.step(keys, balls, jnp.zeros(2, int), params, start)
        each.check_values((keys, params, balls), {})
