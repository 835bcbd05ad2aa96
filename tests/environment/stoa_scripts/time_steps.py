"""Run by a test with the real Stoa: truncation, levels as arguments, spaces, its own adapter."""

import dataclasses

import jax
import jax.numpy as jnp
import numpy as np
from stoa import AddRNGKey, AutoResetWrapper, RecordEpisodeMetrics, StepType
from stoa.core_wrappers.vmap import VmapWrapper
from stoa.env_adapters.kinetix import KinetixToStoa
from stoa.spaces import BoundedArraySpace, DictSpace, DiscreteSpace, MultiDiscreteSpace

from kinetix import (
    load_from_json_file,
    make_kinetix_env,
    make_reset_fn_list_of_levels,
    static_env_params_from_size,
)
from kinetix.environment.stoa import as_stoa_env, stoa_space

KEY = jax.random.PRNGKey(0)
level, static, params = load_from_json_file("s/goalkeeper", physics="jax2d")
labels = dataclasses.replace(level.labels, max_timesteps=jnp.int32(2))
short = dataclasses.replace(level, labels=labels)


def made(reset_fn, action="multi_discrete", observation="symbolic_flat"):
    return make_kinetix_env(action, observation, reset_fn, params, static)


env = as_stoa_env(made(None))
state, first = env.reset(KEY, short)
assert first.first() and float(first.discount) == 1.0
action = env.action_space().sample(KEY)
assert env.action_space().contains(action)
state, middle = env.step(state, action)
assert middle.mid()
state, last = env.step(state, action)
assert last.truncated() and not last.terminated(), last.step_type
assert float(last.discount) == 1.0
assert last.step_type.dtype == StepType.TRUNCATED.dtype
assert jax.tree.structure(first) == jax.tree.structure(last)
assert set(last.extras) == {"solve_rate", "distance"}

batch = VmapWrapper(
    AutoResetWrapper(RecordEpisodeMetrics(AddRNGKey(as_stoa_env(made(lambda _: short)))))
)
states, steps = jax.jit(batch.reset)(jax.random.split(KEY, 3))
assert steps.observation.shape[0] == 3
actions = jnp.zeros((3, 6), jnp.int32)
for _ in range(2):
    states, steps = jax.jit(batch.step)(states, actions)
assert steps.last().all()

assert isinstance(stoa_space(made(None).action_space()), MultiDiscreteSpace)
assert isinstance(stoa_space(made(None, "discrete").action_space()), DiscreteSpace)
assert isinstance(stoa_space(made(None, "continuous").action_space()), BoundedArraySpace)
assert isinstance(
    stoa_space(made(None, observation="symbolic_entity").observation_space()), DictSpace
)

theirs = KinetixToStoa(made(make_reset_fn_list_of_levels(["s/goalkeeper"], static)), params)
state, first = theirs.reset(KEY)
state, following = theirs.step(state, jnp.zeros(6, jnp.int32))
assert following.mid() and np.isfinite(following.observation).all()
assert static_env_params_from_size("s").capacity == static.capacity
