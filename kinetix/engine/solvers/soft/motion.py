"""The bodies while they are being solved: outer forces, movement, and the state in the end.

Worlds are on the last axis.
"""

import dataclasses
from typing import Any

import jax.numpy as jnp
from jaxtyping import Array, Bool, Float

from kinetix.engine import actuators
from kinetix.engine.collision import FEATURES, Found
from kinetix.engine.lookup import marked
from kinetix.engine.maths import Vec, unvec
from kinetix.engine.solvers.soft.levers import SplitMasses
from kinetix.engine.solvers.visit import Twist
from kinetix.engine.types import Control, Parameters, State, World
from kinetix.pytree import pytree


@pytree
class MovingBodies:
    """The bodies while they are being solved."""

    position: Vec
    rotation: Float[Array, "b n"]
    velocity: Twist


@pytree
class Setting:
    """Constants of a whole step."""

    world: World
    control: Control
    parameters: Parameters
    masses: SplitMasses
    h: Float[Array, " n"]
    """Duration of a substep [s]."""


def kicked(setting: Setting, moving: MovingBodies) -> MovingBodies:
    """Velocities after gravity and thrust have acted for a substep."""
    linear, angular = actuators.acceleration(
        setting.world, moving.rotation, setting.control, setting.parameters
    )
    push = Twist(x=linear.x, y=linear.y, turn=angular)
    return dataclasses.replace(moving, velocity=moving.velocity + push * setting.h)


def drifted(moving: MovingBodies, h: Float[Array, " n"]) -> MovingBodies:
    """Poses after a substep at these velocities."""
    velocity = moving.velocity
    return dataclasses.replace(
        moving,
        position=moving.position + Vec(x=velocity.x, y=velocity.y) * h,
        rotation=moving.rotation + velocity.turn * h,
    )


def finish(
    state: State,
    moving: MovingBodies,
    found: Found,
    hit: Bool[Array, "c n"],
    parameters: Parameters,
    cache: Any,
) -> State:
    """Return the new state, clipped; pairs that pushed each other in the step count as touching."""
    bound, speed = parameters.clip_position, parameters.clip_velocity
    spin = parameters.clip_angular_velocity
    pair = jnp.where(hit, found.points.key // FEATURES, -1)
    velocity = jnp.stack([moving.velocity.x, moving.velocity.y], axis=1)
    return dataclasses.replace(
        state,
        position=jnp.clip(unvec(moving.position), -bound, bound),
        rotation=moving.rotation,
        velocity=jnp.clip(velocity, -speed, speed),
        angular_velocity=jnp.clip(moving.velocity.turn, -spin, spin),
        touching=found.touching | marked(pair, found.touching.shape[0]),
        overflow=found.overflow,
        cache=cache,
    )
