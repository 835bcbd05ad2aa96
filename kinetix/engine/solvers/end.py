"""The end of a step: what all solvers do with the state that they have found.

Worlds are on the last axis.
"""

import dataclasses

import jax.numpy as jnp
from jaxtyping import Array, Bool

from kinetix.engine.collision import FEATURES, Found
from kinetix.engine.lookup import marked
from kinetix.engine.types import Parameters, State


def clipped(state: State, parameters: Parameters) -> State:
    """Return the state with its positions and velocities within the bounds of the parameters."""
    bound, speed = parameters.clip_position, parameters.clip_velocity
    spin = parameters.clip_angular_velocity
    return dataclasses.replace(
        state,
        position=jnp.clip(state.position, -bound, bound),
        velocity=jnp.clip(state.velocity, -speed, speed),
        angular_velocity=jnp.clip(state.angular_velocity, -spin, spin),
    )


def touched(state: State, found: Found, hit: Bool[Array, "c n"]) -> State:
    """Return the state with the touching pairs: those found so, and those that were pushed.

    Args:
        state: At the end of the step.
        found: Contacts of the step.
        hit: Contacts that had an impulse in it.
    """
    pair = jnp.where(hit, found.points.key // FEATURES, -1)
    touching = found.touching | marked(pair, found.touching.shape[0])
    return dataclasses.replace(state, touching=touching, overflow=found.overflow)
