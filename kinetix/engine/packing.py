"""Many small arrays of many worlds as a few large ones, and back: one to move instead of dozens."""

import math
from typing import Any, Final

import jax
import jax.numpy as jnp
from jaxtyping import Array, Shaped

Tree = Any

LARGE: Final = 200
"""Numbers a world from which on an array is moved by itself."""


def pack(tree: Tree) -> dict[str, Shaped[Array, "n _"]]:
    """Return all small arrays of a kind in one, worlds first: one to move instead of dozens."""
    groups: dict[str, list[Array]] = {}
    for number, leaf in enumerate(jax.tree.leaves(tree)):
        # Moving truth values takes several times as long as moving numbers.
        moved = leaf.astype(jnp.int8) if leaf.dtype == bool else leaf
        rows = jnp.moveaxis(moved, -1, 0).reshape(leaf.shape[-1], -1)
        groups.setdefault(_group(number, moved.dtype, rows.shape[1]), []).append(rows)
    return {name: jnp.concatenate(leaves, axis=1) for name, leaves in groups.items()}


def _group(number: int, dtype: Any, rows: int) -> str:
    """Return the group of a leaf: a large one stays alone, as cutting it out is a copy."""
    name = str(jnp.dtype(dtype))
    return f"{name} {number}" if rows >= LARGE else name


def unpack(packed: dict[str, Shaped[Array, "..."]], like: Tree, axis: int) -> Tree:
    """Undo `pack`; `like` has the shapes, but not the number of worlds.

    Args:
        packed: With the worlds on the last axis (axis 0) or on the first one (axis 1).
        like: A tree with the worlds on the same axis.
        axis: Along which the leaves stand one after the other.
    """
    first = dict.fromkeys(packed, 0)

    def cut(number: int, leaf: Any) -> Array:
        shape = leaf.shape[:-1] if axis == 0 else leaf.shape[1:]
        rows = math.prod(shape)
        group = _group(number, jnp.int8 if leaf.dtype == bool else leaf.dtype, rows)
        start = first[group]
        first[group] += rows
        part = jax.lax.slice_in_dim(packed[group], start, start + rows, axis=axis)
        part = part != 0 if leaf.dtype == bool else part
        worlds = packed[group].shape[1 - axis]
        return part.reshape((*shape, worlds) if axis == 0 else (worlds, *shape))

    leaves, structure = jax.tree.flatten(like)
    return jax.tree.unflatten(structure, [cut(*each) for each in enumerate(leaves)])
