"""One episode from a state, played by whatever chooses actions: whole, or step by step.

Both ways run the same compiled code, so they give the same episode to the bit.
"""

import dataclasses
import functools
from collections.abc import Callable, Iterator
from typing import Any

import jax
import jax.numpy as jnp
from jaxtyping import Array, Bool, Float, Int

from kinetix.environment.env import KinetixEnv
from kinetix.environment.outcome import OUTCOMES, Outcome, outcome_index, outcome_of
from kinetix.environment.state import EnvState
from kinetix.pytree import on_device, pytree, typed_like

__all__ = ["Decide", "Episode", "EpisodeState", "Outcome", "outcome_of", "play_episode", "rollout"]

Decide = Callable[..., tuple[Any, Any, Any]]
"""Chooses actions for a batch: from parameters, carry, observations, keys and which episodes have
just begun to actions, carry and anything else (see `kinetix.agents.player`)."""


@dataclasses.dataclass(frozen=True, kw_only=True)
class Episode:
    """Result of an episode."""

    steps: int
    """Environment steps played."""
    outcome: Outcome
    total_reward: float
    """Sum of the rewards."""
    dropped_contacts: int = 0
    """Steps in which bodies overlapped so much that there was no room for all contacts."""


@pytree
class EpisodeState:
    """An episode after some steps."""

    state: EnvState
    observation: Any
    carry: Any
    """Memory of whatever chooses actions."""
    step: Int[Array, ""]
    """Environment steps played."""
    action: Any
    """The last action, as the environment takes it; zero at the start."""
    said: Any
    """Anything else that came with the last action."""
    total_reward: Float[Array, ""]
    ending: Int[Array, ""]
    """From `outcome_index`: 0 while the episode goes on."""
    dropped: Int[Array, ""]
    """Steps so far without room for all contacts."""

    @property
    def outcome(self) -> Outcome | None:
        """Outcome of the episode; None while it goes on."""
        index = int(self.ending)
        return OUTCOMES[index - 1] if index else None


def rollout(
    env: KinetixEnv,
    state: EnvState,
    decide: Decide,
    *,
    params: Any = None,
    carry: Any = (),
    seed: int = 0,
) -> Iterator[EpisodeState]:
    """Play an episode step by step.

    Args:
        env: The environment; compiled once per environment and `decide`.
        state: Where the episode starts.
        decide: Chooses actions for a batch of one; every step has a key of its own.
        params: Its parameters.
        carry: Its memory at the start.
        seed: Seed of its draws.

    Yields:
        The start, then every step until the episode ends.
    """
    key = jax.random.key(seed)
    now = _start(env, decide, params, carry, on_device(state), key)
    yield now
    while now.outcome is None:
        now = _play(env, decide, params, now, key, now.step + 1)
        yield now


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
    """Play until the episode ends; see `rollout`.

    Args:
        env: The environment.
        state: Where the episode starts.
        decide: Chooses actions for a batch of one.
        params: Its parameters.
        carry: Its memory at the start.
        seed: Seed of its draws.
        limit: Stop after so many steps, as a timeout.
    """
    end = play_until(env, state, decide, params=params, carry=carry, seed=seed, limit=limit)
    return Episode(
        steps=int(end.step),
        outcome=end.outcome or "timeout",
        total_reward=float(end.total_reward),
        dropped_contacts=int(end.dropped),
    )


def play_until(
    env: KinetixEnv,
    state: EnvState,
    decide: Decide,
    *,
    params: Any = None,
    carry: Any = (),
    seed: int = 0,
    limit: int | None = None,
) -> EpisodeState:
    """Return an episode as it stands when it ends or after `limit` steps; see `play_episode`.

    Args:
        env: The environment.
        state: Where the episode starts.
        decide: Chooses actions for a batch of one.
        params: Its parameters.
        carry: Its memory at the start.
        seed: Seed of its draws.
        limit: Stop after so many steps.
    """
    key = jax.random.key(seed)
    start = _start(env, decide, params, carry, on_device(state), key)
    most = jnp.iinfo(jnp.int32).max if limit is None else limit
    return _play(env, decide, params, start, key, jnp.asarray(most, jnp.int32))


@functools.partial(jax.jit, static_argnums=(0, 1))
def _start(
    env: KinetixEnv, decide: Decide, params: Any, carry: Any, state: EnvState, key: Array
) -> EpisodeState:
    observation = env.get_obs(state)
    shapes = jax.eval_shape(
        functools.partial(_decision, decide), params, carry, observation, key, True
    )
    action, _, said = jax.tree.map(lambda x: jnp.zeros(x.shape, x.dtype), shapes)
    return EpisodeState(
        state=state,
        observation=observation,
        carry=carry,
        step=jnp.int32(0),
        action=action,
        said=said,
        total_reward=jnp.float32(0),
        ending=jnp.int32(0),
        dropped=jnp.int32(0),
    )


@functools.partial(jax.jit, static_argnums=(0, 1))
def _play(
    env: KinetixEnv,
    decide: Decide,
    params: Any,
    start: EpisodeState,
    key: Array,
    limit: Int[Array, ""],
) -> EpisodeState:
    """Play until the episode ends or so many steps have been played in all."""
    env = dataclasses.replace(env, auto_reset=False)

    def goes_on(now: EpisodeState) -> Bool[Array, ""]:
        return (now.ending == 0) & (now.step < limit)

    def advance(now: EpisodeState) -> EpisodeState:
        drawn = jax.random.fold_in(key, now.step)
        action, carry, said = _decision(
            decide, params, now.carry, now.observation, drawn, now.step == 0
        )
        observation, state, reward, _, info = env.step(key, now.state, action)
        after = EpisodeState(
            state=state,
            observation=observation,
            carry=carry,
            step=now.step + 1,
            action=action,
            said=said,
            total_reward=now.total_reward + reward,
            ending=outcome_index(info),
            dropped=now.dropped + info["overflow"],
        )
        return typed_like(after, now)

    return jax.lax.while_loop(goes_on, advance, start)


def _decision(
    decide: Decide, params: Any, carry: Any, observation: Any, key: Array, begins: Any
) -> tuple[Any, Any, Any]:
    """Return the action of one world, the next carry and the rest."""
    seen = jax.tree.map(lambda x: x[None], observation)
    keys = jax.random.split(key, 1)
    actions, carry, said = decide(params, carry, seen, keys, jnp.asarray(begins)[None])
    return jax.tree.map(lambda x: x[0], actions), carry, said
