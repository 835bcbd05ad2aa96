"""A whole environment step as a kernel computes what XLA computes, for every solver."""

import dataclasses

import jax
import jax.numpy as jnp
import numpy as np
import pytest

from kinetix.engine.solvers import SOLVERS
from kinetix.environment.env import make_kinetix_env
from kinetix.environment.kernels import playing
from kinetix.environment.params import EnvParams, static_env_params_from_size
from kinetix.environment.reset import level_state
from kinetix.paths import levels_dir
from tests.engine.native.emulated import Emulated, needs_compiler

SMALL = [("s", name) for name in SOLVERS]
"""The presets have the same programs with other numbers."""

LARGE = [("m", "fast"), ("l", "balanced")]
LEVELS = 3
STEPS = 12


@needs_compiler
@pytest.mark.slow
@pytest.mark.parametrize(("size", "physics"), [*SMALL, *LARGE])
def test_a_step_is_the_same(tmp_path, size, physics):
    compare(tmp_path, size, physics)


@needs_compiler
def test_the_order_of_lanes_and_where_arrays_lie_do_not_matter(tmp_path):
    compare(tmp_path, "s", "fast", backwards=True, largest=64)


def compare(folder, size, physics, **options):
    static = static_env_params_from_size(size, physics=physics, frame_skip=2)
    env = make_kinetix_env("multi_discrete", "symbolic_flat", None, EnvParams(), static)
    files = sorted((levels_dir() / size).glob("*.json"))
    states = [level_state(file, static) for file in files[:: len(files) // LEVELS]]
    shape = env.action_space().shape

    def step(*leaves):
        state, action = jax.tree.unflatten(structure, leaves)
        return jax.tree.leaves(advance(state, action))

    def advance(state, action):
        return playing(env.actions, env.observations, static)(state, action, env.env_params)

    example = states[0], jnp.zeros(shape, jnp.int32)
    structure = jax.tree.structure(example)
    results = jax.tree.structure(jax.eval_shape(advance, *example))
    emulated = Emulated(step, jax.tree.leaves(example), folder, **options)
    by_xla, random = jax.jit(step), np.random.default_rng(0)
    for start in states:
        state = start
        for _ in range(STEPS):
            action = random.integers(0, 2, shape, np.int32)
            leaves = jax.tree.leaves((state, action))
            wanted = jax.tree.unflatten(results, by_xla(*leaves))
            found = jax.tree.unflatten(results, emulated(*leaves))
            check(wanted, found)
            state = dataclasses.replace(state, **wanted[0])


def check(wanted, found):
    """Poses and velocities agree to rounding; so do reward, end and what the agent sees."""
    for name, bound in (("position", 1e-5), ("rotation", 1e-5), ("velocity", 1e-3)):
        a, b = (getattr(x[0]["physics"], name) for x in (wanted, found))
        np.testing.assert_allclose(b, a, rtol=bound, atol=bound, err_msg=name)
    np.testing.assert_allclose(found[1], wanted[1], rtol=1e-3, atol=1e-3)
    np.testing.assert_allclose(found[2], wanted[2], atol=1e-4)
    assert found[3] == wanted[3]
