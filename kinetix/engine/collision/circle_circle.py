"""Contacts between two circles. Worlds on the last axis."""

import jax.numpy as jnp
from jaxtyping import Array, Float

from kinetix.engine import constants
from kinetix.engine.collision.moving import MovingCircle, round_meeting
from kinetix.engine.collision.points import Approach, Spot
from kinetix.engine.maths import dot, length, nonzero
from kinetix.engine.store import Store


def approach(a: MovingCircle, b: MovingCircle, dt: Float[Array, " n"]) -> Approach:
    """Return the distance of the surfaces; circles have one face."""
    apart, motion = b.centre - a.centre, b.velocity - a.velocity
    gap = length(apart) - a.radius - b.radius
    half = dot(apart, motion)
    coming = half < 0
    time = jnp.clip(-half / nonzero(dot(motion, motion)), 0, dt)
    nearest = length(apart + motion * time) - a.radius - b.radius
    return Approach(
        separation=gap,
        face=jnp.zeros(gap.shape, jnp.int32),
        time=jnp.where(coming | (gap <= 0), 0, dt),
        meets=nearest <= constants.TOUCH_SLOP,
    )


def points(
    a: MovingCircle,
    b: MovingCircle,
    coming: Approach,
    margin: Float[Array, "k n"],
    dt: Float[Array, " n"],
    store: Store,
) -> list[Spot]:
    """Return one point, on the line of the centres at the moment of the impact."""
    del margin, store
    normal, gap = round_meeting(
        b.centre - a.centre, b.velocity - a.velocity, a.radius + b.radius, dt
    )
    return [
        Spot(
            normal=normal,
            arm_a=normal * a.radius,
            arm_b=normal * -b.radius,
            separation=gap,
            feature=jnp.zeros_like(coming.face),
            exists=jnp.ones(gap.shape, bool),
        )
    ]
