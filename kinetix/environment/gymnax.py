"""The environment in the form of gymnax 1.x: six values a step, gymnax's own spaces.

gymnax is not needed by the rest of the project; it is imported when the adapter is made.
"""

import dataclasses
import importlib
from typing import Any

import jax.numpy as jnp
from jaxtyping import Array, Bool, Float

from kinetix.environment import spaces
from kinetix.environment.env import KinetixEnv
from kinetix.environment.params import EnvParams
from kinetix.environment.state import EnvState
from kinetix.errors import KinetixError

GymnaxStep = tuple[
    Any, EnvState, Float[Array, ""], Bool[Array, ""], Bool[Array, ""], dict[str, Any]
]
"""Observation, state, reward, terminated, truncated, info."""


class GymnaxAdapter:
    """A `KinetixEnv` with the interface of gymnax 1.x.

    A NaN counts as terminated. Where an episode ends, state and observation are those of the next
    one, and `info["final_observation"]` is the last one of the old.
    """

    def __init__(self, env: KinetixEnv) -> None:
        """Wrap an environment.

        Raises:
            KinetixError: gymnax is not installed.
        """
        self._env = dataclasses.replace(env, keep_terminal_observation=True)
        self._spaces = gymnax_spaces()

    @property
    def name(self) -> str:
        """The environment's name."""
        return self._env.name

    @property
    def num_actions(self) -> int:
        """Logits of a discrete policy, or the length of a continuous action."""
        return self._env.num_actions

    @property
    def default_params(self) -> EnvParams:
        """The parameters that the environment was made with."""
        return self._env.default_params

    def reset(self, key: Array, params: EnvParams | None = None) -> tuple[Any, EnvState]:
        """Start an episode: observation and state."""
        return self._env.reset(key, params)

    def step(
        self, key: Array, state: EnvState, action: Any, params: EnvParams | None = None
    ) -> GymnaxStep:
        """Play one action."""
        observation, state, reward, done, info = self._env.step(key, state, action, params)
        truncated = info["truncated"]
        terminated = done & ~truncated
        final = info.pop("terminal_observation")
        info |= {"terminated": terminated, "final_observation": final}
        return observation, state, reward, terminated, truncated, info

    def action_space(self, params: EnvParams | None = None) -> Any:
        """The set of actions as one of gymnax's spaces."""
        return _converted(self._env.action_space(params), self._spaces)

    def observation_space(self, params: EnvParams | None = None) -> Any:
        """What `reset` and `step` observe, as one of gymnax's spaces."""
        return _converted(self._env.observation_space(params), self._spaces)


def gymnax_spaces() -> Any:
    """The module of spaces of gymnax.

    Raises:
        KinetixError: gymnax is not installed.
    """
    try:
        return importlib.import_module("gymnax.environments.spaces")
    except ImportError:
        raise KinetixError("gymnax is not installed: pip install gymnax") from None


def _converted(space: Any, theirs: Any) -> Any:
    if isinstance(space, spaces.Discrete):
        return theirs.Discrete(space.n)
    if isinstance(space, spaces.Dict):
        return theirs.Dict({name: _converted(part, theirs) for name, part in space.spaces.items()})
    if isinstance(space, spaces.Box):
        return theirs.Box(_bound(space.low), _bound(space.high), space.shape, space.dtype)
    if isinstance(space, spaces.MultiDiscrete):
        highest = jnp.array(space.number_of_dims_per_distribution) - 1
        return theirs.Box(jnp.zeros_like(highest), highest, space.shape, space.dtype)
    return theirs.Box(0, 1, space.shape, space.dtype)


def _bound(bound: float | tuple[float, ...]) -> Any:
    return jnp.array(bound) if isinstance(bound, tuple) else bound
