"""Lever arms and masses of the two bodies of a constraint.

Worlds are on the last axis.
"""

import jax.numpy as jnp
from jaxtyping import Array, Float

from kinetix.engine.lookup import take
from kinetix.engine.maths import Vec, cross, nonzero
from kinetix.engine.solvers.visit import Targets, Twist
from kinetix.pytree import pytree


@pytree
class Lever:
    """Two bodies and the places where they act on each other."""

    arm_a: Vec
    arm_b: Vec
    mass_a: Float[Array, "*k n"]
    """Inverse masses; of the copies where bodies are split (`visit.together`)."""
    mass_b: Float[Array, "*k n"]
    inertia_a: Float[Array, "*k n"]
    inertia_b: Float[Array, "*k n"]
    copied: Float[Array, "*k n"]
    """Factor by which copies are lighter than their bodies, both of a slot together; 1: whole."""

    def speed(self, a: Twist, b: Twist) -> Vec:
        """Velocity of b relative to a where they meet."""
        return Vec(
            x=b.x - a.x - b.turn * self.arm_b.y + a.turn * self.arm_a.y,
            y=b.y - a.y + b.turn * self.arm_b.x - a.turn * self.arm_a.x,
        )

    def resistance(self, direction: Vec) -> Float[Array, "*k n"]:
        """Change of the relative speed along a direction per unit of impulse; never 0."""
        return nonzero(
            self.mass_a
            + self.mass_b
            + self.inertia_a * cross(self.arm_a, direction) ** 2
            + self.inertia_b * cross(self.arm_b, direction) ** 2
        )

    def push(self, impulse: Vec, twist: Float[Array, "*k n"] | float = 0.0) -> tuple[Twist, Twist]:
        """Return the changes by an impulse on b and its opposite on a; `twist` only turns."""
        return (
            Twist(
                x=-self.mass_a * impulse.x,
                y=-self.mass_a * impulse.y,
                turn=-self.inertia_a * (cross(self.arm_a, impulse) + twist),
            ),
            Twist(
                x=self.mass_b * impulse.x,
                y=self.mass_b * impulse.y,
                turn=self.inertia_b * (cross(self.arm_b, impulse) + twist),
            ),
        )


@pytree
class SplitMasses:
    """Inverse masses of all bodies, and in how many copies each is solved."""

    linear: Float[Array, "b n"]
    angular: Float[Array, "b n"]
    copies: Float[Array, "b n"]

    def lever(self, targets: Targets, arm_a: Vec, arm_b: Vec) -> Lever:
        """Arms together with the masses of the copies that they move."""
        a, b = targets.body_a, targets.body_b
        whole_a, whole_b = take(self.linear, a), take(self.linear, b)
        mass_a, mass_b = whole_a * targets.share_a, whole_b * targets.share_b
        return Lever(
            arm_a=arm_a,
            arm_b=arm_b,
            mass_a=mass_a,
            mass_b=mass_b,
            inertia_a=take(self.angular, a) * targets.share_a,
            inertia_b=take(self.angular, b) * targets.share_b,
            copied=jnp.maximum((mass_a + mass_b) / nonzero(whole_a + whole_b), 1),
        )

    def targets(self, body_a: Array, body_b: Array) -> Targets:
        """Return slots on these bodies."""
        return Targets(
            body_a=body_a,
            body_b=body_b,
            share_a=take(self.copies, body_a),
            share_b=take(self.copies, body_b),
        )
