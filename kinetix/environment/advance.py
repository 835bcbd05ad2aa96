"""One action of one world: its physics steps, the reward, and whether the episode ends."""

import dataclasses
from typing import Any

import jax
import jax.numpy as jnp
from jaxtyping import Array, Bool, Float, Int

from kinetix.engine.pipeline import step as physics_step
from kinetix.engine.types import Control, State
from kinetix.environment.goal import dense_reward, goal_distance, sparse_reward
from kinetix.environment.params import (
    EnvParams,
    StaticEnvParams,
    engine_parameters,
    physics_engine,
)
from kinetix.environment.state import NO_DISTANCE, EnvState
from kinetix.pytree import pytree

Advanced = tuple[dict[str, Any], Float[Array, ""], Bool[Array, ""], dict[str, Any]]
"""The changed fields of the state, reward, done and info."""


@pytree
class _Played:
    """State of an environment step after some of its physics steps."""

    physics: State
    reward: Float[Array, ""]
    """Sparse reward of the first physics step that had one."""
    scored_position: Float[Array, "b 2"]
    """Positions after that step, or after the last one so far."""
    overflow: Bool[Array, ""]


def advance(
    state: EnvState, control: Control, params: EnvParams, *, static: StaticEnvParams
) -> Advanced:
    """Play the physics steps of one action and score them.

    The level itself is not returned, so that its arrays stay where they are.

    Args:
        state: Of one world.
        control: What motors and thrusters do in all of these steps.
        params: Time limit, scale of the dense reward, numbers of the engine.
        static: Sizes, physics, physics steps of an action, and which touches count.
    """
    played = _play(state, control, params, static)
    world, labels = state.world, state.labels
    distance = goal_distance(played.scored_position, world, labels)
    touched = played.reward != 0
    # A solver that clamps impulses swallows a motor's NaN, which would then count as no action.
    nan = has_nan((played.physics, control)) | jnp.isnan(world.gravity).any()
    timestep = state.timestep + 1
    done = touched | nan | (timestep >= time_limit(labels.max_timesteps, params))
    reward = played.reward + dense_reward(distance, state.last_distance, params.dense_reward_scale)
    changed = {
        "physics": played.physics,
        "timestep": timestep,
        "last_distance": jnp.where(done, NO_DISTANCE, distance),
    }
    info = {
        "GoalR": played.reward > 0,
        "distance": distance,
        "terminated": touched,
        "truncated": done & ~touched & ~nan,
        "nan": nan,
        "overflow": played.overflow,
    }
    return changed, reward, done, info


def _play(state: EnvState, control: Control, params: EnvParams, static: StaticEnvParams) -> _Played:
    """Play all physics steps of one action; what counts is the first one with a touch."""
    engine = physics_engine(static)
    parameters = engine_parameters(params)
    world = state.world

    def substep(played: _Played, _: None) -> tuple[_Played, None]:
        physics = physics_step(
            world, played.physics, control, parameters, spec=engine.spec, solver=engine.solver
        )
        reward = sparse_reward(
            physics.touching, world, state.labels, includes_joined=static.touch_includes_joined
        )
        ended = played.reward != 0
        # A state keeps what ended it, even if the shapes have parted since.
        touching = jnp.where(ended, played.physics.touching, physics.touching)
        return _Played(
            physics=dataclasses.replace(physics, touching=touching),
            reward=jnp.where(ended, played.reward, reward),
            scored_position=jnp.where(ended, played.scored_position, physics.position),
            overflow=played.overflow | physics.overflow,
        ), None

    played = _Played(
        physics=state.physics,
        reward=jnp.zeros((), jnp.float32),
        scored_position=state.physics.position,
        overflow=jnp.zeros((), bool),
    )
    if static.frame_skip == 1:
        return substep(played, None)[0]
    return jax.lax.scan(substep, played, length=static.frame_skip)[0]


def has_nan(tree: State | tuple[State, Control]) -> Bool[Array, ""]:
    """Return whether any number that a step changes, or is driven by, is NaN."""
    reals = [x for x in jax.tree.leaves(tree) if jnp.issubdtype(x.dtype, jnp.floating)]
    return jnp.any(jnp.stack([jnp.isnan(x).any() for x in reals]))


def time_limit(own: Int[Array, ""], params: EnvParams) -> Int[Array, ""]:
    """A level's own limit, else that of the parameters; none at all where theirs is infinite."""
    given = jnp.asarray(params.max_timesteps)
    endless = jnp.isinf(given.astype(jnp.float32))
    never = jnp.iinfo(jnp.int32).max
    given = jnp.where(endless, never, given.astype(jnp.int32))
    return jnp.where((own > 0) & ~endless, own, given)
