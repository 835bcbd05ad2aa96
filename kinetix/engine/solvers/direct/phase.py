"""The state between substeps, and the end of a step in front of walls.

Worlds are on the last axis.
"""

import dataclasses

from jaxtyping import Array, Bool, Float

from kinetix.engine.collision import Found, held_by_walls
from kinetix.engine.maths import Vec, vec
from kinetix.engine.solvers.direct.joint_system import JointSystem
from kinetix.engine.solvers.rows import Velocity
from kinetix.engine.types import State, World
from kinetix.pytree import pytree


@pytree
class Phase:
    """State that a substep passes to the next."""

    position: Vec
    rotation: Float[Array, "b n"]
    velocity: Velocity
    gap: Float[Array, "g n"]
    """Of the contacts, then of the limits."""
    bias_impulse: Float[Array, "m n"]
    relax_impulse: Float[Array, "m n"]
    joints: JointSystem
    joint_impulse: Float[Array, "k n"]
    """Of the last substep, both solves together."""
    hit: Bool[Array, "c n"]
    """True for contacts that have pushed in any substep."""


def before_walls(
    world: World, state: State, found: Found, end: Phase, dt: Float[Array, " n"]
) -> Phase:
    """The end of a step [s] in which no body's centre has entered a fixed polygon."""
    held = held_by_walls(world, state, found.polygons, found.points, end.position, dt)
    start = vec(state.position)
    goes = (held.back.x == 0) & (held.back.y == 0)
    return dataclasses.replace(
        end,
        position=start + (end.position - start) * held.share + held.back,
        rotation=state.rotation + (end.rotation - state.rotation) * held.share,
        velocity=end.velocity * goes.astype(held.share.dtype),
    )
