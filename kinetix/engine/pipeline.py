"""One time step of one world; `vmap` it for many."""

import functools
from collections.abc import Callable
from typing import Any

from jaxtyping import Array, Int

from kinetix.engine.batch import worlds_last
from kinetix.engine.fitting import fitted, narrow, widen
from kinetix.engine.solvers.base import AbstractSolver
from kinetix.engine.solvers.room import worlds_at_once
from kinetix.engine.spec import SceneSpec
from kinetix.engine.types import Control, Parameters, State, World


def step(
    world: World,
    state: State,
    control: Control,
    parameters: Parameters,
    *,
    spec: SceneSpec,
    solver: AbstractSolver,
) -> State:
    """Advance one world by `parameters.dt`.

    Args:
        world: What the level fixes.
        state: What changes; its cache must come from the same solver and spec.
        control: One value per joint and per thruster.
        parameters: Numbers that do not force a new compilation.
        spec: Sizes and features (static).
        solver: The method and its settings (static).

    Returns:
        The state after the step. Under `vmap` all worlds are advanced by one batched kernel.
    """
    run = _stepper(fitted(spec), solver)
    if spec.features.used is None:
        return run(world, state, control, parameters)
    return widen(state, run(*narrow(world, state, control, spec), parameters), spec)


def empty_cache(spec: SceneSpec, solver: AbstractSolver) -> Any:
    """Return `State.cache` before the first step, for one world, as numpy zeros."""
    return solver.empty_cache(fitted(spec))


@functools.cache
def _stepper(spec: SceneSpec, solver: AbstractSolver) -> Callable[..., State]:
    def kernel(world: World, state: State, control: Control, parameters: Parameters) -> State:
        return solver.step(world, state, control, parameters, spec)

    def effort(
        world: World, state: State, control: Control, parameters: Parameters
    ) -> Int[Array, " n"]:
        del control, parameters
        return solver.effort(world, state)

    def like(world: World, state: State, control: Control, parameters: Parameters) -> State:
        del world, control, parameters
        return state

    return worlds_last(
        kernel, effort, like, worlds_at_once(spec), made_of=("physics", spec, solver)
    )
