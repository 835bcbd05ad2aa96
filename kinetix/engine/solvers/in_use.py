"""Loops over the rows that a tile of worlds uses, so that the others cost nothing.

Worlds are on the last axis.
"""

from collections.abc import Callable
from typing import TypeVar

import jax
import jax.numpy as jnp
import numpy as np
from jaxtyping import Array, Bool, Float, Int

from kinetix.engine.lookup import row
from kinetix.pytree import pytree, static

T = TypeVar("T")


@pytree
class InUse:
    """How many contact points and joint limits any of the worlds uses: always the first ones."""

    points: Int[Array, ""]
    limits: Int[Array, ""]
    slots: int = static()
    """Contact slots: their normal rows come first, then their tangent rows, then the limits."""
    rows: int = static()
    """Of all slots."""

    @staticmethod
    def of(points: Bool[Array, "c n"], limits: Bool[Array, "l n"]) -> "InUse":
        """Up to the last slot that any world uses."""
        return InUse(
            points=_last_used(points),
            limits=_last_used(limits),
            slots=points.shape[0],
            rows=2 * points.shape[0] + limits.shape[0],
        )

    def each(self, visit: Callable[[Int[Array, ""], T], T], start: T) -> T:
        """Visit the rows in use: both rows of every point, then the limits."""

        def one(visited: Int[Array, ""], carry: T) -> T:
            of_point = visited // 2 + self.slots * (visited % 2)
            of_limit = visited - 2 * self.points + 2 * self.slots
            return visit(jnp.where(visited < 2 * self.points, of_point, of_limit), carry)

        # Not even the shape of a visit can be told where there are no rows.
        if self.rows == 0:
            return start
        return jax.lax.fori_loop(0, 2 * self.points + self.limits, one, start)

    def product(
        self, matrix: Float[Array, "m m n"], vector: Float[Array, "m n"]
    ) -> Float[Array, "m n"]:
        """A symmetric matrix times a vector that is 0 in rows that are not in use."""

        def add(k: Int[Array, ""], total: Float[Array, "m n"]) -> Float[Array, "m n"]:
            return total + row(matrix, k)[0] * row(vector, k)

        return self.each(add, jnp.zeros_like(vector))


def _last_used(mask: Bool[Array, "c n"]) -> Int[Array, ""]:
    """How many rows there are up to the last one that any world uses."""
    rows = np.arange(1, mask.shape[0] + 1, dtype=np.int32)
    return jnp.max(jnp.where(jnp.any(mask, axis=1), rows, 0), initial=0)
