"""An environment of many worlds, spread over all devices: `vectorize` in place of `vmap`."""

import dataclasses
from collections.abc import Callable, Mapping
from typing import Any

import jax
import jax.numpy as jnp
from jaxtyping import Array

from kinetix.environment.checks import check_env, check_values, check_worlds
from kinetix.environment.devices import in_shares
from kinetix.environment.eager import thorough
from kinetix.environment.env import KinetixEnv
from kinetix.environment.kinetix_env.methods import ResetsByName
from kinetix.environment.state import EnvState
from kinetix.environment.wrappers import without_logs
from kinetix.errors import KinetixError


@dataclasses.dataclass(frozen=True, kw_only=True)
class VectorEnv(ResetsByName):
    """Many worlds at once: every argument and result has a leading axis of worlds.

    Each device steps its share. Results are the same as those of `vmap` up to rounding. All of it
    works under `jit` and `scan`; what is computed from the results world by world is computed where
    they are.
    """

    env: Any
    """For one world."""

    def __getattr__(self, name: str) -> Any:
        """Spaces, parameters and names are those of the environment for one world."""
        if name.startswith("__") or name == "env":
            raise AttributeError(name)
        return getattr(self.env, name)

    def check_values(self, arguments: tuple[Any, ...], named: Mapping[str, Any]) -> None:
        """Refuse values that a compiled step cannot see; each call from Python begins with it.

        Args:
            arguments: Positional arguments of `step`, `reset` or `get_obs`.
            named: Keyword arguments of it.

        Raises:
            KinetixError: A parameter or a choice of an action is out of its range, or a level to
                start in has something that the step leaves out. Actions that are still computed or
                lie on a GPU or TPU, and those of a wrapper of one's own, are not looked at.
        """
        env = without_logs(self.env)
        actions = env.actions if isinstance(env, KinetixEnv) else None
        check_values(env, actions, arguments, named, batch=True)

    @thorough
    def reset(
        self, key: Array, env_params: Any = None, override_reset_state: EnvState | None = None
    ) -> Any:
        """Start an episode in every world.

        Args:
            key: A key a world.
            env_params: Parameters of all worlds; by default those of the environment.
            override_reset_state: The states to start in, instead of those from `reset_fn`: one a
                world, or one for all.

        Returns:
            Observations and states.

        Raises:
            KinetixError: An argument is not one per world, or the number of worlds is not a
                multiple of the number of devices.
        """
        axes = (0, None, _axis(override_reset_state))
        batch = {"key": key, "env_params": env_params, "override_reset_state": override_reset_state}
        return _spread(self.env.reset, axes, batch)

    @thorough
    def step(
        self,
        key: Array,
        state: Any,
        action: Any,
        env_params: Any = None,
        override_reset_state: EnvState | None = None,
    ) -> Any:
        """Play an action in every world.

        Args:
            key: A key a world.
            state: From `reset` or `step`.
            action: An action a world.
            env_params: Parameters of all worlds; by default those of the environment.
            override_reset_state: Where the next episodes start, instead of `reset_fn`: one a world,
                or one for all.

        Returns:
            Observations, states, rewards, dones and info.

        Raises:
            KinetixError: An argument is not one per world, or the number of worlds is not a
                multiple of the number of devices.
        """
        axes = (0, 0, 0, None, _axis(override_reset_state))
        batch = {
            "key": key,
            "state": state,
            "action": action,
            "env_params": env_params,
            "override_reset_state": override_reset_state,
        }
        return _spread(self.env.step, axes, batch)

    @thorough
    def step_env(self, key: Array, state: Any, action: Any, params: Any = None) -> Any:
        """Play an action in every world; where an episode ends it stays ended. See `step`."""
        batch = {"key": key, "state": state, "action": action, "params": params}
        return _spread(self.env.step_env, (0, 0, 0, None), batch)

    @thorough
    def get_obs(self, state: Any) -> Any:
        """Observe every world."""
        return _spread(self.env.get_obs, (0,), {"state": state})


def vectorize(env: Any) -> VectorEnv:
    """Make an environment of many worlds that works on all devices.

    Call `kinetix.use_all_cores()` before the first array, so that a processor's cores are devices.

    Args:
        env: An environment for one world, or a wrapper around one; a vectorised one stays as it is.

    Raises:
        KinetixError: `env` is not an environment, or wraps a vectorised one.
    """
    check_env(env)
    if isinstance(env, VectorEnv):
        return env
    if isinstance(without_logs(env), VectorEnv):
        raise KinetixError("env: it steps many worlds already, so vectorize has nothing to do")
    return VectorEnv(env=env)


def _axis(levels: EnvState | None) -> int | None:
    """Return the axis of worlds of some levels; one level for all has none."""
    return None if levels is None or jnp.ndim(levels.timestep) == 0 else 0


def _spread(
    function: Callable[..., Any], axes: tuple[int | None, ...], arguments: Mapping[str, Any]
) -> Any:
    mapped = {
        name: arguments[name] for name, axis in zip(arguments, axes, strict=True) if axis == 0
    }
    check_worlds(mapped, jax.device_count())
    replicated = tuple(index for index, axis in enumerate(axes) if axis is None)
    shares = in_shares(jax.vmap(function, in_axes=axes), replicated=replicated)
    return shares(*arguments.values())
