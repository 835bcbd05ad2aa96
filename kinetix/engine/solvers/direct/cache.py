"""The cache between steps: impulses by contact, and the joints' last forces.

Worlds are on the last axis.
"""

import dataclasses

import jax.numpy as jnp
from jaxtyping import Array, Float, Int

from kinetix.engine.collision import Found
from kinetix.engine.maths import Vec, cross, dot, nonzero, unvec
from kinetix.engine.solvers.direct.phase import Phase
from kinetix.engine.solvers.end import clipped, touched
from kinetix.engine.solvers.rows import match
from kinetix.engine.types import Parameters, State
from kinetix.pytree import pytree


@pytree
class DirectCache:
    """Kept for the next step: impulses by contact key, the joints' last forces, what was hard."""

    key: Int[Array, "c n"]
    bias_normal: Float[Array, "c n"]
    bias_tangent: Float[Array, "c n"]
    relax_normal: Float[Array, "c n"]
    relax_tangent: Float[Array, "c n"]
    bias_limit: Float[Array, "j n"]
    relax_limit: Float[Array, "j n"]
    joint_force_x: Float[Array, "j n"]
    joint_force_y: Float[Array, "j n"]
    joint_turn: Float[Array, "j n"]
    """Rate at which a joint's force turned in the last step [rad/s]."""
    contrast: Float[Array, " n"]
    """As the contacts of the last step had it (`ContactSystem.contrast`)."""


def warm_start(cache: DirectCache, found: Found) -> tuple[Float[Array, "m n"], Float[Array, "m n"]]:
    """Last step's impulses of the contacts that are still there, for both solves."""
    normal, tangent, relax_normal, relax_tangent = match(
        found.points.key,
        cache.key,
        cache.bias_normal,
        cache.bias_tangent,
        cache.relax_normal,
        cache.relax_tangent,
    )
    return (
        jnp.concatenate([normal, tangent, cache.bias_limit], axis=0),
        jnp.concatenate([relax_normal, relax_tangent, cache.relax_limit], axis=0),
    )


def finish(
    state: State,
    end: Phase,
    found: Found,
    contrast: Float[Array, " n"],
    h: Float[Array, " n"],
    parameters: Parameters,
) -> State:
    """The new state: clipped, with the impulses kept by their keys."""
    count = found.points.key.shape[0]
    joints = state.cache.joint_force_x.shape[0]
    force = Vec(x=end.joint_impulse[:joints], y=end.joint_impulse[joints : 2 * joints]) * (1 / h)
    last = Vec(x=state.cache.joint_force_x, y=state.cache.joint_force_y)
    state = dataclasses.replace(
        state,
        position=unvec(end.position),
        rotation=end.rotation,
        velocity=unvec(end.velocity.linear),
        angular_velocity=end.velocity.angular,
        cache=DirectCache(
            key=found.points.key,
            bias_normal=end.bias_impulse[:count],
            bias_tangent=end.bias_impulse[count : 2 * count],
            relax_normal=end.relax_impulse[:count],
            relax_tangent=end.relax_impulse[count : 2 * count],
            bias_limit=end.bias_impulse[2 * count :],
            relax_limit=end.relax_impulse[2 * count :],
            joint_force_x=force.x,
            joint_force_y=force.y,
            joint_turn=_turn(last, force) / parameters.dt,
            contrast=contrast,
        ),
    )
    return touched(clipped(state, parameters), found, end.hit)


def _turn(last: Vec, now: Vec) -> Float[Array, "j n"]:
    """Return the angle from one force to the next [rad]; down to 0 where their sizes differ."""
    least = jnp.minimum(dot(last, last), dot(now, now))
    most = jnp.maximum(dot(last, last), dot(now, now))
    # A force that changes by a third does not go on turning as it did.
    steady = jnp.clip(2 * least / nonzero(most) - 1, 0, 1)
    return jnp.arctan2(cross(last, now), dot(last, now)) * steady
