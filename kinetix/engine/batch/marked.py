"""A function of one world under `vmap`, for the few worlds of a batch that need it."""

from collections.abc import Callable
from typing import Any, Final

import jax
import jax.numpy as jnp
from jaxtyping import Array, Bool, Int, Shaped

from kinetix.engine.batch.tiles import picked
from kinetix.engine.batch.worlds_first import worlds_first
from kinetix.engine.lookup import put, row

Tree = Any

MARKED_AT_ONCE: Final = 32
"""Marked worlds that are computed together, at least. With fewer, many marks in one step take many
rounds; with more, a single mark pays for worlds that nobody needs."""

SHARE: Final = 128
"""Of so many worlds one is worked on in a round: an episode is about twice as long."""


def in_a_round(worlds: int, least: int) -> int:
    """Count the worlds that are worked on together, where few of a batch need it in any one step.

    Args:
        worlds: Of the batch.
        least: So many at least, unless there are fewer.
    """
    return min(max(least, worlds // SHARE), worlds)


def _as_large_as(new: Shaped[Array, "n ..."], old: Shaped[Array, "m ..."]) -> Array:
    """Broadcast the new rows to the shape of the old: a smaller one would be written in part."""
    added = [1] * (old.ndim - new.ndim)
    return jnp.broadcast_to(
        new.reshape(len(new), *added, *new.shape[1:]), (len(new), *old.shape[1:])
    )


def _replaced_in_turn(old: Tree, new: Tree, places: Int[Array, " k"]) -> Tree:
    """Put new worlds at the given places; the first valid ones count."""
    worlds = len(jax.tree.leaves(old)[0])

    def replace(k: Int[Array, ""], old: Tree) -> Tree:
        place = row(places, k)[0]
        return jax.tree.map(lambda a, b: put(a, row(b, k).astype(a.dtype), place, 0), old, new)

    return jax.lax.fori_loop(0, jnp.sum(places < worlds), replace, old)


def _replaced_at_once(old: Tree, new: Tree, places: Int[Array, " k"]) -> Tree:
    """The same, each world looking for what replaces it: a handful of kernels for all arrays."""
    worlds = len(jax.tree.leaves(old)[0])
    nothing = jnp.full(worlds, len(places), jnp.int32)
    source = nothing.at[places].set(jnp.arange(len(places), dtype=jnp.int32), mode="drop")
    is_new = source < len(places)
    source = jnp.minimum(source, len(places) - 1)

    def one(a: Array, b: Array) -> Array:
        mask = is_new.reshape(worlds, *[1] * (a.ndim - 1))
        return jnp.where(mask, picked(b, source).astype(a.dtype), a)

    return jax.tree.map(one, old, new)


def where_marked(make: Callable[..., Tree]) -> Callable[..., Tree]:
    """Return a function that computes marked worlds again.

    Under `vmap` only the marked worlds are made: their indices are compacted and worked off
    `MARKED_AT_ONCE` at a time. Each comes from its own seeds, the same as if it were alone.

    Args:
        make: From the seeds of one world (any pytree) to what it has.

    Returns:
        A function of what there is, the mark, and the seeds.
    """

    def batched(old: Tree, marked: Bool[Array, " n"], seeds: Tree) -> Tree:
        worlds = marked.shape[0]
        if not worlds:
            return old
        chunk = in_a_round(worlds, MARKED_AT_ONCE)
        (rows,) = jnp.nonzero(marked, size=worlds)
        rows = jnp.pad(rows, (0, chunk))
        count = jnp.sum(marked)

        def unfinished(carry: tuple[Array, Tree]) -> Bool[Array, ""]:
            return carry[0] < count

        def replace_chunk(carry: tuple[Array, Tree]) -> tuple[Array, Tree]:
            first, old = carry
            chosen = jax.lax.dynamic_slice_in_dim(rows, first, chunk)
            new = jax.vmap(make)(jax.tree.map(lambda x: picked(x, chosen), seeds))
            new = jax.tree.map(_as_large_as, new, old)
            places = jnp.where(jnp.arange(chunk) < count - first, chosen, worlds)
            replaced = jax.lax.platform_dependent(
                old, new, places, default=_replaced_in_turn, cuda=_replaced_at_once
            )
            return first + chunk, replaced

        return jax.lax.while_loop(unfinished, replace_chunk, (jnp.zeros((), count.dtype), old))[1]

    return worlds_first(batched)
