"""A function of a whole batch under `vmap`: it runs once, worlds first."""

from collections.abc import Callable
from typing import Any

import jax
import jax.numpy as jnp
from jax.custom_batching import custom_vmap
from jaxtyping import Array

Tree = Any


def worlds_first(batched: Callable[..., Tree]) -> Callable[..., Tree]:
    """Give a function of a whole batch the look of one for one world.

    Args:
        batched: Takes and returns pytrees with the worlds on the first axis of every array.

    Returns:
        The same function without that axis; under `vmap`, nested or not, `batched` runs once.
    """

    @custom_vmap
    def many(*trees: Tree) -> Tree:
        return batched(*trees)

    @many.def_vmap
    def _(size: int, mapped: list[Any], *trees: Tree) -> tuple[Tree, Tree]:
        trees = _with_axis(size, mapped, trees)
        # By numbers: where a size has no room for something, -1 could be any.
        flat = many(*jax.tree.map(lambda x: x.reshape(size * x.shape[1], *x.shape[2:]), trees))
        out = jax.tree.map(lambda x: x.reshape(size, len(x) // size, *x.shape[1:]), flat)
        return out, jax.tree.map(lambda _: True, out)

    @custom_vmap
    def one(*trees: Tree) -> Tree:
        out = many(*jax.tree.map(lambda x: jnp.asarray(x)[None], trees))
        return jax.tree.map(lambda x: x[0], out)

    @one.def_vmap
    def _(size: int, mapped: list[Any], *trees: Tree) -> tuple[Tree, Tree]:
        out = many(*_with_axis(size, mapped, trees))
        return out, jax.tree.map(lambda _: True, out)

    return one


def _with_axis(size: int, mapped: list[Any], trees: tuple[Tree, ...]) -> tuple[Tree, ...]:
    """Return the arguments with the mapped axis on every array."""

    def widen(has_axis: bool, x: Any) -> Array:
        x = jnp.asarray(x)
        return x if has_axis else jnp.broadcast_to(x, (size, *x.shape))

    return jax.tree.map(widen, tuple(mapped), trees)
