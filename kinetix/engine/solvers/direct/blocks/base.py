"""The contract of the contact blocks."""

import abc
from typing import Any, ClassVar

import jax.numpy as jnp
from jaxtyping import Array, Bool, Float, Int

from kinetix.engine.solvers.direct.response import Responses
from kinetix.pytree import pytree


@pytree
class Cone:
    """Allowed impulses: `c` normal rows, then their `c` tangent rows, then `l` limit rows.

    Normal and limit rows push only; a tangent row is bounded by friction times its normal row.
    """

    friction: Float[Array, "c n"]
    closed: Bool[Array, "c n"]
    """Only these contacts act; the others have no impulse at all."""
    limited: Bool[Array, "l n"]
    """The same for the limit rows."""


def project(cone: Cone, impulse: Float[Array, "m n"]) -> Float[Array, "m n"]:
    """Return the nearest allowed impulses, friction bounded by the normal impulse just found."""
    count = cone.friction.shape[0]
    normal = jnp.where(cone.closed, jnp.maximum(impulse[:count], 0), 0)
    bound = cone.friction * normal
    tangent = jnp.clip(impulse[count : 2 * count], -bound, bound)
    limit = jnp.where(cone.limited, jnp.maximum(impulse[2 * count :], 0), 0)
    return jnp.concatenate([normal, tangent, limit], axis=0)


class AbstractBlock(abc.ABC):
    """Solves  w = A λ + b,  λ in the cone,  λ ⟂ w  for many worlds at once.

    Subclasses are frozen dataclasses of Python numbers.
    """

    name: ClassVar[str]

    @abc.abstractmethod
    def prepare(self, responses: Responses, contrast: Float[Array, " n"]) -> Any:
        """Return what can be computed once for rows that serve several solves.

        Args:
            responses: A, row by row.
            contrast: How hard the contacts are to solve: the sum of the ratios of unlike loads, and
                of what the most burdened body bears.
        """

    def rounds(self, contrast: Float[Array, " n"]) -> Int[Array, " n"]:
        """Return the number of iterations of a solve where it depends on the contrast, else 0."""
        return jnp.zeros(contrast.shape, jnp.int32)

    @abc.abstractmethod
    def solve(
        self,
        prepared: Any,
        responses: Responses,
        offset: Float[Array, "m n"],
        start: Float[Array, "m n"],
        cone: Cone,
    ) -> Float[Array, "m n"]:
        """Return impulses in the cone that solve the problem as far as the iterations reach."""
