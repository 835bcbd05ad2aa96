"""Responses of all bodies to impulses on contacts and limits, through the joints. Worlds last.

A row's *response* is the change of all velocities per unit of its impulse. So a solver need not
couple rows with rows: room for more contacts costs memory alone, and time goes with the contacts
that there are.
"""

import jax.numpy as jnp
from jaxtyping import Array, Float, Int

from kinetix.engine.active_rows import InUse
from kinetix.engine.lookup import put, row, take
from kinetix.engine.solvers.rows import Rows
from kinetix.engine.spec import ARENA_BODIES
from kinetix.pytree import pytree

Motion = Float[Array, "3 b n"]
"""Velocities (x, y, angular) of all bodies behind the arena's, which never move."""

MOST_TERMS = 24
"""Sums over more bodies than this are loops."""


@pytree
class Responses:
    """`m` rows and what they do."""

    rows: Rows
    of_rows: Float[Array, "m 3 b n"]
    """Change of all velocities per unit of a row's impulse; defined for rows in use."""
    compliance: Float[Array, "m n"]
    """Speed that a row lets through per unit of its impulse, beside what its bodies do."""
    normal_by_tangent: Float[Array, "c n"]
    """Change of a contact's normal speed per unit of its tangent impulse."""
    inverse_own: Float[Array, "m n"]
    """One over the change of a row's speed per unit of its own impulse; 0 for rows that nothing
    can move."""

    @property
    def in_use(self) -> InUse:
        """Rows that the worlds use."""
        return self.rows.links.in_use

    def speed(self, index: Int[Array, ""], motion: Motion) -> Float[Array, " n"]:
        """Return the speed of one row in a motion, compliance left aside."""
        return speed_of_row(self.rows, index, motion)

    def point_speeds(
        self, normal: Int[Array, ""], tangent: Int[Array, ""], motion: Motion
    ) -> tuple[Float[Array, " n"], Float[Array, " n"]]:
        """Speeds of two rows that act on the same bodies."""
        reading = _Reading.of(self.rows, normal, motion)
        return reading.along(self.rows, normal), reading.along(self.rows, tangent)

    def moved(self, impulse: Float[Array, "m n"]) -> Motion:
        """Return the motion that impulses make; those of rows not in use must be 0."""

        def add(k: Int[Array, ""], motion: Motion) -> Motion:
            return motion + row(self.of_rows, k)[0] * row(impulse, k)[0]

        return self.in_use.each(add, jnp.zeros(self.of_rows.shape[1:], impulse.dtype))

    def speeds(self, impulse: Float[Array, "m n"]) -> Float[Array, "m n"]:
        """Speeds that impulses give to the rows in use; 0 for the others."""
        return self.speeds_in(self.moved(impulse), impulse)

    def speeds_in(self, motion: Motion, impulse: Float[Array, "m n"]) -> Float[Array, "m n"]:
        """Return the same, where the motion that the impulses make is known."""

        def put_speed(k: Int[Array, ""], found: Float[Array, "m n"]) -> Float[Array, "m n"]:
            return put(found, self.speed(k, motion)[None], k, 0)

        found = self.in_use.each(put_speed, jnp.zeros_like(impulse))
        return found + self.compliance * impulse


def speed_of_row(rows: Rows, index: Int[Array, ""], motion: Motion) -> Float[Array, " n"]:
    """Return the speed of body b relative to body a along one row."""
    return _Reading.of(rows, index, motion).along(rows, index)


@pytree
class _Reading:
    """Motion of the two bodies of a row."""

    apart_x: Float[Array, " n"]
    apart_y: Float[Array, " n"]
    spin_a: Float[Array, " n"]
    spin_b: Float[Array, " n"]

    @staticmethod
    def of(rows: Rows, index: Int[Array, ""], motion: Motion) -> "_Reading":
        a, b = (row(body, index) - ARENA_BODIES for body in (rows.body_a, rows.body_b))
        if motion.shape[1] > MOST_TERMS:
            ends = jnp.concatenate([a, b], axis=0)
            found = take(jnp.swapaxes(motion, 0, 1), jnp.maximum(ends, 0))
            (of_a, of_b) = jnp.where((ends >= 0)[:, None], found, 0)
            apart = of_b - of_a
            return _Reading(apart_x=apart[0], apart_y=apart[1], spin_a=of_a[2], spin_b=of_b[2])
        bodies = jnp.arange(motion.shape[1])[:, None]
        of_a, of_b = (jnp.sum(jnp.where(bodies == end, motion, 0), axis=1) for end in (a, b))
        apart = of_b - of_a
        return _Reading(apart_x=apart[0], apart_y=apart[1], spin_a=of_a[2], spin_b=of_b[2])

    def along(self, rows: Rows, index: Int[Array, ""]) -> Float[Array, " n"]:
        """Return the speed of b relative to a along a row of these bodies."""
        x, y, turn_a, turn_b = (
            row(values, index)[0]
            for values in (rows.direction.x, rows.direction.y, rows.turn_a, rows.turn_b)
        )
        return x * self.apart_x + y * self.apart_y + turn_b * self.spin_b - turn_a * self.spin_a
