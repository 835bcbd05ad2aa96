"""From one world to many: `vmap(step)` runs the solvers' own batched kernel, worlds last.

A solver's arrays carry the worlds on the last axis, so that inner loops run over worlds instead of
over a handful of bodies. `jax.custom_batching.custom_vmap` lets callers write for one world, batch
with `vmap` (nested too) and still hit that kernel.
"""

import functools
from collections.abc import Callable
from typing import Any

import jax
import jax.numpy as jnp
from jax.custom_batching import custom_vmap

Tree = Any

TILE = 64
"""Worlds that are advanced together: few enough for the cache, enough to fill a core's lanes."""


def worlds_last(kernel: Callable[..., Tree]) -> Callable[..., Tree]:
    """Give a kernel that works on arrays with a last axis of worlds the look of one for one world.

    Args:
        kernel: Takes pytrees whose arrays end in the axis `n`, returns the same kind.

    Returns:
        A function of the same pytrees without that axis.
    """

    @custom_vmap
    def many(*arguments: Tree) -> Tree:
        return _by_tiles(kernel, arguments)

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


def _by_tiles(kernel: Callable[..., Tree], arguments: tuple[Tree, ...]) -> Tree:
    """Run the kernel on `TILE` worlds at a time, one tile after the other."""
    worlds = jax.tree.leaves(arguments)[0].shape[-1]
    if worlds <= TILE:
        return kernel(*arguments)
    tiles = -(-worlds // TILE)
    padding = tiles * TILE - worlds

    def cut(x: jax.Array) -> jax.Array:
        # Whole worlds are repeated, so that what fills the last tile is as sane as the rest.
        x = jnp.pad(x, [(0, 0)] * (x.ndim - 1) + [(0, padding)], mode="edge") if padding else x
        return jnp.moveaxis(x.reshape(*x.shape[:-1], tiles, TILE), -2, 0)

    def join(x: jax.Array) -> jax.Array:
        return jnp.moveaxis(x, 0, -2).reshape(*x.shape[1:-1], tiles * TILE)[..., :worlds]

    done = jax.lax.map(lambda tile: kernel(*tile), jax.tree.map(cut, arguments))
    return jax.tree.map(join, done)


def _merge(x: jax.Array, has_axis: bool, *, axis_size: int, worlds: int) -> jax.Array:
    """(m, …, n) or (…, n) to (…, m·n)."""
    if not has_axis:
        x = jnp.broadcast_to(x, (axis_size, *x.shape))
    return jnp.moveaxis(x, 0, -2).reshape(*x.shape[1:-1], axis_size * worlds)


def _split(x: jax.Array, axis_size: int, worlds: int) -> jax.Array:
    """(…, m·n) to (m, …, n)."""
    return jnp.moveaxis(x.reshape(*x.shape[:-1], axis_size, worlds), -2, 0)
