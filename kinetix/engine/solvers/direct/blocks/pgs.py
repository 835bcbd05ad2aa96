"""Contact block by projected Gauss–Seidel on the velocities of the bodies, joints eliminated."""

import dataclasses
from typing import Any, ClassVar

import jax
import jax.numpy as jnp
from jaxtyping import Array, Float, Int

from kinetix.engine.active_rows import InUse
from kinetix.engine.lookup import put, row
from kinetix.engine.maths import nonzero
from kinetix.engine.solvers.direct.blocks.base import AbstractBlock, Cone, project
from kinetix.engine.solvers.direct.response import Responses
from kinetix.engine.store import Store

EASY_CONTRAST = 25.0
"""Sum of the ratios of unlike loads, contact point by contact point, up to which the usual number
of sweeps does."""

MOST_SWEEPS = 6.0
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

    def prepare(self, responses: Responses, contrast: Float[Array, " n"]) -> Any:
        """Return the number of sweeps."""
        del responses
        return self.rounds(contrast)

    def rounds(self, contrast: Float[Array, " n"]) -> Int[Array, " n"]:
        """See the contract; a conjugate gradient method needs more by the root of the contrast."""
        share = jnp.clip(jnp.sqrt(contrast / EASY_CONTRAST), 1, MOST_SWEEPS)
        return jnp.round(self.iterations * share).astype(jnp.int32)

    def solve(
        self,
        prepared: Any,
        responses: Responses,
        offset: Float[Array, "m n"],
        start: Float[Array, "m n"],
        cone: Cone,
    ) -> Float[Array, "m n"]:
        """Solve for the impulses by projected Gauss–Seidel sweeps."""
        if offset.shape[0] == 0:
            return start
        store = Store.beside(offset)
        sweep = _Sweep(responses=responses, offset=offset, cone=cone, store=store)
        in_use = InUse.of((cone.closed, 2), (cone.limited, 1))
        start = store(project(cone, start))
        motion = responses.moved(start)

        def accelerated(done: Int[Array, ""], carry: tuple) -> tuple:
            result, impulse, motion, direction, of_direction, last = carry
            swept, swept_motion = sweep(in_use, (impulse, motion))
            # Other worlds of the tile may need more sweeps; the result of a world must not depend
            # on them.
            counts = done < prepared

            def add_square(k: Int[Array, ""], total: Float[Array, " n"]) -> Float[Array, " n"]:
                return total + (_at(swept, k) - _at(impulse, k)) ** 2

            size = in_use.each(add_square, jnp.zeros_like(last))
            share = size / nonzero(last)
            share = store(jnp.where((share < 1) & (last > 0), share, 0))

            def go_on(k: Int[Array, ""], carry: tuple) -> tuple:
                result, impulse, direction = carry
                found, along = _at(swept, k), _at(direction, k)
                found, ahead, along = store(
                    (
                        jnp.where(counts, found, _at(result, k)),
                        found + share * along,
                        share * along + (found - _at(impulse, k)),
                    )
                )
                return (
                    put(result, found[None], k, 0),
                    put(impulse, ahead[None], k, 0),
                    put(direction, along[None], k, 0),
                )

            result, impulse, direction = in_use.each(go_on, (result, impulse, direction))
            return (
                result,
                impulse,
                swept_motion + share * of_direction,
                direction,
                share * of_direction + (swept_motion - motion),
                size,
            )

        carry = (
            start,
            start,
            motion,
            jnp.zeros_like(start),
            jnp.zeros_like(motion),
            jnp.zeros_like(start[0]),
        )
        most = jnp.max(prepared)
        result, *_ = jax.lax.fori_loop(0, most, accelerated, carry)
        return project(cone, result)


@dataclasses.dataclass(frozen=True, kw_only=True)
class _Sweep:
    """One visit of all rows in use; what is carried are the impulses and the bodies' motion."""

    responses: Responses
    offset: Float[Array, "m n"]
    cone: Cone
    store: Store

    def __call__(self, in_use: InUse, carry: tuple) -> tuple:
        points_used, limits_used = in_use.counts
        if self.cone.friction.shape[0] > 0:
            # One point of each pair of polygons, then the others: side by side, they would tilt a
            # stack to and fro.
            half = (points_used + 1) // 2

            def point(visit: Int[Array, ""], carry: tuple) -> tuple:
                odd = visit >= half
                return self._point(jnp.where(odd, 2 * (visit - half) + 1, 2 * visit), carry)

            carry = jax.lax.fori_loop(0, points_used, point, carry)
        if self.cone.limited.shape[0] > 0:
            carry = jax.lax.fori_loop(0, limits_used, self._limit, carry)
        return carry

    def _wanted(
        self, index: Int[Array, ""], speed: Float[Array, " n"], old: Float[Array, " n"]
    ) -> Float[Array, " n"]:
        """Return the impulse that would bring a row to rest, the others held."""
        speed = speed + _at(self.offset, index) + _at(self.responses.compliance, index) * old
        return old - speed * _at(self.responses.inverse_own, index)

    def _point(self, k: Int[Array, ""], carry: tuple) -> tuple:
        """Return the tangent row of a contact, then its normal row."""
        impulse, motion = carry
        responses, cone = self.responses, self.cone
        along = cone.friction.shape[0] + k
        normal, tangent = _at(impulse, k), _at(impulse, along)
        closing, sliding = responses.point_speeds(k, along, motion)
        bound = _at(cone.friction, k) * jnp.maximum(normal, 0)
        turned = jnp.clip(self._wanted(along, sliding, tangent), -bound, bound)
        closing += _at(responses.normal_by_tangent, k) * (turned - tangent)
        pushed = jnp.maximum(self._wanted(k, closing, normal), 0)
        pushed = jnp.where(_at(cone.closed, k), pushed, 0)
        # Once these are stored, what is carried changes in place; else it would be copied.
        turned, pushed, by_tangent, by_normal = self.store(
            (turned, pushed, turned - tangent, pushed - normal)
        )
        of_rows = responses.of_rows
        motion += _at(of_rows, along) * by_tangent + _at(of_rows, k) * by_normal
        return put(put(impulse, turned[None], along, 0), pushed[None], k, 0), motion

    def _limit(self, k: Int[Array, ""], carry: tuple) -> tuple:
        impulse, motion = carry
        index = 2 * self.cone.friction.shape[0] + k
        old = _at(impulse, index)
        new = jnp.maximum(self._wanted(index, self.responses.speed(index, motion), old), 0)
        new = jnp.where(_at(self.cone.limited, k), new, 0)
        new, change = self.store((new, new - old))
        motion += _at(self.responses.of_rows, index) * change
        return put(impulse, new[None], index, 0), motion


def _at(values: Float[Array, "k *rest n"], index: Int[Array, ""]) -> Float[Array, "*rest n"]:
    return row(values, index)[0]
