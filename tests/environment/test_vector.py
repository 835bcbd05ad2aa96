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
