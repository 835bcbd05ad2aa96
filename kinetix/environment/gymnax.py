"""The environment in the form of gymnax 1.x: six values a step, gymnax's own spaces.

gymnax is not needed by the rest of the project; it is imported when the adapter is made.
"""

import dataclasses
import functools
import importlib
from typing import Any

import jax.numpy as jnp
from jaxtyping import Array, Bool, Float

from kinetix.environment.advance import has_nan, time_limit
from kinetix.environment.checks import check_env
from kinetix.environment.env import KinetixEnv
from kinetix.environment.named import NAMED, make_named_env
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
            KinetixError: gymnax is not installed, or the argument is no environment.
        """
        check_env(env)
        gymnax_spaces()
        self._env = dataclasses.replace(env, keep_terminal_observation=True)

    def __getattr__(self, name: str) -> Any:
        """Everything else is the environment's own; its spaces are gymnax's as well."""
        if name.startswith("__") or name == "_env":
            raise AttributeError(name)
        return getattr(self._env, name)

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

    def step_env(
        self, key: Array, state: EnvState, action: Any, params: EnvParams | None = None
    ) -> tuple[Any, EnvState, Float[Array, ""], Bool[Array, ""], dict[str, Any]]:
        """Play one action; where the episode ends it stays ended.

        Returns:
            Observation, state, reward, terminated and info; a time limit is no termination, see
            `is_truncated`.
        """
        observation, state, reward, done, info = self._env.step_env(key, state, action, params)
        del info["terminal_observation"]
        terminated = done & ~info["truncated"]
        return observation, state, reward, terminated, info | {"terminated": terminated}

    def is_terminated(self, state: EnvState, params: EnvParams | None = None) -> Bool[Array, ""]:
        """Return whether a state is won, lost or broken (NaN)."""
        del params
        reward, _ = self._env.compute_reward_info(state)
        return (reward != 0) | has_nan(state.physics)

    is_terminal = is_terminated

    def is_truncated(self, state: EnvState, params: EnvParams | None = None) -> Bool[Array, ""]:
        """Return whether a state's episode has lasted as long as it may, and is neither."""
        params = self._env.env_params if params is None else params
        limit = time_limit(state.labels.max_timesteps, params)
        return (state.timestep >= limit) & ~self.is_terminated(state)

    def discount(self, state: EnvState, params: EnvParams | None = None) -> Float[Array, ""]:
        """Return 0 for what is terminated, else 1."""
        return jnp.where(self.is_terminated(state, params), 0.0, 1.0)


def gymnax_spaces() -> Any:
    """The module of spaces of gymnax; once it is imported, ours are instances of its classes.

    Raises:
        KinetixError: gymnax is not installed.
    """
    try:
        return importlib.import_module("gymnax.environments.spaces")
    except ImportError as error:
        if not (error.name or "gymnax").startswith("gymnax"):
            raise KinetixError(f"gymnax cannot be imported: {error}") from error
        raise KinetixError("gymnax is not installed: pip install gymnax") from None


def register() -> None:
    """Make environments known to `gymnax.make` (1.x): `Kinetix-s-random-v0`, `Kinetix-level-v0`.

    `gymnax.make("Kinetix-level-v0", level="s/goalkeeper")` plays one level; every other keyword of
    `kinetix.environment.named.make_named_env` is accepted too.

    Raises:
        KinetixError: gymnax is not installed, or has no registry (0.0.9).
    """
    gymnax_spaces()
    registry = importlib.import_module("gymnax.registration")
    if not hasattr(registry, "register"):
        raise KinetixError(
            "this gymnax has no registry: install gymnax 1.x, or use kinetix.make_kinetix_env"
        )
    for name, level in NAMED.items():
        if name not in registry.registered_envs:
            registry.register(name, functools.partial(_make, level=level))


def _make(**options: Any) -> GymnaxAdapter:
    return GymnaxAdapter(make_named_env(**options))
