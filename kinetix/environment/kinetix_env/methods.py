"""Methods by gymnax's and kinetix-env's names, which every environment has besides its own."""

import dataclasses
from typing import Any, Final

import jax.numpy as jnp
import numpy as np
from jax.core import Tracer
from jaxtyping import Array, Bool, Float

from kinetix.engine.pipeline import step as physics_step
from kinetix.engine.types import Control
from kinetix.environment.checks import check_one_state, check_state
from kinetix.environment.goal import goal_distance, sparse_reward
from kinetix.environment.params import EnvParams, StaticEnvParams, engine_parameters
from kinetix.environment.state import EnvState
from kinetix.errors import KinetixError
from kinetix.render.pixels import make_render_pixels

REPLACEABLE = frozenset({"reset", "step", "render"})
"""Methods that wrappers of others replace on one environment, by assignment."""

_PIXELS: Final = "kinetix.make_render_pixels(env.env_params, env.static_env_params)"
"""Batched call, and the one within `jax.jit`, for error messages."""


class ResetsByName:
    """Starts of episodes by others' names, in terms of `reset`, of one world or of many."""

    def reset_env(self, key: Array, params: EnvParams | None = None) -> tuple[Any, Any]:
        """Start an episode. See `reset`."""
        this: Any = self
        return this.reset(key, params)

    def reset_to_level(
        self, key: Array, level: EnvState, params: EnvParams | None = None
    ) -> tuple[Any, Any]:
        """Start an episode in a level. See `reset`."""
        this: Any = self
        return this.reset(key, params, level)


class MethodsOfKinetixEnv(ResetsByName):
    """Methods that code written for gymnax or kinetix-env calls, in terms of `reset` and `step`."""

    env_params: Any
    static_env_params: Any
    auto_reset: bool

    @property
    def default_static_params(self) -> StaticEnvParams:
        """The static parameters that the environment was made with."""
        return self.static_env_params

    def step_env(
        self, key: Array, state: EnvState, action: Any, params: EnvParams | None = None
    ) -> Any:
        """Play one action; where the episode ends it stays ended. See `step`."""
        alone: Any = dataclasses.replace(self, auto_reset=False)  # pyright: ignore[reportArgumentType]
        return alone.step(key, state, action, params)

    def engine_step(
        self, env_state: EnvState, action_to_perform: Array, env_params: EnvParams | None = None
    ) -> EnvState:
        """Return the state after one physics step.

        Args:
            env_state: The state.
            action_to_perform: One number per joint (−1 … 1), then one per thruster (0 … 1).
            env_params: Parameters; by default those of the environment.

        Raises:
            KinetixError: `env_state` is not a state, is a batch of them, or is of another
                environment.
        """
        engine = self.physics_engine  # pyright: ignore[reportAttributeAccessIssue]
        check_state(env_state, engine, "jax.vmap(env.engine_step)")
        joints = env_state.world.joints.active.shape[0]
        control = Control(motor=action_to_perform[:joints], thruster=action_to_perform[joints:])
        parameters = engine_parameters(self.env_params if env_params is None else env_params)
        physics = physics_step(
            env_state.world,
            env_state.physics,
            control,
            parameters,
            spec=engine.spec,
            solver=engine.solver,
        )
        return dataclasses.replace(env_state, physics=physics)

    def compute_reward_info(
        self, env_state: EnvState, *_: Any
    ) -> tuple[Float[Array, ""], dict[str, Float[Array, ""] | Bool[Array, ""]]]:
        """Return the sparse reward of what touches in a state, and `GoalR` and `distance`.

        Raises:
            KinetixError: `env_state` is not a state, or is a batch of them.
        """
        check_one_state(env_state, "jax.vmap(env.compute_reward_info)")
        world, labels, physics = env_state.world, env_state.labels, env_state.physics
        reward = sparse_reward(
            physics.touching,
            world,
            labels,
            includes_joined=self.static_env_params.touch_includes_joined,
        )
        distance = goal_distance(physics.position, world, labels)
        return reward, {"GoalR": reward > 0, "distance": distance}

    def render(self, state: EnvState, params: EnvParams | None = None) -> np.ndarray:
        """Return the picture of a state: (height, width, 3), 0 … 255, the first row on top.

        Raises:
            KinetixError: `state` is not a state, is a batch of them, or has no values, within
                `jax.jit`.
        """
        check_one_state(state, f"jax.vmap({_PIXELS})", "the order is render(state, env_params)")
        if isinstance(state.physics.position, Tracer):
            raise KinetixError(
                f"state: it has no values within jax.jit or vmap: use {_PIXELS} there"
            )
        params = self.env_params if params is None else params
        pixels = make_render_pixels(params, self.static_env_params)(state)  # pyright: ignore[reportArgumentType]
        # A copy: others write captions into it, and torch takes no negative strides.
        return np.array(np.asarray(pixels.astype(jnp.uint8)).transpose(1, 0, 2)[::-1], order="C")


def set_method(env: Any, name: str, value: Any) -> None:
    """Replace a method of one environment; everything else about it stays as it was made.

    Raises:
        FrozenInstanceError: The name is not one of `REPLACEABLE`.
    """
    if name not in REPLACEABLE:
        raise dataclasses.FrozenInstanceError(
            f"cannot assign to {name!r}: use dataclasses.replace(env, {name}=…)"
        )
    object.__setattr__(env, name, value)
