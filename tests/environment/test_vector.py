"""`vectorize` steps every world as `vmap` does, on as many devices as there are."""

import json
import os
import subprocess
import sys

import numpy as np
import pytest

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
