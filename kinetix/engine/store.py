"""Keeping intermediate results, where XLA would compute them again and again.

XLA's CPU fusion inlines a producer into every consumer: a matrix computed from rows and then
multiplied is recomputed for every entry of the product (measured: 342 ms instead of 2 ms for one
product of 1024 worlds). `optimization_barrier` is dropped before fusion; a conditional is not
entered by it. See docs/physics.md for the measurements.
"""

from typing import TypeVar

import jax
import jax.numpy as jnp
from jaxtyping import Array, Bool, Float

from kinetix.engine.machine import takes_whole_batches
from kinetix.pytree import pytree

T = TypeVar("T")


@pytree
class Store:
    """Call it on a pytree to have its arrays written to memory once."""

    always: Bool[Array, ""]
    """True, but not so that the compiler could know."""

    @staticmethod
    def beside(values: Float[Array, "..."]) -> "Store":
        """A store whose condition hangs on values that only exist at run time (NaN included)."""
        return Store(always=~(values.ravel()[0] > 1e30))

    def __call__(self, tree: T) -> T:
        """The same values, computed exactly once."""
        if takes_whole_batches():
            return tree
        return jax.lax.cond(
            self.always, lambda x: x, lambda x: jax.tree.map(jnp.zeros_like, x), tree
        )
