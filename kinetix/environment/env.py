"""The environment: reset, step and observation of one level, batched by `vmap`."""

import dataclasses
import functools
from collections.abc import Callable
from typing import Any, Self

import jax
import jax.numpy as jnp
from jaxtyping import Array

from kinetix.engine.batch import where_marked
from kinetix.environment.actions import ACTIONS, AbstractAction
from kinetix.environment.actions.checks import check_action
from kinetix.environment.checks import (
    check_key,
    check_one_state,
    check_params,
    check_parts,
    check_size,
    check_state,
    check_truth,
    fitted,
)
from kinetix.environment.dummy import DummyEnv
from kinetix.environment.eager import quick_alone
from kinetix.environment.kernels import observing, playing
from kinetix.environment.kinetix_env.methods import MethodsOfKinetixEnv, set_method
from kinetix.environment.observations import OBSERVATIONS, AbstractObservation, Layout
from kinetix.environment.params import (
    EnvParams,
    Parity,
    PhysicsEngine,
    StaticEnvParams,
    as_numbers,
    physics_engine,
    with_parity,
)
from kinetix.environment.spaces import ActionType, ObservationType, Space
from kinetix.environment.state import EnvState, StepResult
from kinetix.errors import KinetixError
from kinetix.lazy import lazy_names
from kinetix.level.sizes import describe_capacity

ResetFunction = Callable[[Array], EnvState]
"""Draws the state in which an episode starts."""


def _settled(state: EnvState) -> EnvState:
    """Return the state with strong dtypes, so that steps can be scanned."""
    return jax.tree.map(lambda x: jax.lax.convert_element_type(x, jnp.asarray(x).dtype), state)


@dataclasses.dataclass(frozen=True, kw_only=True)
class KinetixEnv(MethodsOfKinetixEnv):
    """One level at a time: make green and blue touch, without green touching red.

    - action: `actions`, motors and thrusters by binding (the folder actions/);
    - observation: `observations` (the folder observations/);
    - reward: +1 when green touches blue, −1 when green touches red (which wins), plus
      `dense_reward_scale` times the metres by which green and blue came closer;
    - done: a touch (`terminated`), a NaN (`nan`), or the level's time limit (`truncated`);
    - info: `GoalR` (green touched blue), `distance` [m], `terminated`, `truncated`, `nan`,
      `overflow`, and `terminal_observation` on request.

    Everything is written for one level; `reset`, `step` and `get_obs` work under `jit` and `vmap`
    (nested too), where all levels are stepped by one kernel. Environments are values: they compare
    and hash by all their parameters and options, so they can be static arguments of `jit`.
    """

    actions: AbstractAction
    observations: AbstractObservation
    reset_fn: ResetFunction | None
    """Draws the start of an episode when no override is given."""
    env_params: EnvParams
    static_env_params: StaticEnvParams
    auto_reset: bool = True
    """True if `step` goes on with a new episode where one is done."""
    keep_terminal_observation: bool = False
    """True if `info` carries the observation that auto-reset replaces."""

    def __repr__(self) -> str:
        """Name the observation, the action and the physics."""
        static = self.static_env_params
        return (
            f"<KinetixEnv: {self.observations.name} → {self.actions.name}, "
            f"size {describe_capacity(static.capacity)}, {static.physics}>"
        )

    def __deepcopy__(self, memo: Any) -> Self:
        """Return the environment itself: a copied `reset_fn` would be unequal and recompile."""
        return self

    @property
    def name(self) -> str:
        """The environment's name."""
        return "Kinetix"

    @property
    def default_params(self) -> EnvParams:
        """The parameters that the environment was made with."""
        return self.env_params

    @property
    def action_type(self) -> AbstractAction:
        """The kind of action; equal to its `ActionType`."""
        return self.actions

    @property
    def observation_type(self) -> AbstractObservation:
        """The kind of observation; equal to its `ObservationType`."""
        return self.observations

    @property
    def physics_engine(self) -> PhysicsEngine:
        """Sizes and solver of the physics."""
        return physics_engine(self.static_env_params)

    @property
    def num_actions(self) -> int:
        """Logits of a discrete policy, or the length of a continuous action."""
        space: Any = self.actions.action_space
        return space.n if hasattr(space, "n") else space.shape[0]

    def action_space(self, env_params: EnvParams | None = None) -> Any:
        """Return the set of actions; the argument is there for gymnax's sake."""
        return self.actions.action_space

    def observation_space(self, env_params: EnvParams | None = None) -> Space:
        """Return the space of `get_obs`; the argument is there for gymnax's sake."""
        return self.observations.space

    @quick_alone
    def reset(
        self,
        key: Array,
        env_params: EnvParams | None = None,
        override_reset_state: EnvState | None = None,
    ) -> tuple[Any, EnvState]:
        """Start an episode.

        Args:
            key: Draws the level.
            env_params: Parameters; by default those of the environment. A state alone in this
                place is taken for the next argument.
            override_reset_state: The state to start in, instead of one from `reset_fn`.

        Returns:
            Observation and state.

        Raises:
            KinetixError: Neither an override nor a `reset_fn` is given, or the state does not fit.
        """
        if isinstance(env_params, EnvState) and override_reset_state is None:
            # Wrappers whose `reset` has one argument beside the key pass a level through it.
            env_params, override_reset_state = None, env_params
        check_params(env_params)
        check_key(key)
        state = self._start(key, override_reset_state)
        return self._observe(state), state

    @quick_alone
    def step(
        self,
        key: Array,
        state: EnvState,
        action: Any,
        env_params: EnvParams | None = None,
        override_reset_state: EnvState | None = None,
    ) -> StepResult:
        """Play one action for `frame_skip` physics steps.

        Args:
            key: Draws the next level where this step ends the episode.
            state: From `reset` or `step`.
            action: An element of `action_space`.
            env_params: Parameters; by default those of the environment.
            override_reset_state: Where the next episode starts, instead of `reset_fn`.

        Returns:
            Observation, state, reward, done and info. With `auto_reset` observation and state are
            those of the new episode where done; reward, done and info belong to the old one.

        Raises:
            KinetixError: As for `reset`.
        """
        check_params(env_params)
        check_state(state, self.physics_engine)
        check_key(key)
        check_action(action, self.actions)
        params = self.env_params if env_params is None else env_params
        override = None if override_reset_state is None else self._fitted(override_reset_state)
        if self.auto_reset and override is None:
            self._require_reset_fn()
        key, state, action, params, override = jax.lax.stop_gradient(
            (key, state, action, params, override)
        )
        play = playing(self.actions, self.observations, self.static_env_params)
        played, observation, reward, done, info = play(state, action, params)
        state = _settled(dataclasses.replace(state, **played))
        if self.keep_terminal_observation:
            info["terminal_observation"] = observation
        if self.auto_reset:
            renew = where_marked(self._first_step)
            state, observation = renew((state, observation), done, (key, override))
        return observation, state, reward, done, info

    @quick_alone
    def get_obs(self, state: EnvState) -> Any:
        """Return the observation of a state.

        Raises:
            KinetixError: `state` is not a state, is a batch of them, or has other sizes.
        """
        check_one_state(state, "jax.vmap(env.get_obs)")
        check_size(state, self.static_env_params.capacity)
        return self._observe(state)

    def _observe(self, state: EnvState) -> Any:
        return observing(self.observations)(jax.lax.stop_gradient(state))

    def _fitted(self, state: EnvState) -> EnvState:
        return fitted(state, self.physics_engine)

    def _require_reset_fn(self) -> ResetFunction:
        if self.reset_fn is None:
            raise KinetixError(
                "the environment was made with reset_fn=None: pass a level as "
                "override_reset_state to reset and step, make it with a reset function such as "
                "make_reset_fn_list_of_levels(…), or with auto_reset=False, so that episodes end"
            )
        return self.reset_fn

    def _start(self, key: Array, override: EnvState | None) -> EnvState:
        return self._fitted(self._require_reset_fn()(key) if override is None else override)

    def _first_step(self, seeds: tuple[Array, EnvState | None]) -> tuple[EnvState, Any]:
        """Return the state and observation at the start of an episode."""
        state = self._start(*seeds)
        return state, self._observe(state)


KinetixEnv.__setattr__ = set_method


def make_kinetix_env(  # noqa: PLR0913 (the public signature)
    action_type: (
        ActionType | str | AbstractAction | type[AbstractAction]
    ) = ActionType.MULTI_DISCRETE,
    observation_type: (
        ObservationType | str | AbstractObservation | type[AbstractObservation]
    ) = ObservationType.SYMBOLIC_ENTITY,
    reset_fn: ResetFunction | None = None,
    env_params: EnvParams | None = None,
    static_env_params: StaticEnvParams | None = None,
    auto_reset: bool = True,
    create_dummy_env: bool = False,
    *,
    keep_terminal_observation: bool = False,
    parity: Parity | None = None,
) -> KinetixEnv | DummyEnv:
    """Make an environment.

    Args:
        action_type: Kind of action, its name, or a class of one's own or an object of one.
        observation_type: Likewise of observation. An object keeps its options; the sizes are those
            of the environment.
        reset_fn: Draws the state in which an episode starts; None: levels are given to `reset`
            and `step` as overrides.
        env_params: Parameters that need no compilation.
        static_env_params: Sizes, physics preset, frame skip.
        auto_reset: Whether `step` goes on with a new episode where one is done.
        create_dummy_env: Whether stepping shall do nothing, to debug training code quickly.
        keep_terminal_observation: Whether `info["terminal_observation"]` keeps what auto-reset
            replaces.
        parity: `"kinetix-3"` for the physics and touch rules of kinetix-env.

    Raises:
        KinetixError: An argument names nothing known; the message lists what is.
    """
    env_params = EnvParams() if env_params is None else env_params
    static_env_params = StaticEnvParams() if static_env_params is None else static_env_params
    check_parts(reset_fn, env_params, static_env_params)
    check_truth("auto_reset", auto_reset)
    check_truth("create_dummy_env", create_dummy_env)
    check_truth("keep_terminal_observation", keep_terminal_observation)
    env_params = as_numbers(env_params)
    static_env_params = with_parity(static_env_params, parity)
    physics_engine(static_env_params)
    actions = _kind(action_type, AbstractAction, "action_type", ActionType, ACTIONS)
    observations = _kind(
        observation_type, AbstractObservation, "observation_type", ObservationType, OBSERVATIONS
    )
    env = KinetixEnv(
        actions=actions(
            motor_bindings=static_env_params.num_motor_bindings,
            thruster_bindings=static_env_params.num_thruster_bindings,
        ),
        observations=observations(layout=Layout.of(env_params, static_env_params)),
        reset_fn=reset_fn,
        env_params=env_params,
        static_env_params=static_env_params,
        auto_reset=auto_reset,
        keep_terminal_observation=keep_terminal_observation,
    )
    return DummyEnv(env=env) if create_dummy_env else env


def _kind(value: Any, base: type, argument: str, names: Any, table: dict[str, Any]) -> Any:
    """Return a function that makes the kind that a value means."""
    if isinstance(value, base):
        return functools.partial(dataclasses.replace, value)
    if isinstance(value, type) and issubclass(value, base):
        return value
    name = value if isinstance(value, type) else getattr(value, "value", value)
    try:
        return table[names(name.lower() if isinstance(name, str) else name).value]
    except ValueError:
        known = ", ".join(member.value for member in names)
        raise KinetixError(
            f"{argument}={name!r}: expected one of {known}, or a class made from {base.__name__}"
        ) from None


__getattr__ = lazy_names(__name__)[0]
