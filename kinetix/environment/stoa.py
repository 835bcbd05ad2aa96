"""The environment in the form of Stoa, the interface of Stoix: time steps that know truncation.

Stoa is not needed by the rest of the project; it is imported when the adapter is made.
"""

import dataclasses
import importlib
from typing import Any

import jax
import jax.numpy as jnp
from jaxtyping import Array

from kinetix.environment import spaces
from kinetix.environment.env import KinetixEnv
from kinetix.environment.params import EnvParams
from kinetix.environment.state import EnvState
from kinetix.errors import KinetixError

METRICS = ("solve_rate", "distance")
"""Keys of `extras` in every time step: 1 where it won the episode, and how far green is from blue
[m]."""


def as_stoa_env(env: KinetixEnv) -> Any:
    """Return the environment as an instance of Stoa's `Environment`.

    Episodes end and stay ended: put Stoa's `AutoResetWrapper` around it. An episode that the time
    limit cut is truncated, so that its last value counts. `reset` takes parameters or, in their
    place, the level to start in.

    Args:
        env: The environment; whether it resets by itself does not matter.

    Raises:
        KinetixError: Stoa is not installed.
    """
    try:
        base: Any = importlib.import_module("stoa.environment").Environment
    except ImportError:
        raise KinetixError("stoa is not installed: pip install stoa-env") from None
    types: Any = importlib.import_module("stoa.env_types")
    keyed: Any = importlib.import_module("stoa.env_adapters.base").AdapterStateWithKey
    alone = dataclasses.replace(env, auto_reset=False)

    class KinetixStoa(base):
        """Plays one level per episode."""

        def reset(
            self, rng_key: Array, env_params: EnvParams | EnvState | None = None
        ) -> tuple[Any, Any]:
            reset_key, state_key = jax.random.split(rng_key)
            observation, state = alone.reset(reset_key, env_params)  # pyright: ignore[reportArgumentType]
            nothing = jnp.zeros((), jnp.float32)
            time_step = types.TimeStep(
                step_type=types.StepType.FIRST,
                reward=nothing,
                discount=jnp.ones((), jnp.float32),
                observation=observation,
                extras=dict.fromkeys(METRICS, nothing),
            )
            return keyed(base_env_state=state, rng_key=state_key), time_step

        def step(
            self, state: Any, action: Any, env_params: EnvParams | None = None
        ) -> tuple[Any, Any]:
            step_key, next_key = jax.random.split(state.rng_key)
            observation, following, reward, done, info = alone.step(
                step_key, state.base_env_state, action, env_params
            )
            kind = types.StepType
            truncated = info["truncated"]
            last = jnp.where(truncated, kind.TRUNCATED, kind.TERMINATED)
            extras = (info["GoalR"], info["distance"])
            time_step = types.TimeStep(
                step_type=jnp.where(done, last, kind.MID),
                reward=jnp.asarray(reward, jnp.float32),
                discount=jnp.where(done & ~truncated, 0.0, 1.0).astype(jnp.float32),
                observation=observation,
                extras={
                    name: jnp.asarray(value, jnp.float32)
                    for name, value in zip(METRICS, extras, strict=True)
                },
            )
            return keyed(base_env_state=following, rng_key=next_key), time_step

        def observation_space(self, env_params: EnvParams | None = None) -> Any:
            return stoa_space(env.observation_space(env_params))

        def action_space(self, env_params: EnvParams | None = None) -> Any:
            return stoa_space(env.action_space(env_params))

        def state_space(self, env_params: EnvParams | None = None) -> Any:
            raise NotImplementedError("states have no space: see observation_space")

        def render(self, state: Any, env_params: EnvParams | None = None) -> Any:
            return env.render(state.base_env_state)  # pyright: ignore[reportAttributeAccessIssue]

    return KinetixStoa()


def stoa_space(space: Any) -> Any:
    """Return one of our spaces as Stoa's.

    Args:
        space: From `observation_space` or `action_space`.
    """
    theirs: Any = importlib.import_module("stoa.spaces")
    match space:
        case spaces.MultiDiscrete():
            return theirs.MultiDiscreteSpace(
                num_values=jnp.asarray(space.number_of_dims_per_distribution), dtype=space.dtype
            )
        case spaces.Discrete():
            return theirs.DiscreteSpace(num_values=space.n, dtype=space.dtype)
        case spaces.Dict():
            return theirs.DictSpace({name: stoa_space(each) for name, each in space.spaces.items()})
    return theirs.BoundedArraySpace(
        shape=space.shape, dtype=space.dtype, minimum=space.low, maximum=space.high
    )
