"""The shapes of an environment with a step that does nothing, to debug training code quickly."""

import dataclasses
import functools
from typing import TYPE_CHECKING, Any

import jax
import jax.numpy as jnp
from jaxtyping import Array

from kinetix.environment.checks import fitted
from kinetix.environment.params import EnvParams
from kinetix.environment.state import EnvState, StepResult, state_of
from kinetix.level.compile import empty_scene

if TYPE_CHECKING:
    from kinetix.environment.env import KinetixEnv


@dataclasses.dataclass(frozen=True, kw_only=True)
class DummyEnv:
    """An environment whose every episode stays at its start.

    That is the empty level; the reward is 0 and nothing is ever done. Everything else is that of
    the environment it stands in for.
    """

    env: "KinetixEnv"

    def step_env(
        self, key: Array, state: EnvState, action: Any, params: EnvParams | None = None
    ) -> StepResult:
        """Return the same state again."""
        return self.step(key, state, action, params)

    def reset_env(self, key: Array, params: EnvParams | None = None) -> tuple[Any, EnvState]:
        """Observation and state of the empty level."""
        return self.reset(key, params)

    def __getattr__(self, name: str) -> Any:
        """Spaces, parameters and names of the real environment."""
        if name.startswith("__"):
            raise AttributeError(name)
        return getattr(self.env, name)

    @functools.partial(jax.jit, static_argnums=0)
    def reset(
        self,
        key: Array,
        env_params: EnvParams | None = None,
        override_reset_state: EnvState | None = None,
    ) -> tuple[Any, EnvState]:
        """Observation and state of the empty level, or of the override."""
        engine = self.env.physics_engine
        state = override_reset_state
        if state is None:
            state = state_of(empty_scene(engine.spec, engine.solver))
        state = fitted(state, engine)
        return self.env.get_obs(state), state

    @functools.partial(jax.jit, static_argnums=0)
    def step(
        self,
        key: Array,
        state: EnvState,
        action: Any,
        env_params: EnvParams | None = None,
        override_reset_state: EnvState | None = None,
    ) -> StepResult:
        """Return the same state again."""
        no = jnp.zeros((), bool)
        info = dict.fromkeys(("GoalR", "terminated", "truncated", "nan", "overflow"), no)
        info |= {"distance": jnp.zeros(())}
        observation = self.env.get_obs(state)
        if self.env.keep_terminal_observation:
            info["terminal_observation"] = observation
        return observation, state, jnp.zeros(()), no, info
