"""Tables of a few rows in every world: entries and sums by index. Worlds on the last axis.

An index differs from world to world, so what is looked up cannot be a slice. A loop that goes
through the table and picks what matches works on whole lanes of worlds; a gather takes them one by
one and needs two to three times as long (docs/physics.md).
"""

from collections.abc import Callable
from typing import TypeVar

import jax
import jax.numpy as jnp
import numpy as np
from jax.lax import GatherDimensionNumbers, GatherScatterMode
from jaxtyping import Array, Bool, Float, Int, Shaped

from kinetix.engine.backend import takes_whole_batches

T = TypeVar("T")

MOST_ROWS = 32
"""Tables with more rows are gathered from."""


def take(values: T, index: Int[Array, "k n"]) -> T:
    """values[index[k, n], n] of every array.

    Args:
        values: Arrays (rows, …, n), all with the same number of rows, in any pytree.
        index: From 0; entries outside the table are not defined.

    Returns:
        The same tree of arrays (k, …, n).
    """
    table = jax.tree.leaves(values)[0].shape[0]
    if table > MOST_ROWS or takes_whole_batches():
        return jax.tree.map(lambda x: _gather(x, index), values)

    def pick(k: Int[Array, ""], found: T) -> T:
        here = index == k

        def entry(x: Shaped[Array, "rows *rest n"], old: Shaped[Array, "k *rest n"]) -> Array:
            same = here.reshape(here.shape[0], *[1] * (x.ndim - 2), here.shape[1])
            return jnp.where(same, row(x, k), old)

        return jax.tree.map(entry, values, found)

    def room(x: Shaped[Array, "rows *rest n"]) -> Shaped[Array, "k *rest n"]:
        return jnp.zeros((index.shape[0], *x.shape[1:]), x.dtype)

    return accumulate(table, pick, jax.tree.map(room, values))


def take_pair(values: T, first: Int[Array, "k n"], second: Int[Array, "k n"]) -> tuple[T, T]:
    """`take` for two bodies of a row, in one go through the table."""
    count = first.shape[0]
    both = take(values, jnp.concatenate([first, second], axis=0))
    return jax.tree.map(lambda x: x[:count], both), jax.tree.map(lambda x: x[count:], both)


def _gather(
    values: Shaped[Array, "rows *rest n"], index: Int[Array, "k n"]
) -> Shaped[Array, "k *rest n"]:
    """Gather from the table as one long row, written directly.

    Worlds as a batch axis of the gather would be joined to the indices first, and what
    `take_along_axis` adds for negative indices is a large part of the time that compiling takes.
    """
    if values.ndim > 2:
        return jax.vmap(_gather, in_axes=(1, None), out_axes=1)(values, index)
    worlds = values.shape[1]
    place = index * worlds + np.arange(worlds, dtype=np.int32)
    return jax.lax.gather(
        values.reshape(-1),
        place[..., None],
        GatherDimensionNumbers(offset_dims=(), collapsed_slice_dims=(0,), start_index_map=(0,)),
        slice_sizes=(1,),
        mode=GatherScatterMode.PROMISE_IN_BOUNDS,
    )


def onto(values: T, index: Int[Array, "k n"], rows: int) -> T:
    """Return the sums of the entries that go to each row of a table: the transpose of `take`.

    Args:
        values: Arrays (k, n) in any pytree.
        index: Where each entry goes.
        rows: Of the table.

    Returns:
        The same tree of arrays (rows, n).
    """
    table = np.arange(rows, dtype=np.int32)[:, None]
    if takes_whole_batches():
        here = table[None] == index[:, None]
        return jax.tree.map(lambda x: jnp.where(here, x[:, None], 0).sum(axis=0), values)

    def add(k: Int[Array, ""], total: T) -> T:
        here = table == row(index, k)
        return jax.tree.map(lambda x, old: old + jnp.where(here, row(x, k), 0), values, total)

    worlds = index.shape[-1]
    nothing = jax.tree.map(lambda x: jnp.zeros((rows, worlds), x.dtype), values)
    return accumulate(index.shape[0], add, nothing)


def marked(index: Int[Array, "k n"], rows: int) -> Bool[Array, "rows n"]:
    """Mark the rows of a table that any of the entries names."""
    table = np.arange(rows, dtype=np.int32)[:, None]
    if takes_whole_batches():
        return jnp.any(table[None] == index[:, None], axis=0)

    def mark(k: Int[Array, ""], found: Bool[Array, "rows n"]) -> Bool[Array, "rows n"]:
        return found | (table == row(index, k))

    nothing = jnp.zeros((rows, index.shape[-1]), bool)
    return accumulate(index.shape[0], mark, nothing)


def row(values: Shaped[Array, "m ..."], index: Int[Array, ""] | int) -> Shaped[Array, "1 ..."]:
    """One row, its axis kept. An index below 0 is not understood: asking for it costs a kernel."""
    return jax.lax.dynamic_index_in_dim(values, index, 0, allow_negative_indices=False)


def put(
    values: Shaped[Array, "..."], new: Shaped[Array, "..."], index: Int[Array, ""], axis: int
) -> Shaped[Array, "..."]:
    """`values` with a row (axis 0) or column (axis 1) replaced; the axis of `new` is kept."""
    return jax.lax.dynamic_update_slice_in_dim(
        values, new, index, axis, allow_negative_indices=False
    )


def column(matrix: Float[Array, "m k n"], index: Int[Array, ""] | int) -> Float[Array, "m n"]:
    """Return one column of every world's matrix."""
    return jax.lax.dynamic_index_in_dim(
        matrix, index, 1, keepdims=False, allow_negative_indices=False
    )


def accumulate(count: int, add: Callable[[Int[Array, ""], T], T], start: T) -> T:
    """A loop that may have nothing to do: not even the shapes of no rows can be looked at."""
    return jax.lax.fori_loop(0, count, add, start) if count else start
