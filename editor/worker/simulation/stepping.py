"""Compiled environment steps: one for every level of a size, and those made for one level alone.

A step that is made for a level computes only what that level can ever do (which shapes can meet,
whether there are motors, limits, thrusters, bouncing), so it costs less and plays alike but for
rounding. Either kind comes in two tiers: one that is compiled quickly, so that somebody who waits
for Play waits for seconds, and one that is compiled in the background. An episode keeps the step
that it began with.
"""

import dataclasses
import functools
import inspect
from collections.abc import Callable
from typing import Any, Final, TypeAlias

import jax
import numpy as np
from jaxtyping import Array

from editor.worker.requests import GetReady, Progress, Tailor
from editor.worker.simulation import disk
from editor.worker.simulation.compiling import FULL, QUICK, Programs, Recipe, Tier
from editor.worker.yielding import without_pauses
from kinetix.engine.spec import Capacity, Features
from kinetix.environment.env import KinetixEnv
from kinetix.environment.params import StaticEnvParams, static_env_params_of
from kinetix.environment.replay import playing_env
from kinetix.environment.reset import level_state
from kinetix.environment.state import EnvState
from kinetix.files.caches import tidy_caches
from kinetix.level.features import features_of
from kinetix.level.model import Level
from kinetix.level.sizes import capacity_of
from kinetix.memory import give_back_memory
from kinetix.pytree import on_device

MOVING: Final = ("physics", "timestep", "last_distance")
"""Fields of a state that a step changes. The others, which the level fixes, are neither returned by
a compiled step nor fetched after it: that would take about as long as the physics of one world."""
_TOLD: Final = ("GoalR", "distance", "terminated", "truncated", "nan", "overflow")
"""Entries of the environment's `info` that are kept."""

Compiled: TypeAlias = Callable[[EnvState, Array], tuple[dict[str, Any], dict[str, Array]]]
"""From a state and a multi-discrete action to the fields that moved and the step's `info`."""


@dataclasses.dataclass(frozen=True, kw_only=True)
class StepKey:
    """Key of a compiled step."""

    static: StaticEnvParams
    tier: Tier

    @property
    def tailored(self) -> bool:
        """True if it is made for one level alone."""
        return self.static.features != Features()

    @property
    def quick(self) -> bool:
        """True if it is the tier that is compiled quickly."""
        return self.tier is QUICK


@dataclasses.dataclass(frozen=True, kw_only=True)
class Stepper:
    """A compiled environment step with the environment that it belongs to."""

    env: KinetixEnv
    compiled: Compiled
    tailored: bool
    """True if it was made for one level alone."""
    quick: bool = False
    """True if it was compiled quickly."""

    def step(self, state: EnvState, action: Array) -> tuple[EnvState, dict[str, Array]]:
        """Return the next state and the environment's `info`, with `reward` and `unified`."""
        moved, info = self.compiled(state, action)
        return dataclasses.replace(state, **moved), info


PROGRAMS: Final = Programs()
"""The compiled steps; all threads share them."""


@functools.cache
def environment(capacity: Capacity, physics: str) -> KinetixEnv:
    """The environment of a size and a preset; the same value, and so the same compilation, again.

    Raises:
        KinetixError: The preset does not exist.
    """
    return playing_env(static_params(capacity, physics))


@functools.cache
def static_params(capacity: Capacity, physics: str) -> StaticEnvParams:
    """Return the static parameters of a size: frame skip 2, as people play."""
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
    _, after, reward, _, info = _TRACED(env, jax.random.key(0), state, action)
    moved = {name: getattr(after, name) for name in MOVING}
    wanted = {name: info[name] for name in _TOLD}
    unified = env.actions.unified(action)
    return moved, wanted | {"reward": reward, "unified": unified}


def first_state(level: Level, static: StaticEnvParams) -> EnvState:
    """Return the first state of a level in an environment with these parameters.

    Raises:
        KinetixError: The level does not fit, or the preset does not exist.
    """
    return on_device(level_state(level, static))


def start_state(level: Level, physics: str) -> EnvState:
    """Return the first state of a level, compiled to the capacity that its size says.

    Raises:
        KinetixError: The level does not fit, or the preset does not exist.
    """
    return first_state(level, static_params(capacity_of(level), physics))


def without_memory(state: EnvState) -> EnvState:
    """Return a state to look at: what the solver keeps for its next step is left out.

    Its shapes depend on the step; without it one compiled drawing serves all steps of a size.
    """
    return dataclasses.replace(state, physics=dataclasses.replace(state.physics, cache=()))


def best_stepper(level: Level, physics: str, progress: Progress, *, quick: bool) -> Stepper:
    """Return the best step for a level that is ready, otherwise one that is compiled now.

    Args:
        level: The level.
        physics: Preset or solver.
        progress: Called with how far the compiler is.
        quick: Whether the quick tier will do.

    Raises:
        KinetixError: The level does not fit, or the preset does not exist.
        Cancelled: It is not wanted any more.
    """
    own, shared = tailored_params(level, physics), static_params(capacity_of(level), physics)
    keys = [StepKey(static=own, tier=FULL), StepKey(static=shared, tier=FULL)]
    if quick:
        # On disk the step of the size is likelier, and it is as good as at once.
        ready = next((key for key in keys if PROGRAMS.get(key) is not None), None)
        stored = next((key for key in keys if disk.has(key)), None)
        key = ready or stored or StepKey(static=own, tier=QUICK)
    else:
        key = keys[0] if PROGRAMS.get(keys[0]) is not None else keys[1]
    return stepper(level, key, progress)


def generic_stepper(level: Level, physics: str, progress: Progress) -> Stepper:
    """Return the step that every level of the size shares; the first one of a size compiles it."""
    static = static_params(capacity_of(level), physics)
    return stepper(level, StepKey(static=static, tier=FULL), progress)


def own_stepper(level: Level, physics: str, progress: Progress, *, quick: bool) -> Stepper:
    """The step for this level alone: the quick tier where it will do and the other is not ready."""
    static = tailored_params(level, physics)
    full = StepKey(static=static, tier=FULL)
    other = quick and PROGRAMS.get(full) is None
    return stepper(level, StepKey(static=static, tier=QUICK) if other else full, progress)


def stepper(level: Level, key: StepKey, progress: Progress, *, background: bool = False) -> Stepper:
    """Return one of a level's steps: from memory, from disk, or when it has been compiled.

    Raises:
        KinetixError: The level does not fit, or the preset does not exist.
        Cancelled: It is not wanted any more.
    """
    env = playing_env(key.static)
    compiled = PROGRAMS.get(key) or _loaded(level, key, progress)
    if compiled is None:
        # A function of its own, so that a step which is dropped leaves nothing behind.
        step: Any = jax.jit(functools.partial(_advanced, env))
        state = first_state(level, key.static)
        recipe = Recipe(key=key, tier=key.tier, trace=lambda: step.trace(state, _no_action()))
        compiled = PROGRAMS.obtain(recipe, progress, background=background)
    return Stepper(env=env, compiled=compiled, tailored=key.tailored, quick=key.quick)


def _loaded(level: Level, key: StepKey, progress: Progress) -> Compiled | None:
    """Return a step from disk, or None."""
    progress.report(None, "Compiling the level")
    state = first_state(level, key.static)
    with without_pauses():
        compiled = disk.load(key, (state, _no_action()), _results(state))
    if compiled is not None:
        PROGRAMS.put(key, compiled)
    return compiled


def _results(state: EnvState) -> Any:
    """Return a tree like what `_advanced` gives."""
    moved = {name: getattr(state, name) for name in MOVING}
    return moved, dict.fromkeys((*_TOLD, "reward", "unified"), 0)


def warm_up(capacity: Capacity, physics: str, progress: Progress) -> None:
    """Compile the step of a size in the background, or load it.

    Raises:
        KinetixError: The preset does not exist.
        Cancelled: It is not wanted any more.
    """
    key = StepKey(static=static_params(capacity, physics), tier=FULL)
    stepper(Level(name="empty"), key, progress, background=True)


def get_ready(request: GetReady, progress: Progress) -> None:
    """Have a step for a level, soon; see `GetReady`.

    Raises:
        KinetixError: The level does not fit, or the preset does not exist.
        Cancelled: It is not wanted any more.
    """
    best_stepper(request.level, request.physics, progress, quick=True)


def tailor(request: Tailor, progress: Progress) -> None:
    """Compile the step of one level in the background, unless it is there already; see `Tailor`.

    Raises:
        KinetixError: The level does not fit, or the preset does not exist.
        Cancelled: It is not wanted any more.
    """
    key = StepKey(static=tailored_params(request.level, request.physics), tier=FULL)
    stepper(request.level, key, progress, background=True)


def keep_programs() -> None:
    """Write the steps that were compiled to disk, make room there and in memory."""
    for key, program in PROGRAMS.taken_fresh():
        if isinstance(key, StepKey):
            disk.save(key, program)
    tidy_caches()
    give_back_memory()


def _no_action() -> Array:
    return on_device(np.zeros(6, np.int32))
