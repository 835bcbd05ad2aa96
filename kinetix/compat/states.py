"""kinetix-env's small functions of states and actions."""

import dataclasses
from typing import Any

import jax.numpy as jnp
from jaxtyping import Array, Bool, Float, Int

from kinetix.engine.spec import ARENA_BODIES
from kinetix.environment.actions import (
    AbstractAction,
    ContinuousActions,
    DiscreteActions,
    MultiDiscreteActions,
)
from kinetix.environment.params import EnvParams, StaticEnvParams
from kinetix.environment.reset import level_state
from kinetix.environment.state import EnvState
from kinetix.level.model import Level
from kinetix.pytree import on_device


def create_empty_env(static_env_params: StaticEnvParams) -> EnvState:
    """Return the level with nothing but the arena, in arrays of JAX (`.at[…].set(…)`)."""
    return on_device(level_state(Level(name="empty"), static_env_params))


def index_motor_actions(
    action: Float[Array, " u"],
    state: EnvState,
    clip_min: float | None = None,
    clip_max: float | None = None,
) -> Float[Array, " j"]:
    """Return each joint's entry of a vector with one entry per motor binding."""
    return jnp.clip(action, clip_min, clip_max)[state.labels.motor_binding]


def index_thruster_actions(
    action: Float[Array, " u"],
    state: EnvState,
    clip_min: float | None = None,
    clip_max: float | None = None,
) -> Float[Array, " t"]:
    """Return each thruster's entry of a vector with one entry per thruster binding."""
    return jnp.clip(action, clip_min, clip_max)[state.labels.thruster_binding]


def _engine_vector(
    kind: type[AbstractAction], action: Any, state: EnvState, static: StaticEnvParams
) -> Float[Array, " jt"]:
    actions = kind(
        motor_bindings=static.num_motor_bindings, thruster_bindings=static.num_thruster_bindings
    )
    return actions.process_action(action, state)


def convert_continuous_actions(
    action: Any, state: EnvState, static_env_params: StaticEnvParams, env_params: EnvParams
) -> Float[Array, " jt"]:
    """Return one number per joint (−1 … 1), then one per thruster (0 … 1)."""
    del env_params
    return _engine_vector(ContinuousActions, action, state, static_env_params)


def convert_discrete_actions(
    action: Any, state: EnvState, static_env_params: StaticEnvParams, env_params: EnvParams
) -> Float[Array, " jt"]:
    """Return one number per joint (−1 … 1), then one per thruster (0 … 1)."""
    del env_params
    return _engine_vector(DiscreteActions, action, state, static_env_params)


def convert_multi_discrete_actions(
    action: Any, state: EnvState, static_env_params: StaticEnvParams, env_params: EnvParams
) -> Float[Array, " jt"]:
    """Return one number per joint (−1 … 1), then one per thruster (0 … 1)."""
    del env_params
    return _engine_vector(MultiDiscreteActions, action, state, static_env_params)


def make_velocities_zero(state: EnvState) -> EnvState:
    """Return the state with every body at rest."""
    physics = state.physics
    return dataclasses.replace(
        state,
        physics=dataclasses.replace(
            physics,
            velocity=jnp.zeros_like(physics.velocity),
            angular_velocity=jnp.zeros_like(physics.angular_velocity),
        ),
    )


def is_space_for_shape(state: EnvState) -> Bool[Array, ""]:
    """Return whether a slot for a body is free."""
    return ~jnp.all(state.world.bodies.active)


def is_space_for_joint(state: EnvState) -> Bool[Array, ""]:
    """Return whether a slot for a joint is free."""
    return ~jnp.all(state.world.joints.active)


def are_there_shapes_present(
    state: EnvState, static_env_params: StaticEnvParams
) -> Bool[Array, ""]:
    """Return whether there is any body besides the arena's."""
    del static_env_params
    return jnp.any(state.world.bodies.active[ARENA_BODIES:])


def count_roles(
    state: EnvState,
    static_env_params: StaticEnvParams,
    role: int,
    include_static_polys: bool = True,
) -> Int[Array, ""]:
    """Return how many active bodies have a role (0 none, 1 green, 2 blue, 3 red)."""
    del static_env_params
    first = 0 if include_static_polys else ARENA_BODIES
    has = state.world.bodies.active & (state.labels.role == role)
    return jnp.sum(has[first:], dtype=jnp.int32)


def rectangle_vertices(half_dim: Float[Array, "2"]) -> Float[Array, "4 2"]:
    """Return the corners of a rectangle about its centre, clockwise from the upper right [m].

    Args:
        half_dim: Half the width and half the height [m].
    """
    return jnp.array([(1.0, 1.0), (1.0, -1.0), (-1.0, -1.0), (-1.0, 1.0)]) * jnp.asarray(half_dim)
