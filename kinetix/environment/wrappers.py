"""Wrappers around the environment, one concern each."""

from typing import Any

import jax.numpy as jnp
from jaxtyping import Array, Bool, Float, Int

from kinetix.environment.checks import check_env
from kinetix.environment.env import KinetixEnv
from kinetix.environment.params import EnvParams
from kinetix.environment.state import EnvState
from kinetix.lazy import lazy_names
from kinetix.pytree import pytree


@pytree
class LogState:
    """The environment's state, and how the episodes go."""

    env_state: EnvState
    episode_returns: Float[Array, ""]
    """Reward so far."""
    episode_lengths: Int[Array, ""]
    """Environment steps so far."""
    returned_episode_returns: Float[Array, ""]
    """Reward of the last episode that ended."""
    returned_episode_lengths: Int[Array, ""]
    """Steps of the last episode that ended."""
    timestep: Int[Array, ""]
    """Environment steps of all episodes."""


def _given(override: EnvState | LogState | None) -> tuple[Any, ...]:
    """The override as a last argument; none, as other people's environments know no such thing."""
    while isinstance(override, LogState):
        override = override.env_state
    return () if override is None else (override,)


class LogWrapper:
    """Counts returns, lengths and solved episodes, and reports them in `info`.

    It may be put around an environment, or around a vectorised one.
    """

    def __init__(self, env: Any) -> None:
        check_env(env)
        self._env: KinetixEnv = env

    def __repr__(self) -> str:
        """Name what it is put around."""
        return f"<{type(self).__name__} of {self._env!r}>"

    def __getattr__(self, name: str) -> Any:
        """Everything else is the environment's own."""
        if name.startswith("__") or name == "_env":
            raise AttributeError(name)
        return getattr(self._env, name)

    def reset(
        self,
        key: Array,
        env_params: EnvParams | None = None,
        override_reset_state: EnvState | LogState | None = None,
    ) -> tuple[Any, LogState]:
        """Start an episode, and counting; a state of this wrapper may be the override too."""
        override = _given(override_reset_state)
        return self._counting(*self._env.reset(key, env_params, *override))

    def reset_env(self, key: Array, params: EnvParams | None = None) -> tuple[Any, LogState]:
        """Start an episode, and counting. See `reset`."""
        return self.reset(key, params)

    def reset_to_level(
        self, key: Array, level: EnvState | LogState, env_params: EnvParams | None = None
    ) -> tuple[Any, LogState]:
        """Start an episode in a level or a state of this wrapper, and counting."""
        return self._counting(*self._env.reset_to_level(key, _given(level)[0], env_params))

    def get_obs(self, state: EnvState | LogState) -> Any:
        """Return the observation of a state, of this wrapper or of the environment."""
        return self._env.get_obs(*_given(state))

    def _counting(self, observation: Any, env_state: Any) -> tuple[Any, LogState]:
        worlds = jnp.shape(getattr(env_state, "timestep", 0))  # of a vectorised environment
        count, reward = jnp.zeros(worlds, jnp.int32), jnp.zeros(worlds)
        state = LogState(
            env_state=env_state,
            episode_returns=reward,
            episode_lengths=count,
            returned_episode_returns=reward,
            returned_episode_lengths=count,
            timestep=count,
        )
        return observation, state

    def step(
        self,
        key: Array,
        state: LogState,
        action: Any,
        env_params: EnvParams | None = None,
        override_reset_state: EnvState | LogState | None = None,
    ) -> tuple[Any, LogState, Float[Array, ""], Bool[Array, ""], dict[str, Any]]:
        """Step, and report episodes that ended.

        Returns:
            As the environment's `step`; `info` gains `returned_episode_returns`,
            `returned_episode_lengths`, `returned_episode_solved`, `timestep` and
            `returned_episode` (whether an episode ended in this step).
        """
        override = _given(override_reset_state)
        return self._logged(
            state, self._env.step(key, state.env_state, action, env_params, *override)
        )

    def step_env(
        self, key: Array, state: LogState, action: Any, env_params: EnvParams | None = None
    ) -> tuple[Any, LogState, Float[Array, ""], Bool[Array, ""], dict[str, Any]]:
        """Step, and report; where the episode ends it stays ended."""
        return self._logged(state, self._env.step_env(key, state.env_state, action, env_params))

    def _logged(
        self, state: LogState, stepped: tuple[Any, ...]
    ) -> tuple[Any, LogState, Float[Array, ""], Bool[Array, ""], dict[str, Any]]:
        observation, env_state, reward, done, info = stepped
        returns, lengths = state.episode_returns + reward, state.episode_lengths + 1
        logged = LogState(
            env_state=env_state,
            episode_returns=jnp.where(done, 0.0, returns),
            episode_lengths=jnp.where(done, 0, lengths),
            returned_episode_returns=jnp.where(done, returns, state.returned_episode_returns),
            returned_episode_lengths=jnp.where(done, lengths, state.returned_episode_lengths),
            timestep=state.timestep + 1,
        )
        report = {
            "returned_episode_returns": logged.returned_episode_returns,
            "returned_episode_lengths": logged.returned_episode_lengths,
            "returned_episode_solved": info["GoalR"],
            "timestep": logged.timestep,
            "returned_episode": done,
        }
        return observation, logged, reward, done, info | report


def without_logs(env: Any) -> Any:
    """Return the environment that `LogWrapper` is put around; any other as it is."""
    while type(env) is LogWrapper:
        env = env._env
    return env


__getattr__ = lazy_names(__name__)[0]
