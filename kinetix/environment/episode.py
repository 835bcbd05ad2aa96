"""One episode from a state, played by whatever chooses actions."""

import dataclasses
import functools
from collections.abc import Callable
from typing import Any, Literal

import jax
import jax.numpy as jnp
from jaxtyping import Array

from kinetix.environment.env import KinetixEnv
from kinetix.environment.state import EnvState

Outcome = Literal["won", "lost", "timeout"]
"""Green touched blue; green touched red, or the physics broke down; neither in time."""

Decide = Callable[..., tuple[Any, Any, Any]]
"""Chooses actions for a batch: from parameters, carry, observations, keys and which episodes have
just begun to actions, carry and anything else (see `kinetix.agents.player`)."""


@dataclasses.dataclass(frozen=True, kw_only=True)
class Episode:
    """What came of an episode."""

    steps: int
    """Environment steps played."""
    outcome: Outcome
    total_reward: float
    """Sum of the rewards."""


def play_episode(
    env: KinetixEnv,
    state: EnvState,
    decide: Decide,
    *,
    params: Any = None,
    carry: Any = (),
    seed: int = 0,
    limit: int | None = None,
) -> Episode:
    """Play until the episode ends.

    Args:
        env: Where; compiled once per environment and `decide`.
        state: Where the episode starts.
        decide: Chooses actions for a batch of one.
        params: Its parameters.
        carry: Its memory at the start.
        seed: Of whatever it draws.
        limit: Stop after so many steps, as a time-out.
    """
    steps, total, done, won, lost = _play(
        env,
        decide,
        params,
        carry,
        jax.tree.map(jnp.asarray, state),
        jax.random.key(seed),
        jnp.iinfo(jnp.int32).max if limit is None else limit,
    )
    ended = bool(done)
    outcome: Outcome = "won" if ended and won else "lost" if ended and lost else "timeout"
    return Episode(steps=int(steps), outcome=outcome, total_reward=float(total))


@functools.partial(jax.jit, static_argnums=(0, 1))
def _play(
    env: KinetixEnv,
    decide: Decide,
    params: Any,
    carry: Any,
    state: EnvState,
    key: Array,
    limit: Any,
) -> tuple[Array, Array, Array, Array, Array]:
    """Steps, sum of rewards, and whether the episode is over, won, lost."""
    env = dataclasses.replace(env, auto_reset=False)
    no = jnp.zeros((), bool)

    def going_on(loop: tuple[Any, ...]) -> Array:
        step, *_, done, _, _ = loop
        return ~done & (step < limit)

    def advance(loop: tuple[Any, ...]) -> tuple[Any, ...]:
        step, total, state, observation, carry, _, _, _ = loop
        keys = jax.random.split(jax.random.fold_in(key, step), 1)
        seen = jax.tree.map(lambda x: x[None], observation)
        actions, carry, _ = decide(params, carry, seen, keys, (step == 0)[None])
        action = jax.tree.map(lambda x: x[0], actions)
        observation, state, reward, done, info = env.step(key, state, action)
        won = info["GoalR"]
        lost = (info["terminated"] & ~won) | info["nan"]
        return step + 1, total + reward, state, observation, carry, done, won, lost

    start = (jnp.int32(0), jnp.float32(0), state, env.get_obs(state), carry, no, no, no)
    step, total, _, _, _, done, won, lost = jax.lax.while_loop(going_on, advance, start)
    return step, total, done, won, lost
