"""Contact block by projected Gauss–Seidel on the joint-eliminated matrix."""

import dataclasses
from typing import Any, ClassVar

import jax
import jax.numpy as jnp
from jaxtyping import Array, Float, Int

from kinetix.engine.maths import nonzero
from kinetix.engine.solvers.blocks.base import AbstractBlock, Cone, project
from kinetix.engine.solvers.rows import matvec


@dataclasses.dataclass(frozen=True, kw_only=True)
class Pgs(AbstractBlock):
    """Row after row; each row is solved exactly with the others held.

    Source: Catto (2005), "Iterative Dynamics with Temporal Coherence".
    """

    name: ClassVar[str] = "pgs"
    iterations: int = 8

    def prepare(self, matrix: Float[Array, "m m n"]) -> Any:
        """Nothing."""
        del matrix

    def solve(
        self,
        prepared: Any,
        matrix: Float[Array, "m m n"],
        offset: Float[Array, "m n"],
        start: Float[Array, "m n"],
        cone: Cone,
    ) -> Float[Array, "m n"]:
        """See the contract."""
        del prepared
        count = cone.friction.shape[0]
        start = project(cone, start)
        speed = matvec(matrix, start) + offset

        def relax(
            row: Int[Array, ""], impulse: Array, speed: Array, low: Array | float, high: Array
        ) -> tuple:
            old = impulse[row]
            column = jax.lax.dynamic_index_in_dim(matrix, row, 1, keepdims=False)
            new = jnp.clip(old - speed[row] / nonzero(column[row]), low, high)
            return impulse.at[row].set(new), speed + column * (new - old)

        def sweep(_: Any, carry: tuple) -> tuple:
            def point(k: Int[Array, ""], carry: tuple) -> tuple:
                impulse, speed = carry
                bound = cone.friction[k] * impulse[k]
                impulse, speed = relax(count + k, impulse, speed, -bound, bound)
                return relax(k, impulse, speed, 0.0, jnp.where(cone.closed[k], jnp.inf, 0.0))

            def limit(k: Int[Array, ""], carry: tuple) -> tuple:
                impulse, speed = carry
                return relax(
                    2 * count + k, impulse, speed, 0.0, jnp.where(cone.limited[k], jnp.inf, 0.0)
                )

            carry = jax.lax.fori_loop(0, count, point, carry)
            return jax.lax.fori_loop(0, cone.limited.shape[0], limit, carry)

        impulse, _ = jax.lax.fori_loop(0, self.iterations, sweep, (start, speed))
        return project(cone, impulse)
