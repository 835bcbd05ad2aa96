"""Soft constraints: damped springs that are integrated implicitly, and their three numbers.

Source: Catto (2011), "Soft Constraints"; the formulas are written out in docs/physics.md.
"""

import dataclasses
import math

import jax.numpy as jnp
from jaxtyping import Array, Float

from kinetix.pytree import pytree


@pytree
class Softness:
    """Share of a constraint's error that one visit corrects."""

    rate: Float[Array, "*k n"]
    """Share of the position error to take away per second [1/s]."""
    mass: Float[Array, "*k n"]
    """Scale of the effective mass; 1: rigid."""
    keep: Float[Array, "*k n"]
    """Share of the accumulated impulse that is given back; 0: rigid."""


@dataclasses.dataclass(frozen=True, kw_only=True)
class Spring:
    """Frequency and damping of a soft constraint."""

    hertz: float
    """Natural frequency [1/s]. Higher: stiffer, until the step cannot follow."""
    damping: float
    """Damping ratio. Above 1 an error fades without swinging."""
    share: float
    """The frequency is at most this share of the rate of (sub)steps."""

    def at(
        self,
        h: Float[Array, " n"],
        stiffer: Float[Array, "*k n"],
        copied: Float[Array, "*k n"],
    ) -> Softness:
        """Return the three numbers, a slot.

        Args:
            h: Duration of a substep [s].
            stiffer: Multiplies the frequency.
            copied: By how much the resistance of the copies exceeds that of the bodies: they must
                not make the spring softer.
        """
        omega = 2 * math.pi * jnp.minimum(self.hertz, self.share / h) * stiffer
        first = 2 * self.damping + h * omega
        second = h * omega * first * copied
        keep = 1 / (1 + second)
        return Softness(rate=omega / first, mass=second * keep, keep=keep)
