"""Keeping intermediate results, where XLA would compute them again and again.

XLA's CPU fusion inlines a producer into every consumer: a matrix computed from rows and then
multiplied is recomputed for every entry of the product (measured: 342 ms instead of 2 ms for one
product of 1024 worlds). `optimization_barrier` is dropped before fusion; a conditional is not
entered by it. See docs/physics.md for the measurements.
"""

from typing import Any, TypeVar

import jax
import jax.numpy as jnp
from jaxtyping import Array, Bool, Float

from kinetix.engine.backend import takes_whole_batches
from kinetix.pytree import pytree

T = TypeVar("T")


@pytree
class Store:
    """Call it on a pytree to have its arrays written to memory once."""

    always: Bool[Array, ""]
    """True, but not so that the compiler could know."""

    @staticmethod
    def beside(values: Float[Array, "..."]) -> "Store":
        """A store whose condition depends on values that only exist at run time (NaN included)."""
        return Store(always=~(values.ravel()[0] > 1e30))

    def __call__(self, tree: T) -> T:
        """Return the same values, computed exactly once."""
        if takes_whole_batches():
            return tree
        return jax.lax.cond(self.always, lambda x: x, _other, tree)


def _other(tree: T) -> T:
    """Return something of the same shapes for the branch that is never taken.

    With the same values XLA would drop the conditional. Leaves of one shape and type swap places,
    which compiles to nothing; only a leaf without such a partner is replaced by zeros.
    """
    leaves, structure = jax.tree.flatten(tree)
    alike: dict[Any, list[int]] = {}
    for place, leaf in enumerate(leaves):
        alike.setdefault((leaf.shape, leaf.dtype), []).append(place)
    others = list(leaves)
    for places in alike.values():
        for place, next_place in zip(places, [*places[1:], places[0]], strict=True):
            alone = place == next_place
            others[place] = jnp.zeros_like(leaves[place]) if alone else leaves[next_place]
    return jax.tree.unflatten(structure, others)
