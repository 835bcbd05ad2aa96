"""Contact block by projected Gauss–Seidel on the joint-eliminated matrix."""

import dataclasses
from typing import Any, ClassVar

import jax
import jax.numpy as jnp
import numpy as np
from jaxtyping import Array, Float, Int

from kinetix.engine.lookup import put, row
from kinetix.engine.maths import nonzero
from kinetix.engine.solvers.blocks.base import AbstractBlock, Cone, project
from kinetix.engine.solvers.in_use import InUse
from kinetix.engine.store import Store

EASY_CONTRAST = 60.0
"""Ratio of touching masses up to which the usual number of sweeps does."""

MOST_SWEEPS = 4.0
"""Times the usual number of sweeps, at most."""


@dataclasses.dataclass(frozen=True, kw_only=True)
class Pgs(AbstractBlock):
    """Point after point, each row solved exactly with the others held; sweeps are accelerated.

    Successive sweeps serve as the gradients of a nonlinear conjugate gradient method that falls
    back to plain sweeps where it does not descend: a stack of 20 boxes and a load of 100 times the
    carrier's mass stand after a fifth of the sweeps. Only as many points are visited as any of the
    worlds uses: what a scene does not touch costs nothing. Where a light body carries a heavy one,
    more sweeps are made.
    Source: Catto (2005), "Iterative Dynamics with Temporal Coherence"; Silcowitz-Hansen, Niebe &
    Erleben (2010), "A Nonsmooth Nonlinear Conjugate Gradient Method for Interactive Contact Force
    Problems".
    """

    name: ClassVar[str] = "pgs"
    iterations: int = 10

    def prepare(self, matrix: Float[Array, "m m n"], contrast: Float[Array, " n"]) -> Any:
        """One over the diagonal, and the number of sweeps.

        What a conjugate gradient method needs grows with the root of the contrast.
        """
        index = np.arange(matrix.shape[0])
        share = jnp.clip(jnp.sqrt(contrast / EASY_CONTRAST), 1, MOST_SWEEPS)
        return 1 / nonzero(matrix[index, index]), jnp.round(self.iterations * share)

    def solve(
        self,
        prepared: Any,
        matrix: Float[Array, "m m n"],
        offset: Float[Array, "m n"],
        start: Float[Array, "m n"],
        cone: Cone,
    ) -> Float[Array, "m n"]:
        """See the contract."""
        if offset.shape[0] == 0:
            return start
        count, limits = cone.friction.shape[0], cone.limited.shape[0]
        store = Store.beside(offset)
        mobility, sweeps = prepared

        def at(values: Float[Array, "k n"], index: Int[Array, ""]) -> Float[Array, " n"]:
            return row(values, index)[0]

        def point(k: Int[Array, ""], carry: tuple) -> tuple:
            impulse, speed = carry
            normal, tangent = at(impulse, k), at(impulse, count + k)
            bound = at(cone.friction, k) * jnp.maximum(normal, 0)
            turned = tangent - at(speed, count + k) * at(mobility, count + k)
            turned = jnp.clip(turned, -bound, bound)
            across = at(at(matrix, k), count + k)
            closing = at(speed, k) + across * (turned - tangent)
            pushed = jnp.maximum(normal - closing * at(mobility, k), 0)
            pushed = jnp.where(at(cone.closed, k), pushed, 0)
            # Once these are stored, what is carried changes in place; else it would be copied. Rows
            # stand for the columns of the symmetric matrix: they lie together in memory.
            turned, pushed, by_tangent, by_normal = store(
                (turned, pushed, turned - tangent, pushed - normal)
            )
            speed += at(matrix, count + k) * by_tangent + at(matrix, k) * by_normal
            return put(put(impulse, turned[None], count + k, 0), pushed[None], k, 0), speed

        def limit(k: Int[Array, ""], carry: tuple) -> tuple:
            impulse, speed = carry
            index = 2 * count + k
            old = at(impulse, index)
            new = jnp.maximum(old - at(speed, index) * at(mobility, index), 0)
            new = jnp.where(at(cone.limited, k), new, 0)
            new, change = store((new, new - old))
            return put(impulse, new[None], index, 0), speed + at(matrix, index) * change

        in_use = InUse.of((cone.closed, 2), (cone.limited, 1))
        points_used, limits_used = in_use.counts

        def sweep(carry: tuple) -> tuple:
            if count > 0:
                carry = jax.lax.fori_loop(0, points_used, point, carry)
            if limits > 0:
                carry = jax.lax.fori_loop(0, limits_used, limit, carry)
            return carry

        def accelerated(done: Int[Array, ""], carry: tuple) -> tuple:
            result, impulse, speed, direction, of_direction, last = carry
            swept, swept_speed = sweep((impulse, speed))
            # Others in the tile may need more sweeps; what a world gets must not hang on them.
            result = jnp.where(done < sweeps, swept, result)
            change = swept - impulse
            size = in_use.inner(change, change)
            share = size / nonzero(last)
            share = store(jnp.where((share < 1) & (last > 0), share, 0))
            return (
                result,
                swept + share * direction,
                swept_speed + share * of_direction,
                share * direction + change,
                share * of_direction + (swept_speed - speed),
                size,
            )

        start = store(project(cone, start))
        zero = jnp.zeros_like(start)
        carry = (start, start, in_use.product(matrix, start) + offset, zero, zero, zero[0])
        most = jnp.max(sweeps).astype(jnp.int32)
        result, *_ = jax.lax.fori_loop(0, most, accelerated, carry)
        return project(cone, result)
