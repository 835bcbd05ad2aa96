"""From one world to many: `vmap(step)` runs the solvers' own batched kernel, worlds last.

A solver's arrays carry the worlds on the last axis, so that inner loops run over worlds instead of
over a handful of bodies. `jax.custom_batching.custom_vmap` lets callers write for one world, batch
with `vmap` (nested too) and still hit that kernel.
"""

import functools
import math
from collections.abc import Callable
from typing import Any

import jax
import jax.numpy as jnp
from jax.custom_batching import custom_vmap
from jaxtyping import Array, Int, Shaped

from kinetix.engine.store import Store

Tree = Any

TILE = 64
"""Worlds that are advanced together: few enough for the cache, enough to fill a core's lanes."""


def worlds_last(
    kernel: Callable[..., Tree], effort: Callable[..., Int[Array, " n"]] | None = None
) -> Callable[..., Tree]:
    """Give a kernel that works on arrays with a last axis of worlds the look of one for one world.

    Args:
        kernel: Takes pytrees whose arrays end in the axis `n`, some of them of floats; returns
            the same kind.
        effort: How much work each world will be, from the same arguments, if that differs. A tile
            takes as long as its hardest world: those of like effort are advanced together.

    Returns:
        A function of the same pytrees without that axis.
    """

    @custom_vmap
    def many(*arguments: Tree) -> Tree:
        return _by_tiles(kernel, effort, arguments)

    @many.def_vmap
    def _(axis_size: int, batched: list, *arguments: Tree) -> tuple[Tree, Tree]:
        worlds = jax.tree.leaves(arguments)[0].shape[-1]
        merged = jax.tree.map(
            functools.partial(_merge, axis_size=axis_size, worlds=worlds), arguments, tuple(batched)
        )
        out = jax.tree.map(lambda x: _split(x, axis_size, worlds), many(*merged))
        return out, jax.tree.map(lambda _: True, out)

    @custom_vmap
    def one(*arguments: Tree) -> Tree:
        out = many(*jax.tree.map(lambda x: jnp.asarray(x)[..., None], arguments))
        return jax.tree.map(lambda x: x[..., 0], out)

    @one.def_vmap
    def _(axis_size: int, batched: list, *arguments: Tree) -> tuple[Tree, Tree]:
        moved = jax.tree.map(
            lambda x, has_axis: (
                jnp.moveaxis(x, 0, -1)
                if has_axis
                else jnp.broadcast_to(jnp.asarray(x)[..., None], (*jnp.shape(x), axis_size))
            ),
            arguments,
            tuple(batched),
        )
        out = jax.tree.map(lambda x: jnp.moveaxis(x, -1, 0), many(*moved))
        return out, jax.tree.map(lambda _: True, out)

    return one


def _by_tiles(
    kernel: Callable[..., Tree],
    effort: Callable[..., Int[Array, " n"]] | None,
    arguments: tuple[Tree, ...],
) -> Tree:
    """Run the kernel on `TILE` worlds at a time, one tile after the other."""
    worlds = jax.tree.leaves(arguments)[0].shape[-1]
    if worlds <= TILE:
        return kernel(*arguments)
    tiles = -(-worlds // TILE)
    # Whole worlds are repeated, so that what fills the last tile is as sane as the rest.
    order = jnp.arange(worlds) if effort is None else jnp.argsort(effort(*arguments))
    order = jnp.pad(order, (0, tiles * TILE - worlds), mode="edge")
    back = jnp.zeros(worlds, order.dtype).at[order].set(jnp.arange(tiles * TILE))

    def advance(packed: dict[str, Array]) -> dict[str, Array]:
        turned = jax.tree.map(jnp.transpose, packed)
        floats = next(x for x in turned.values() if jnp.issubdtype(x.dtype, jnp.floating))
        turned = Store.beside(floats)(turned)
        done = kernel(*_unpack(turned, arguments, 0))
        return jax.tree.map(jnp.transpose, _pack(done, 0))

    def ordered(x: Shaped[Array, "k rows"], order: Int[Array, " n"]) -> Shaped[Array, "n rows"]:
        return x.at[order].get(mode="promise_in_bounds", wrap_negative_indices=False)

    packed = jax.tree.map(
        lambda x: ordered(x, order).reshape(tiles, TILE, -1), _pack(_worlds_first(arguments), 1)
    )
    done = jax.lax.map(advance, packed)
    done = jax.tree.map(lambda x: ordered(x.reshape(tiles * TILE, -1), back), done)
    like = jax.eval_shape(_worlds_first, jax.eval_shape(kernel, *arguments))
    return jax.tree.map(lambda x: jnp.moveaxis(x, 0, -1), _unpack(done, like, 1))


def _worlds_first(tree: Tree) -> Tree:
    return jax.tree.map(lambda x: jnp.moveaxis(x, -1, 0), tree)


def _pack(tree: Tree, axis: int) -> dict[str, Shaped[Array, "..."]]:
    """All arrays of a kind in one: one to move instead of dozens.

    Args:
        tree: Arrays with the worlds on the last axis (axis 0) or on the first one (axis 1).
        axis: Of the result, along which they stand one after the other.
    """
    kinds: dict[str, list[Array]] = {}
    for leaf in jax.tree.leaves(tree):
        # Moving truth values takes several times as long as moving numbers.
        moved = leaf.astype(jnp.int8) if leaf.dtype == bool else leaf
        shape = (-1, leaf.shape[-1]) if axis == 0 else (leaf.shape[0], -1)
        kinds.setdefault(str(moved.dtype), []).append(moved.reshape(shape))
    return {kind: jnp.concatenate(leaves, axis=axis) for kind, leaves in kinds.items()}


def _unpack(packed: dict[str, Shaped[Array, "..."]], like: Tree, axis: int) -> Tree:
    """The inverse of `_pack`; `like` tells the shapes, but not how many worlds there are."""
    first = dict.fromkeys(packed, 0)

    def cut(leaf: Any) -> Array:
        kind = "int8" if leaf.dtype == bool else str(leaf.dtype)
        shape = leaf.shape[:-1] if axis == 0 else leaf.shape[1:]
        rows, start = math.prod(shape), first[kind]
        first[kind] += rows
        part = jax.lax.slice_in_dim(packed[kind], start, start + rows, axis=axis)
        part = part != 0 if leaf.dtype == bool else part
        worlds = packed[kind].shape[1 - axis]
        return part.reshape((*shape, worlds) if axis == 0 else (worlds, *shape))

    return jax.tree.map(cut, like)


def _merge(x: jax.Array, has_axis: bool, *, axis_size: int, worlds: int) -> jax.Array:
    """(m, …, n) or (…, n) to (…, m·n)."""
    if not has_axis:
        x = jnp.broadcast_to(x, (axis_size, *x.shape))
    return jnp.moveaxis(x, 0, -2).reshape(*x.shape[1:-1], axis_size * worlds)


def _split(x: jax.Array, axis_size: int, worlds: int) -> jax.Array:
    """(…, m·n) to (m, …, n)."""
    return jnp.moveaxis(x.reshape(*x.shape[:-1], axis_size, worlds), -2, 0)
