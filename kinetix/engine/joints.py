"""Facts about joints that all solvers need. Worlds on the last axis."""

import jax.numpy as jnp
from jaxtyping import Array, Bool, Float

from kinetix.engine.lookup import take_pair
from kinetix.engine.types import World


def joint_acts(world: World) -> Bool[Array, "j n"]:
    """Mark the joints that hold: between two different active bodies that are not both fixed."""
    joints, bodies = world.joints, world.bodies
    (active_a, mass_a), (active_b, mass_b) = take_pair(
        (bodies.active, bodies.inverse_mass), joints.body_a, joints.body_b
    )
    movable = mass_a + mass_b > 0
    return joints.active & movable & active_a & active_b & (joints.body_a != joints.body_b)


def next_limit(
    world: World, angle: Float[Array, "j n"], turn: Float[Array, "j n"]
) -> tuple[Float[Array, "j n"], Float[Array, "j n"]]:
    """Return the limit that a joint would pass, else the nearer one, and the angle left to it.

    Args:
        world: The worlds.
        angle: Of the joints, from their reference angle [rad].
        turn: By how much they turn until limits are chosen again [rad].

    Returns:
        +1 for the lower limit, −1 for the upper one; and the angle left to it [rad].
    """
    joints = world.joints
    least = jnp.minimum(joints.limit_min, joints.limit_max)
    most = jnp.maximum(joints.limit_min, joints.limit_max)
    from_least, from_most = angle - least, most - angle
    upper = (from_most < turn) | ((from_most <= from_least) & (from_least >= -turn))
    side = jnp.where(upper, -1.0, 1.0).astype(angle.dtype)
    return side, jnp.where(upper, from_most, from_least)
