"""A batch of episodes on their way: the one way in which players are measured and recorded.

Every device always has the same number of rows and one compiled function advances them by any
number of steps, so an episode is the same to the bit however it is asked for: alone, among others,
all at once or step by step.
"""

import dataclasses
import functools
from collections.abc import Sequence
from typing import Any

import jax
import jax.numpy as jnp
import numpy as np
from jaxtyping import Array, Bool, Float, Int

from kinetix.agents.player import Policy
from kinetix.environment.devices import in_shares
from kinetix.environment.env import KinetixEnv
from kinetix.environment.outcome import outcome_index
from kinetix.environment.state import EnvState
from kinetix.pytree import pytree, typed_like


@pytree
class LastStep:
    """The last step of each episode."""

    action: Any
    """The player's own form of action."""
    reward: Float[Array, " n"]
    distance: Float[Array, " n"]
    """Distance of the green and blue shapes [m]."""
    info: dict[str, Any]
    """Anything else that the policy returns; empty for scripted ones."""


@pytree
class Episodes:
    """A batch of episodes on their way."""

    state: EnvState
    observation: Any
    carry: Any
    keys: Array
    begins: Bool[Array, " n"]
    over: Bool[Array, " n"]
    """Ended, or a row that does not count."""
    ending: Int[Array, " n"]
    """From `outcome_index`; 0 while the episode goes on."""
    dropped: Int[Array, " n"]
    """Steps without room for all contacts."""
    returns: Float[Array, " n"]
    lengths: Int[Array, " n"]
    last: LastStep


def rows(policy: Policy) -> int:
    """Count the episodes that run at once on all devices of this process."""
    return policy.rows * jax.local_device_count()


def start(
    env: KinetixEnv,
    policy: Policy,
    params: Any,
    states: Sequence[EnvState],
    keys: Array,
    over: Bool[np.ndarray, " n"],
) -> Episodes:
    """Begin a batch.

    Args:
        env: The environment.
        policy: Policy that chooses the actions.
        params: Parameters of the policy.
        states: `rows(policy)` first states, as numpy arrays.
        keys: A key a row, from `episode_keys`.
        over: True for padding rows, whose results do not count.
    """
    state = jax.tree.map(lambda *x: np.stack(x), *states)
    return _start(env, policy, params, state, keys, over)


@functools.partial(jax.jit, static_argnums=(0, 1))
def _start(
    env: KinetixEnv,
    policy: Policy,
    params: Any,
    state: EnvState,
    keys: Array,
    over: Bool[Array, " n"],
) -> Episodes:
    begin = functools.partial(_begin, env, policy)
    return in_shares(begin, replicated=(0,), devices=jax.local_devices())(params, state, keys, over)


def _begin(
    env: KinetixEnv,
    policy: Policy,
    params: Any,
    state: EnvState,
    keys: Array,
    over: Bool[Array, " n"],
) -> Episodes:
    observation = jax.vmap(env.get_obs)(state)
    count = policy.rows
    carry, no, zero = policy.init_carry(count), jnp.zeros(count, bool), jnp.zeros(count)
    shapes = jax.eval_shape(policy.decide, params, carry, observation, keys, no)
    action, _, info = jax.tree.map(lambda x: jnp.zeros(x.shape, x.dtype), shapes)
    return Episodes(
        state=state,
        observation=observation,
        carry=carry,
        keys=keys,
        begins=~no,
        over=over,
        ending=jnp.zeros(count, jnp.int32),
        dropped=jnp.zeros(count, jnp.int32),
        returns=zero,
        lengths=jnp.zeros(count, jnp.int32),
        last=LastStep(action=action, reward=zero, distance=zero, info=info),
    )


@functools.partial(jax.jit, static_argnums=(0, 1), static_argnames="deterministic")
def advance(
    env: KinetixEnv,
    policy: Policy,
    params: Any,
    episodes: Episodes,
    steps: Int[Array, ""] | int,
    *,
    deterministic: bool = False,
) -> Episodes:
    """Play some environment steps of every episode; those that are over count no more.

    Args:
        env: The environment.
        policy: Policy that chooses the actions.
        params: Parameters of the policy.
        episodes: Where they are.
        steps: How many steps; any number runs the same compiled code.
        deterministic: Take the likeliest action instead of drawing one.
    """

    def play(params: Any, steps: Int[Array, ""], episodes: Episodes) -> Episodes:
        step = functools.partial(_step, env, policy, params, deterministic)
        return jax.lax.fori_loop(0, steps, step, episodes)

    shares = in_shares(play, replicated=(0, 1), devices=jax.local_devices())
    return shares(params, jnp.asarray(steps, jnp.int32), episodes)


def _step(
    env: KinetixEnv,
    policy: Policy,
    params: Any,
    deterministic: bool,
    _: Array,
    episodes: Episodes,
) -> Episodes:
    keys = jax.vmap(jax.random.fold_in)(episodes.keys, episodes.lengths)
    action, carry, said = policy.decide(
        params,
        episodes.carry,
        episodes.observation,
        keys,
        episodes.begins,
        deterministic=deterministic,
    )
    stepped = jax.vmap(env.step)(keys, episodes.state, action)
    observation, state, reward, done, info = stepped
    running = ~episodes.over
    after = dataclasses.replace(
        episodes,
        state=state,
        observation=observation,
        carry=carry,
        begins=jnp.zeros_like(episodes.begins),
        over=episodes.over | done,
        ending=jnp.where(running, outcome_index(info), episodes.ending),
        dropped=episodes.dropped + (running & info["overflow"]),
        returns=episodes.returns + jnp.where(running, reward, 0.0),
        lengths=episodes.lengths + running,
        last=LastStep(action=action, reward=reward, distance=info["distance"], info=said),
    )
    return typed_like(after, episodes)


def episode_keys(levels: Sequence[int], attempts: Sequence[int], seed: int) -> Array:
    """Return a key for every episode, from the level's content, the attempt and the seed alone.

    The action of step t (from 0) is drawn with `fold_in(key, t)`.

    Args:
        levels: A number a level, from its content.
        attempts: As many numbers of attempts.
        seed: Of the whole evaluation.
    """
    numbers = jnp.asarray(levels, jnp.uint32), jnp.asarray(attempts, jnp.uint32)
    return _fold(jax.random.PRNGKey(seed), *numbers)


@jax.jit
@functools.partial(jax.vmap, in_axes=(None, 0, 0))
def _fold(base: Array, level: Array, attempt: Array) -> Array:
    return jax.random.fold_in(jax.random.fold_in(base, level), attempt)
