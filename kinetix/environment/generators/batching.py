"""Natively batched functions behind an interface for one world."""

from collections.abc import Callable
from typing import Any, TypeVar

import jax
import jax.numpy as jnp
from jax.custom_batching import custom_vmap
from jaxtyping import Array

T = TypeVar("T")


def for_one_world(batched: Callable[..., T]) -> Callable[..., T]:
    """Make a function of one world from a batched one, which `vmap` then finds again.

    Args:
        batched: Takes and gives pytrees with the worlds on the first axis of every leaf.

    Returns:
        The same function without that axis; under `vmap`, nested or not, the batched one runs once.
    """

    @custom_vmap
    def many(*trees: Any) -> T:
        return batched(*trees)

    @many.def_vmap
    def flatten(axis_size: int, in_batched: list[Any], *trees: Any) -> Any:
        trees = _mapped(axis_size, in_batched, trees)
        flat = many(*jax.tree.map(lambda leaf: leaf.reshape(-1, *leaf.shape[2:]), trees))
        out = jax.tree.map(lambda leaf: leaf.reshape(axis_size, -1, *leaf.shape[1:]), flat)
        return out, jax.tree.map(lambda _: True, out)

    @custom_vmap
    def single(*trees: Any) -> T:
        out = many(*jax.tree.map(lambda leaf: jnp.asarray(leaf)[None], trees))
        return jax.tree.map(lambda leaf: leaf[0], out)

    @single.def_vmap
    def gather(axis_size: int, in_batched: list[Any], *trees: Any) -> Any:
        out = many(*_mapped(axis_size, in_batched, trees))
        return out, jax.tree.map(lambda _: True, out)

    return single


def _mapped(axis_size: int, in_batched: list[Any], trees: tuple[Any, ...]) -> tuple[Any, ...]:
    """The arguments with the mapped axis on every leaf."""

    def widen(batched: bool, leaf: Array) -> Array:
        leaf = jnp.asarray(leaf)
        return leaf if batched else jnp.broadcast_to(leaf[None], (axis_size, *leaf.shape))

    return jax.tree.map(widen, tuple(in_batched), trees)
