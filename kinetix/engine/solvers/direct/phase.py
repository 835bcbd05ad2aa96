"""The state between substeps, and the end of a step in front of walls.

Worlds are on the last axis.
"""

import dataclasses

from jaxtyping import Array, Bool, Float

from kinetix.engine.collision import Found, share_of_way
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


def before_walls(world: World, state: State, found: Found, end: Phase) -> Phase:
    """The end of a step in which no body's centre has entered a fixed polygon."""
    share = share_of_way(world, state, found.polygons, end.position)
    start = vec(state.position)
    return dataclasses.replace(
        end,
        position=start + (end.position - start) * share,
        rotation=state.rotation + (end.rotation - state.rotation) * share,
    )
