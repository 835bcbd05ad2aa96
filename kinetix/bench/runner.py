"""Runs the trials of a scene in our engine: all at once, one program a scene."""

import dataclasses
import functools
from collections.abc import Sequence
from typing import Any, Final

import jax
import jax.numpy as jnp
import numpy as np
from jaxtyping import Array, Int

from kinetix.bench.motion import Motion
from kinetix.engine.pipeline import step
from kinetix.engine.solvers.base import AbstractSolver
from kinetix.engine.spec import Capacity, SceneSpec
from kinetix.engine.types import Control, Parameters, State, World
from kinetix.environment.simulation import converted, precision, unclipped
from kinetix.level.compile import compile_level
from kinetix.level.features import features_of, features_union
from kinetix.level.sizes import needed_capacity
from kinetix.level.slots import body_slots
from kinetix.programs import make_room
from kinetix.scenes.model import Trial

CHUNK: Final = 60
"""Frames of one compiled scan: runs of any length share it."""


def run_trials(
    trials: Sequence[Trial],
    solver: AbstractSolver,
    *,
    binary64: bool = False,
    every: int = 1,
    like: Sequence[Trial] = (),
    spec: SceneSpec | None = None,
) -> list[Motion]:
    """Record every trial; all are padded to one capacity and stepped together.

    Args:
        trials: Of any duration and time step.
        solver: The method and its settings.
        binary64: Whether to compute in binary64 instead of binary32.
        every: Record every n-th step only; the `dt` of the motions is then n times as long.
        like: Further trials that capacity and features have to cover, for comparing the runs.
        spec: Capacity and features; by default exactly what all these trials need.
    """
    make_room()
    with precision(binary64):
        spec = spec or spec_for([*trials, *like], solver)
        return _run(trials, spec, solver, binary64, every)


def spec_for(trials: Sequence[Trial], solver: AbstractSolver) -> SceneSpec:
    """Return exactly what the trials need together."""
    capacity = functools.reduce(Capacity.union, (needed_capacity(t.level) for t in trials))
    spec = SceneSpec(capacity=capacity)
    scenes = [compile_level(trial.level, spec=spec, solver=solver) for trial in trials]
    features = features_union([features_of(scene) for scene in scenes], capacity)
    return SceneSpec(capacity=capacity, features=features)


def compiled_trials(
    trials: Sequence[Trial], solver: AbstractSolver, spec: SceneSpec | None = None
) -> tuple[SceneSpec, tuple[World, Control, Parameters], State]:
    """The trials as numpy arrays with a leading axis: what is given, and the state at the start.

    Args:
        trials: Of any duration and time step.
        solver: Provides the empty warm-start cache.
        spec: Capacity and features; by default exactly what the trials need.
    """
    spec = spec or spec_for(trials, solver)
    scenes = [compile_level(trial.level, spec=spec, solver=solver) for trial in trials]
    worlds = [
        _switched_off(scene.world) if trial.inactive else scene.world
        for trial, scene in zip(trials, scenes, strict=True)
    ]
    controls = [_control(trial, spec.capacity) for trial in trials]
    given = _stacked(worlds), _stacked(controls), _stacked([unclipped(t.dt) for t in trials])
    return spec, given, _stacked([scene.state for scene in scenes])


def _run(
    trials: Sequence[Trial], spec: SceneSpec, solver: AbstractSolver, binary64: bool, every: int
) -> list[Motion]:
    capacity = spec.capacity
    convert = functools.partial(converted, binary64=binary64)
    _, given, state = compiled_trials(trials, solver, spec)
    given, state = convert(given), convert(state)
    steps = -(-max(trial.steps for trial in trials) // every)
    start = (state.position, state.rotation, state.velocity, state.angular_velocity)
    parts = []
    for _ in range(0, steps, CHUNK):
        state, part = _record(state, given, jnp.int32(every), spec, solver)
        parts.append(jax.tree.map(np.asarray, part))
    *moved, overflow = (np.concatenate(part) for part in zip(*parts, strict=True))
    arrays = [
        np.concatenate([np.asarray(first)[None], rest]).astype(np.float64)
        for first, rest in zip(start, moved, strict=True)
    ]
    return [
        _motion(trial, index, arrays, overflow, capacity, every)
        for index, trial in enumerate(trials)
    ]


@functools.partial(jax.jit, static_argnames=("spec", "solver"))
def _record(
    state: State,
    given: tuple[World, Control, Parameters],
    every: Int[Array, ""],
    spec: SceneSpec,
    solver: AbstractSolver,
) -> tuple[State, tuple[Any, ...]]:
    """Return the state after a chunk, and (frame, world, …) of poses, velocities and overflow."""
    world, control, parameters = given
    advance = jax.vmap(functools.partial(step, spec=spec, solver=solver))

    def once(state: State, _: None) -> tuple[State, tuple[Any, ...]]:
        state, overflow = jax.lax.fori_loop(
            0, every, lambda _, carry: _advanced(carry), (state, jnp.zeros_like(state.overflow))
        )
        return state, (
            state.position,
            state.rotation,
            state.velocity,
            state.angular_velocity,
            overflow,
        )

    def _advanced(carry: tuple[State, Array]) -> tuple[State, Array]:
        state = advance(world, carry[0], control, parameters)
        return state, carry[1] | state.overflow

    return jax.lax.scan(once, state, None, length=CHUNK)


def _motion(
    trial: Trial,
    index: int,
    arrays: Sequence[np.ndarray],
    overflow: np.ndarray,
    capacity: Capacity,
    every: int,
) -> Motion:
    """Return one world's share, cut to its own duration, bodies in the level's order."""
    steps = -(-trial.steps // every)
    slots = body_slots(trial.level, capacity)
    order = [slots[body.id] for body in trial.level.bodies]
    position, rotation, velocity, angular = (
        array[: steps + 1, index][:, order] for array in arrays
    )
    return Motion(
        trial=trial if every == 1 else dataclasses.replace(trial, dt=trial.dt * every),
        position=position,
        rotation=rotation,
        velocity=velocity,
        angular_velocity=angular,
        overflow=float(overflow[:steps, index].mean()),
    )


def _control(trial: Trial, capacity: Capacity) -> Control:
    motor: Any = np.full(capacity.joints, trial.motor, np.float32)
    thruster: Any = np.full(capacity.thrusters, trial.thruster, np.float32)
    return Control(motor=motor, thruster=thruster)


def _stacked(trees: Sequence[Any]) -> Any:
    return jax.tree.map(lambda *leaves: np.stack([np.asarray(x) for x in leaves]), *trees)


def _switched_off(world: World) -> World:
    def off(part: Any) -> Any:
        return dataclasses.replace(part, active=np.zeros_like(part.active))

    return dataclasses.replace(
        world,
        bodies=off(world.bodies),
        joints=off(world.joints),
        thrusters=off(world.thrusters),
    )
