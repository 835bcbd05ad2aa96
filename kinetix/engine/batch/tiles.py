"""A batch on a processor: some worlds at a time, as many as its cache holds."""

from collections.abc import Sequence
from typing import Any, Final

import jax
import jax.numpy as jnp
from jaxtyping import Array, Int, Shaped

from kinetix.engine.batch.program import BatchProgram, count
from kinetix.engine.packing import pack, unpack
from kinetix.engine.store import Store

Tree = Any

TILE: Final = 128
"""Most worlds that are advanced together: few enough for the cache, enough to fill the lanes."""


def by_tiles(program: BatchProgram, leaves: Sequence[Array]) -> Tree:
    """Run the kernel on some worlds at a time, one tile after the other."""
    worlds, tile = count(leaves), program.tile
    if worlds <= tile:
        return program.kernel(*program.arguments(leaves))
    tiles = -(-worlds // tile)
    # Whole worlds are repeated, so that what fills the last tile is as sane as the rest.
    effort = program.effort
    order = jnp.arange(worlds)
    if effort is not None:
        order = jnp.argsort(effort(*program.arguments(leaves)))
    order = jnp.pad(order, (0, tiles * tile - worlds), mode="edge")
    back = jnp.zeros(worlds, order.dtype).at[order].set(jnp.arange(tiles * tile))
    # What all worlds share needs not be moved.
    shared = [x.shape[-1] == 1 for x in leaves]
    own = [x for x, is_shared in zip(leaves, shared, strict=True) if not is_shared]

    def advance(packed: dict[str, Array]) -> dict[str, Array]:
        turned = jax.tree.map(jnp.transpose, packed)
        floats = next(x for x in turned.values() if jnp.issubdtype(x.dtype, jnp.floating))
        turned = Store.beside(floats)(turned)
        unpacked = iter(unpack(turned, own, 0))
        parts = [
            x if is_shared else next(unpacked) for x, is_shared in zip(leaves, shared, strict=True)
        ]
        done = program.kernel(*program.arguments(parts))
        return pack(done)

    packed = jax.tree.map(lambda x: picked(x, order).reshape(tiles, tile, -1), pack(own))
    done = jax.lax.map(advance, packed)
    done = jax.tree.map(lambda x: picked(x.reshape(tiles * tile, -1), back), done)
    like = jax.eval_shape(_worlds_first, program.shapes(leaves))
    return jax.tree.map(lambda x: jnp.moveaxis(x, 0, -1), unpack(done, like, 1))


def picked(values: Shaped[Array, "k ..."], rows: Int[Array, " n"]) -> Shaped[Array, "n ..."]:
    """Return rows by number; all numbers are valid."""
    return values.at[rows].get(mode="promise_in_bounds", wrap_negative_indices=False)


def _worlds_first(tree: Tree) -> Tree:
    return jax.tree.map(lambda x: jnp.moveaxis(x, -1, 0), tree)
