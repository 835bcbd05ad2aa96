"""The environment as jaxued's `UnderspecifiedEnv`: it is given each level; episodes stay ended.

jaxued is not needed by the rest of the project; it is imported when the adapter is made.
"""

import importlib
from typing import Any

from jaxtyping import Array

from kinetix.environment.env import KinetixEnv
from kinetix.environment.params import EnvParams
from kinetix.environment.state import EnvState
from kinetix.errors import KinetixError


def as_underspecified_env(env: KinetixEnv) -> Any:
    """Return the environment as an instance of jaxued's `UnderspecifiedEnv`.

    A level is an `EnvState` (from `level_state`, a reset function or a sampler), so jaxued's
    wrappers and its `LevelSampler` take it.

    Args:
        env: The environment; whether it resets by itself does not matter.

    Raises:
        KinetixError: jaxued is not installed.
    """
    try:
        base: Any = importlib.import_module("jaxued.environments").UnderspecifiedEnv
    except ImportError:
        raise KinetixError("jaxued is not installed: pip install jaxued") from None

    class Underspecified(base):
        """An environment that plays the levels that it is given."""

        @property
        def default_params(self) -> EnvParams:
            return env.default_params

        def step_env(self, rng: Array, state: EnvState, action: Any, params: EnvParams) -> Any:
            return env.step_env(rng, state, action, params)

        def reset_env_to_level(
            self, rng: Array, level: EnvState, params: EnvParams
        ) -> tuple[Any, EnvState]:
            return env.reset_to_level(rng, level, params)

        def action_space(self, params: EnvParams) -> Any:
            return env.action_space(params)

        def observation_space(self, params: EnvParams) -> Any:
            return env.observation_space(params)

    return Underspecified()
