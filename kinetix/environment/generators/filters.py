"""Leave out levels that doing nothing solves.

Where kinetix-env plays all-zero actions, ours plays the action type's
no-op (for discrete actions zero drives a motor).
"""

import dataclasses
import functools
from typing import TYPE_CHECKING, Any, Final

import jax
import jax.numpy as jnp
from jaxtyping import Array, Bool, Float, Int, Key

from kinetix.environment.devices import in_shares
from kinetix.environment.params import EnvParams
from kinetix.environment.state import EnvState

if TYPE_CHECKING:
    from kinetix.environment.env import KinetixEnv
    from kinetix.environment.reset import ResetFunction

FILTER_STEPS: Final = 64
"""Environment steps that the no-op is given (`level_filter_n_steps`)."""
SAMPLE_RATIO: Final = 2
"""Levels drawn for each one that is kept (`level_filter_sample_ratio`)."""
SOLVED_REWARD: Final = 0.5
"""A level counts as solved when its episode ends with more than this reward."""
SOLVED_WEIGHT: Final = 0.001
"""Weight of a solved level among the others with weight 1."""
EVALUATION_SEED: Final = 100
"""Key of the fixed random evaluation sets."""


def noop_solved(
    env: "KinetixEnv", states: EnvState, env_params: EnvParams, *, steps: int = FILTER_STEPS
) -> Bool[Array, " n"]:
    """Mark the levels that are won by doing nothing; the arguments are those of `noop_rewards`."""
    return noop_rewards(env, states, env_params, steps=steps) > SOLVED_REWARD


@functools.partial(jax.jit, static_argnames=("env", "steps"))
def noop_rewards(
    env: "KinetixEnv", states: EnvState, env_params: EnvParams, *, steps: int = FILTER_STEPS
) -> Float[Array, " n"]:
    """Return the rewards with which episodes end when nothing is done.

    Args:
        env: The environment that the levels are for.
        states: Levels at the start of their episodes, on the first axis.
        env_params: Parameters.
        steps: How long to wait [environment steps].

    Returns:
        The reward of each level's last step; 0 where the episode goes on.
    """
    player = dataclasses.replace(env, auto_reset=False)
    worlds = states.timestep.shape[0]
    noop = jax.tree.map(
        lambda leaf: jnp.broadcast_to(leaf, (worlds, *leaf.shape)), env.actions.noop_action()
    )
    key = jax.random.split(jax.random.key(0), worlds)  # Stepping without a reset draws nothing.
    advance = jax.vmap(player.step, in_axes=(0, 0, 0, None))
    # Several processes also call this for themselves alone.
    if jax.process_count() == 1 and worlds % jax.device_count() == 0:
        advance = in_shares(advance, replicated=(3,))

    def unfinished(carry: tuple[Any, Array, Array, Array]) -> Array:
        return (carry[3] < steps) & ~jnp.all(carry[1])

    def play(carry: tuple[Any, Array, Array, Array]) -> tuple[Any, Array, Array, Array]:
        state, ended, last, step = carry
        _, state, reward, done, _ = advance(key, state, noop, env_params)
        return state, ended | done, jnp.where(done & ~ended, reward, last), step + 1

    states = jax.tree.map(jnp.asarray, states)
    start = (states, jnp.zeros((worlds,), bool), jnp.zeros((worlds,)), jnp.zeros((), jnp.int32))
    return jax.lax.while_loop(unfinished, play, start)[2]


def choose_unsolved(key: Key[Array, ""], solved: Bool[Array, " n"], count: int) -> Int[Array, " m"]:
    """Draw levels without replacement, solved ones only when there is nothing else.

    Args:
        key: Random key.
        solved: Which levels the no-op solves.
        count: How many to draw, at most as many as there are.

    Source: Gumbel's trick: the largest of log weight + Gumbel noise are such a draw (Kool et al.,
    "Stochastic Beams and Where to Find Them", 2019).
    """
    weights: Float[Array, " n"] = jnp.where(solved, SOLVED_WEIGHT, 1.0)
    score = jnp.log(weights) + jax.random.gumbel(key, solved.shape)
    return jax.lax.top_k(score, count)[1]


def sample_filtered_levels(
    key: Key[Array, ""],
    count: int,
    reset_fn: "ResetFunction",
    env: "KinetixEnv",
    env_params: EnvParams,
    *,
    steps: int = FILTER_STEPS,
    ratio: int = SAMPLE_RATIO,
) -> EnvState:
    """Return levels; (nearly) none is solved by doing nothing.

    Args:
        key: Random key.
        count: How many levels.
        reset_fn: Draws a level from a key.
        env: The environment that they are for.
        env_params: Parameters.
        steps: How long the no-op is played; 0 turns the filter off.
        ratio: How many levels are drawn for each one that is kept.

    Returns:
        The levels, on the first axis.
    """
    level_key, choice_key = jax.random.split(key)
    if steps <= 0:
        return jax.vmap(reset_fn)(jax.random.split(level_key, count))
    drawn = jax.vmap(reset_fn)(jax.random.split(level_key, count * ratio))
    solved = noop_solved(env, drawn, env_params, steps=steps)
    kept = choose_unsolved(choice_key, solved, count)
    return jax.tree.map(lambda leaf: leaf[kept], drawn)
