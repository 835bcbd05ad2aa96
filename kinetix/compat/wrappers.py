"""Wrappers of kinetix-env, for code that derives its own from them.

An environment of 0.x and 1.x has `step_env` (which never resets) and `reset_to_level`; ours has
both. `GymnaxWrapper` passes on what it does not define, `UnderspecifiedEnvWrapper` builds `step`
from the two, and the others decide what follows the end of an episode.
"""

from collections.abc import Callable
from typing import Any

import jax
import jax.numpy as jnp
from jaxtyping import Array

from kinetix.environment.state import EnvState
from kinetix.pytree import pytree


class GymnaxWrapper:
    """Passes everything on to the environment that it is put around."""

    def __init__(self, env: Any) -> None:
        self._env = env

    def __repr__(self) -> str:
        """Name what it is put around."""
        return f"<{type(self).__name__} of {self._env!r}>"

    def __getattr__(self, name: str) -> Any:
        """Everything else is the environment's own."""
        if name.startswith("__") or name == "_env":
            raise AttributeError(name)
        return getattr(self._env, name)


class UnderspecifiedEnvWrapper(GymnaxWrapper):
    """An environment that is given each start; episodes end and stay ended."""

    def step(self, rng: Array, state: Any, action: Any, params: Any = None) -> Any:
        """Play one action; nothing is reset."""
        return self.step_env(rng, state, action, params)

    def step_env(self, rng: Array, state: Any, action: Any, params: Any = None) -> Any:
        """Play one action; nothing is reset."""
        return self._env.step_env(rng, state, action, params)

    def reset_to_level(self, rng: Array, level: EnvState, params: Any = None) -> tuple[Any, Any]:
        """Start an episode in a level: observation and state."""
        return self._env.reset_to_level(rng, level, params)

    def action_space(self, params: Any = None) -> Any:
        """Return the set of actions."""
        return self._env.action_space(params)


@pytree
class AutoReplayState:
    """The state of the environment, and the level that its episodes start in."""

    env_state: Any
    level: Any


def _renewed(done: Array, new: Any, old: Any) -> Any:
    return jax.tree.map(lambda a, b: jnp.where(done, a, b), new, old)


class AutoReplayWrapper(UnderspecifiedEnvWrapper):
    """Starts the same level again where an episode has ended."""

    def reset(
        self, rng: Array, params: Any = None, level: EnvState | None = None
    ) -> tuple[Any, AutoReplayState]:
        """Start an episode, in a level or in one of the environment's, and remember its start."""
        override = () if level is None else (level,)
        obs, env_state = self._env.reset(rng, params, *override)
        return obs, AutoReplayState(env_state=env_state, level=env_state)

    def get_obs(self, state: AutoReplayState) -> Any:
        """Return the observation of a state."""
        return self._env.get_obs(state.env_state)

    def step_env(self, rng: Array, state: AutoReplayState, action: Any, params: Any = None) -> Any:
        """Play one action; where done, observation and state are those of the level's start."""
        reset_key, step_key = jax.random.split(rng)
        obs, env_state, reward, done, info = self._env.step_env(
            step_key, state.env_state, action, params
        )
        first = self._env.reset_to_level(reset_key, state.level, params)
        obs, env_state = _renewed(done, first, (obs, env_state))
        return obs, state.replace(env_state=env_state), reward, done, info  # pyright: ignore[reportAttributeAccessIssue]

    def reset_to_level(
        self, rng: Array, level: EnvState, params: Any = None
    ) -> tuple[Any, AutoReplayState]:
        """Start an episode in a level, and remember the level."""
        obs, env_state = self._env.reset_to_level(rng, level, params)
        return obs, AutoReplayState(env_state=env_state, level=level)


class AutoResetWrapper(UnderspecifiedEnvWrapper):
    """Starts another level where an episode has ended."""

    def __init__(self, env: Any, sample_level: Callable[[Array], EnvState]) -> None:
        """Wrap an environment.

        Args:
            env: The environment.
            sample_level: Draws a level.
        """
        super().__init__(env)
        self.sample_level = sample_level

    def step_env(self, rng: Array, state: Any, action: Any, params: Any = None) -> Any:
        """Play one action; where done, observation and state are those of a new level."""
        reset_key, step_key = jax.random.split(rng)
        obs, env_state, reward, done, info = self._env.step_env(step_key, state, action, params)
        obs, env_state = _renewed(done, self.reset(reset_key, params), (obs, env_state))
        return obs, env_state, reward, done, info

    def reset(self, rng: Array, params: Any = None) -> tuple[Any, Any]:
        """Start an episode in a level of the distribution."""
        level_key, reset_key = jax.random.split(rng)
        return self._env.reset_to_level(reset_key, self.sample_level(level_key), params)


class UnderspecifiedToGymnaxWrapper(GymnaxWrapper):
    """Passes everything on; here an environment has both interfaces already."""


class DenseRewardWrapper(GymnaxWrapper):
    """Passes everything on; here the environment itself gives the dense reward.

    Its weight is `EnvParams.dense_reward_scale`.
    """

    def __init__(self, env: Any, dense_reward_scale: float = 1.0) -> None:
        """Wrap an environment; the weight is that of its parameters."""
        del dense_reward_scale
        super().__init__(env)
