"""Compiled environment steps: one for every level of a size, and those made for one level alone.

A step that is made for a level computes only what that level can ever do (which shapes can meet,
whether there are motors, limits, thrusters, bouncing), so it costs less and plays alike but for
rounding. It is compiled ahead, on request, and looked up when an episode begins.
"""

import collections
import dataclasses
import functools
import inspect
import threading
from collections.abc import Callable
from typing import Any, Final, TypeAlias

import jax
import jax.numpy as jnp
from jaxtyping import Array

from editor.requests import Progress, Tailor
from editor.simulation.quiet import not_stored, without_pauses
from kinetix.engine.spec import Capacity
from kinetix.environment.env import KinetixEnv, make_kinetix_env
from kinetix.environment.params import EnvParams, StaticEnvParams, static_env_params_of
from kinetix.environment.reset import level_state
from kinetix.environment.spaces import ActionType, ObservationType
from kinetix.environment.state import EnvState
from kinetix.level.compile import features_of
from kinetix.level.model import Level
from kinetix.level.sizes import capacity_of

KEPT: Final = 12
"""Steps for single levels that are kept, the last ones used: each holds some megabytes."""

MOVING: Final = ("physics", "timestep", "last_distance")
"""Fields of a state that a step changes. The others, which the level fixes, are neither returned by
a compiled step nor fetched after it: that would take about as long as the physics of one world."""

Compiled: TypeAlias = Callable[[EnvState, Array], tuple[dict[str, Any], dict[str, Array]]]
"""From a state and a multi-discrete action to the fields that moved and the step's `info`."""


@dataclasses.dataclass(frozen=True, kw_only=True)
class Stepper:
    """A compiled environment step with the environment that it belongs to."""

    env: KinetixEnv
    compiled: Compiled
    tailored: bool
    """Whether it was made for one level alone."""

    def step(self, state: EnvState, action: Array) -> tuple[EnvState, dict[str, Array]]:
        """The next state and the environment's `info`, with `reward`, `done` and `unified`."""
        moved, info = self.compiled(state, action)
        return dataclasses.replace(state, **moved), info


class Shelf:
    """Steps for single levels, the last used ones; two workers share it."""

    def __init__(self) -> None:
        self._steppers: collections.OrderedDict[StaticEnvParams, Stepper] = (
            collections.OrderedDict()
        )
        self._lock = threading.Lock()

    def get(self, static: StaticEnvParams) -> Stepper | None:
        """The step that was made for these parameters, or None."""
        with self._lock:
            stepper = self._steppers.get(static)
            if stepper is not None:
                self._steppers.move_to_end(static)
            return stepper

    def put(self, static: StaticEnvParams, stepper: Stepper) -> None:
        """Keep a step; the one that was used least recently goes when there are too many."""
        with self._lock:
            self._steppers[static] = stepper
            while len(self._steppers) > KEPT:
                self._steppers.popitem(last=False)


_SHELF: Final = Shelf()


@functools.cache
def environment(capacity: Capacity, physics: str) -> KinetixEnv:
    """The environment of a size and a preset; the same value, and so the same compilation, again.

    Raises:
        KinetixError: The preset does not exist.
    """
    return _environment(static_params(capacity, physics))


def _environment(static: StaticEnvParams) -> KinetixEnv:
    env = make_kinetix_env(
        ActionType.MULTI_DISCRETE,
        ObservationType.BLIND,
        None,
        EnvParams(),
        static,
        auto_reset=False,
    )
    assert isinstance(env, KinetixEnv)
    return env


@functools.cache
def static_params(capacity: Capacity, physics: str) -> StaticEnvParams:
    """The static parameters of a size: frame skip 2, as people play."""
    return static_env_params_of(capacity, physics=physics)


def tailored_params(level: Level, physics: str) -> StaticEnvParams:
    """The static parameters of one level: its size, and of that only what it fills and can do.

    They are the key of its step: who moves a shape needs no other one, who adds a part does.

    Raises:
        LevelError: The level does not fit its size.
    """
    static = static_params(capacity_of(level), physics)
    return dataclasses.replace(static, features=features_of(level))


_TRACED: Final[Any] = inspect.unwrap(KinetixEnv.step)
"""The step without its own `jit`, which would remember every environment that it was traced for."""


def _advanced(
    env: KinetixEnv, state: EnvState, action: Array
) -> tuple[dict[str, Any], dict[str, Array]]:
    _, after, reward, done, info = _TRACED(env, jax.random.key(0), state, action)
    moved = {name: getattr(after, name) for name in MOVING}
    wanted = {name: info[name] for name in ("GoalR", "distance", "terminated", "nan")}
    unified = env.actions.unified(action)
    return moved, wanted | {"reward": reward, "done": done, "unified": unified}


_step = functools.partial(jax.jit, static_argnums=0)(_advanced)


def first_state(level: Level, static: StaticEnvParams) -> EnvState:
    """The first state of a level in an environment with these parameters.

    Raises:
        KinetixError: The level does not fit, or the preset does not exist.
    """
    return jax.tree.map(jnp.asarray, level_state(level, static))


def start_state(level: Level, physics: str) -> EnvState:
    """The first state of a level, compiled to the capacity that its size says.

    Raises:
        KinetixError: The level does not fit, or the preset does not exist.
    """
    return first_state(level, static_params(capacity_of(level), physics))


def without_memory(state: EnvState) -> EnvState:
    """A state to look at: what the solver keeps for its next step is left out.

    Its shapes depend on the step; without it one compiled drawing serves all steps of a size.
    """
    return dataclasses.replace(state, physics=dataclasses.replace(state.physics, cache=()))


def generic_stepper(level: Level, physics: str) -> Stepper:
    """The step that every level of the size shares; the first one of a size compiles it."""
    env = environment(capacity_of(level), physics)
    return Stepper(env=env, compiled=functools.partial(_step, env), tailored=False)


def best_stepper(level: Level, physics: str) -> Stepper:
    """The step that was made for this level where it is ready, otherwise the shared one.

    Raises:
        KinetixError: The level does not fit, or the preset does not exist.
    """
    return _SHELF.get(tailored_params(level, physics)) or generic_stepper(level, physics)


def warm_up(capacity: Capacity, physics: str) -> None:
    """Compile the step of a size by playing one step of an empty level."""
    env = environment(capacity, physics)
    state = first_state(Level(name="empty"), env.static_env_params)
    jax.block_until_ready(_step(env, state, _no_action()))


def tailor(request: Tailor, progress: Progress) -> None:
    """Compile the step of one level, unless it is there already; see `Tailor`.

    Raises:
        KinetixError: The level does not fit, or the preset does not exist.
        Cancelled: It is not wanted any more.
    """
    static = tailored_params(request.level, request.physics)
    if _SHELF.get(static) is not None:
        return
    env = _environment(static)
    # A function of its own, so that a step which is dropped leaves nothing behind.
    step: Any = jax.jit(functools.partial(_advanced, env))

    def going_on() -> None:
        """No part can be interrupted: between two of them, ask whether Play has begun."""
        progress.report(None, "Compiling for this level")

    with without_pauses(), not_stored():
        going_on()
        traced = step.trace(first_state(request.level, static), _no_action())
        going_on()
        lowered = traced.lower()
        going_on()
        compiled = lowered.compile()
    _SHELF.put(static, Stepper(env=env, compiled=compiled, tailored=True))


def _no_action() -> Array:
    return jnp.zeros(6, jnp.int32)
