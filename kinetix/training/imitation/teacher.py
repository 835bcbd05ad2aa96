"""Searching many random levels at once: a batch of levels, each with plans of its own."""

import dataclasses
import functools
from typing import Any, Final

import jax
import jax.numpy as jnp
import numpy as np
from jaxtyping import Array, Bool, Float, Int

from kinetix.agents.planner.futures import STRETCH, best_first, play_futures
from kinetix.agents.planner.proposals import CHANNELS, fresh_plans, varied_plans
from kinetix.environment.env import KinetixEnv
from kinetix.environment.state import EnvState
from kinetix.pytree import pytree

PLANS: Final = 32
"""Plans of a level in a round."""
ELITE: Final = 4
CHILDREN: Final = 10
LENGTH: Final = 256
"""Of a plan [environment steps]: the time limit of random levels."""
NOISE: Final = 0.05
"""Scale of the noise by which the beam chooses [m]."""
KICK: Final = (0.15, 0.3)
"""Standard deviation of what starts are perturbed by [m/s, rad/s]."""


@pytree
class Searched:
    """Findings of a round about each level."""

    elite: Int[Array, "n k t 6"]
    """Its best plans, the best first."""
    won: Bool[Array, " n"]
    """True if that one wins."""
    steps: Int[Array, " n"]
    """After how many environment steps."""


@functools.partial(jax.jit, static_argnums=0)
def search_round(
    env: KinetixEnv, states: EnvState, elite: Int[Array, "n k t 6"], key: Array
) -> Searched:
    """Play plans of every level: its best ones, variations of them, new ones and a beam.

    Args:
        env: Where; without auto-reset.
        states: The levels, on the first axis.
        elite: Their best plans so far; at first, doing nothing.
        key: Of the draws.
    """
    levels = elite.shape[0]
    chance = jax.random.uniform(key, (levels, PLANS, LENGTH + 1, 2 * CHANNELS))

    def propose(
        state: EnvState, elite: Int[Array, "k t 6"], chance: Float[Array, "m t c"]
    ) -> Int[Array, "m t 6"]:
        live = env.actions.live(state.world, state.labels)
        fresh = fresh_plans(chance[ELITE:, 1:], live)
        varied = varied_plans(chance[:CHILDREN, 0], elite, fresh[:CHILDREN], live)
        return jnp.concatenate([elite, varied, fresh[CHILDREN:]])

    plans = jax.vmap(propose)(states, elite, chance)
    noise = -NOISE * jnp.log(-jnp.log(chance[:, :, 1 : 1 + LENGTH // STRETCH, 0] + 1e-9))
    wholes = jnp.full(levels, PLANS // 2)
    futures = play_futures(env, states, plans, noise, wholes, jnp.int32(LENGTH // STRETCH))
    order = jax.vmap(best_first)(futures.score)[:, :ELITE]
    best = order[:, :1]
    return Searched(
        elite=jnp.take_along_axis(futures.plans, order[..., None, None], axis=1),
        won=jnp.take_along_axis(futures.won, best, axis=1)[:, 0],
        steps=jnp.take_along_axis(futures.steps, best, axis=1)[:, 0],
    )


@functools.partial(jax.jit, static_argnums=0)
def wins_again(
    env: KinetixEnv, states: EnvState, plans: Int[Array, "n t 6"]
) -> tuple[Bool[Array, " n"], Int[Array, " n"]]:
    """Play one plan of each level.

    Returns:
        Whether it wins, and after how many environment steps.
    """
    count, steps = plans.shape[:2]
    key = jax.random.key(0)  # nothing in a step of one level is random

    def going_on(loop: tuple[Any, ...]) -> Array:
        t, _, over, _, _ = loop
        return (t < steps) & ~jnp.all(over)

    def advance(loop: tuple[Any, ...]) -> tuple[Any, ...]:
        t, state, over, won, length = loop
        actions = jax.lax.dynamic_index_in_dim(plans, t, axis=1, keepdims=False)
        step = jax.vmap(env.step, in_axes=(None, 0, 0))
        _, state, _, done, info = step(key, state, actions.astype(jnp.int32))
        won = won | (~over & info["GoalR"])
        return t + 1, state, over | done, won, length + ~over

    no = jnp.zeros(count, bool)
    states = jax.tree.map(lambda x: jnp.asarray(x, jnp.result_type(x)), states)
    begun = (jnp.int32(0), states, no, no, jnp.zeros(count, jnp.int32))
    *_, won, length = jax.lax.while_loop(going_on, advance, begun)
    return won, length


def kicked(states: EnvState, random: np.random.Generator) -> EnvState:
    """Return the same levels with a little speed given to all bodies that can move.

    Args:
        states: The levels, on the first axis, as numpy arrays.
        random: Of the draws.
    """
    physics, bodies = states.physics, states.world.bodies
    moves = np.asarray(bodies.active) & (np.asarray(bodies.inverse_mass) > 0)
    push, turn = KICK
    velocity = np.asarray(physics.velocity)
    spin = np.asarray(physics.angular_velocity)
    velocity = velocity + push * random.standard_normal(velocity.shape) * moves[..., None]
    spin = spin + turn * random.standard_normal(spin.shape) * moves
    moved = dataclasses.replace(
        physics,
        velocity=velocity.astype(np.float32),
        angular_velocity=spin.astype(np.float32),
    )
    return dataclasses.replace(states, physics=moved)
