"""The level buffer of prioritised level replay: which levels stay, and which are drawn.

Source: Jiang, Grefenstette & Rocktäschel, "Prioritized Level Replay" (2021).
"""

import dataclasses
from typing import Any

import jax
import jax.numpy as jnp
from jaxtyping import Array, Bool, Float, Int

from kinetix.pytree import pytree
from kinetix.training.config import ReplayConfig

_NOTHING = 1e-12
"""Keeps divisions by a sum of weights finite when there are none."""


@pytree
class LevelBuffer:
    """Levels with what is known about them."""

    levels: Any
    """States at the start of episodes, on the first axis."""
    filled: Bool[Array, " m"]
    score: Float[Array, " m"]
    max_return: Float[Array, " m"]
    """Best return of all visits."""
    last_draw: Int[Array, " m"]
    """Value of the counter when the level was last drawn (or came in)."""
    draws: Int[Array, ""]
    """The counter: draws so far."""


def empty_buffer(level: Any, capacity: int) -> LevelBuffer:
    """Return a buffer without levels.

    Args:
        level: Any level, for shapes and dtypes.
        capacity: How many levels there is room for.
    """
    return LevelBuffer(
        levels=jax.tree.map(lambda x: jnp.zeros((capacity, *x.shape), x.dtype), level),
        filled=jnp.zeros(capacity, bool),
        score=jnp.full(capacity, -jnp.inf, jnp.float32),
        max_return=jnp.full(capacity, -jnp.inf, jnp.float32),
        last_draw=jnp.zeros(capacity, jnp.int32),
        draws=jnp.zeros((), jnp.int32),
    )


def weights(buffer: LevelBuffer, config: ReplayConfig) -> Float[Array, " m"]:
    """Probability of each level to be drawn; 0 for free entries.

    Args:
        buffer: The buffer.
        config: Prioritisation, temperature, weight of staleness.
    """
    return _mixed(buffer, _score_weights(buffer, config), config)


def draw(
    buffer: LevelBuffer, key: Array, count: int, config: ReplayConfig, *, distinct: bool = False
) -> tuple[LevelBuffer, Int[Array, " n"]]:
    """Draw levels one after the other; each draw advances the counter and stamps the level.

    Args:
        buffer: The buffer; at least one entry is filled.
        key: Random key.
        count: How many.
        config: As for `weights`.
        distinct: Draw no level again before all others were drawn. Otherwise ranks give the best of
            4000 levels a thirteenth of a large batch.

    Returns:
        The buffer with its stamps, and the indices.
    """
    by_score = _score_weights(buffer, config)

    def one(carry: Any, key: Array) -> tuple[Any, Array]:
        buffer, drawn = carry
        chance = jnp.where(drawn, 0.0, _mixed(buffer, by_score, config))
        # Where only levels without any weight are left, they are equally likely.
        left = buffer.filled & ~drawn
        chance = jnp.where(jnp.sum(chance) > 0, chance, left.astype(chance.dtype))
        index = jax.random.categorical(key, jnp.log(chance))
        draws = buffer.draws + 1
        stamped = buffer.last_draw.at[index].set(draws)
        if distinct:
            drawn = drawn.at[index].set(True)
            drawn &= ~jnp.all(drawn | ~buffer.filled)
        return (dataclasses.replace(buffer, draws=draws, last_draw=stamped), drawn), index

    start = (buffer, jnp.zeros_like(buffer.filled))
    (buffer, _), index = jax.lax.scan(one, start, jax.random.split(key, count))
    return buffer, index


def insert(
    buffer: LevelBuffer,
    levels: Any,
    score: Float[Array, " n"],
    max_return: Float[Array, " n"],
    config: ReplayConfig,
) -> tuple[LevelBuffer, Int[Array, " m"]]:
    """Offer levels: they fill free entries, then replace the entry of least weight if better.

    Args:
        buffer: The buffer.
        levels: The levels, on the first axis.
        score: Their scores.
        max_return: Their best returns.
        config: As for `weights`.

    Returns:
        The buffer, and which of the levels is in each entry now; −1: it kept its own.
    """
    capacity = buffer.filled.shape[0]
    # The levels themselves are large: first it is decided who goes where, then they move at once.
    source = jnp.full(capacity, -1, jnp.int32)

    def offer(
        carry: tuple[LevelBuffer, Array], new: tuple[Array, Array, Array, Array]
    ) -> tuple[tuple[LevelBuffer, Array], None]:
        buffer, source = carry
        index, score, best, wanted = new
        free = ~buffer.filled
        least = jnp.argmin(jnp.where(free, -1.0, weights(buffer, config)))
        accepted = wanted & (free[least] | (score > buffer.score[least]))
        at = jnp.where(accepted, least, capacity)
        buffer = dataclasses.replace(
            buffer,
            filled=buffer.filled.at[at].set(True, mode="drop"),
            score=buffer.score.at[at].set(score, mode="drop"),
            max_return=buffer.max_return.at[at].set(best, mode="drop"),
            last_draw=buffer.last_draw.at[at].set(buffer.draws, mode="drop"),
        )
        return (buffer, source.at[at].set(index, mode="drop")), None

    count = score.shape[0]
    wanted = jnp.ones(count, bool)
    if config.buffer_duplicate_check:
        wanted = _new_ones(buffer, levels, count)
    new = (jnp.arange(count, dtype=jnp.int32), score, max_return, wanted)
    bare = dataclasses.replace(buffer, levels=())
    (bare, source), _ = jax.lax.scan(offer, (bare, source), new)
    taken = source >= 0

    def move(old: Array, fresh: Array) -> Array:
        chosen = fresh[jnp.maximum(source, 0)]
        return jnp.where(taken.reshape(-1, *[1] * (old.ndim - 1)), chosen, old)

    return dataclasses.replace(bare, levels=jax.tree.map(move, buffer.levels, levels)), source


def revise(
    buffer: LevelBuffer,
    index: Int[Array, " n"],
    score: Float[Array, " n"],
    max_return: Float[Array, " n"],
) -> LevelBuffer:
    """Write what replaying levels has shown.

    Args:
        buffer: The buffer.
        index: The levels that were replayed.
        score: Their new scores; of a level that was replayed several times the mean of those that
            are finite counts.
        max_return: Their best returns now; the best of all visits is kept.
    """
    known = jnp.isfinite(score)
    nothing = jnp.zeros_like(buffer.score)
    total = nothing.at[index].add(jnp.where(known, score, 0.0))
    count = nothing.at[index].add(known)
    mean = jnp.where(count > 0, total / jnp.maximum(count, 1.0), -jnp.inf)
    replayed = jnp.zeros_like(buffer.filled).at[index].set(True)
    return dataclasses.replace(
        buffer,
        score=jnp.where(replayed, mean, buffer.score),
        max_return=buffer.max_return.at[index].max(max_return),
    )


def _mixed(
    buffer: LevelBuffer, by_score: Float[Array, " m"], config: ReplayConfig
) -> Float[Array, " m"]:
    """Return weights by score and weights by staleness together."""
    stale = jnp.where(buffer.filled, buffer.draws - buffer.last_draw, 0).astype(jnp.float32)
    uniform = buffer.filled / jnp.maximum(jnp.sum(buffer.filled), 1)
    total = jnp.sum(stale)
    staleness = jnp.where(total > 0, stale / jnp.maximum(total, _NOTHING), uniform)
    return (1.0 - config.staleness_coeff) * by_score + config.staleness_coeff * staleness


def _score_weights(buffer: LevelBuffer, config: ReplayConfig) -> Float[Array, " m"]:
    order = jnp.argsort(jnp.where(buffer.filled, -buffer.score, jnp.inf))
    rank = jnp.zeros_like(order).at[order].set(jnp.arange(order.shape[0])) + 1
    if config.prioritization == "topk":
        weight = (rank <= config.topk_k).astype(jnp.float32)
    else:
        weight = rank.astype(jnp.float32) ** (-1.0 / config.temperature)
    weight = jnp.where(buffer.filled, weight, 0.0)
    return weight / jnp.maximum(jnp.sum(weight), _NOTHING)


def _new_ones(buffer: LevelBuffer, levels: Any, count: int) -> Bool[Array, " n"]:
    """Mark the levels that are neither in the buffer nor earlier in the same batch."""

    def rows(tree: Any, length: int) -> Array:
        leaves = [x.reshape(length, -1).astype(jnp.float32) for x in jax.tree.leaves(tree)]
        return jnp.concatenate(leaves, axis=1)

    new, old = rows(levels, count), rows(buffer.levels, buffer.filled.shape[0])

    def is_new(index: Array) -> Array:
        same = jnp.all(old == new[index], axis=1) & buffer.filled
        earlier = jnp.all(new == new[index], axis=1) & (jnp.arange(count) < index)
        return ~(jnp.any(same) | jnp.any(earlier))

    return jax.lax.map(is_new, jnp.arange(count))
