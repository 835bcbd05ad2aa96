"""Simulates a level from Python: one compiled scan, the motion as numpy arrays."""

import contextlib
import dataclasses
import functools
import math
from collections.abc import Iterator
from pathlib import Path
from typing import Any, Final

import jax
import jax.numpy as jnp
import numpy as np
from jax.core import Tracer
from jaxtyping import Array, Float, Int

from kinetix.engine.names import DEFAULT_PHYSICS
from kinetix.engine.pipeline import step
from kinetix.engine.presets import solver_named
from kinetix.engine.promotion import usual_promotion
from kinetix.engine.solvers.base import AbstractSolver
from kinetix.engine.spec import SceneSpec
from kinetix.engine.types import Parameters, State, World, default_parameters
from kinetix.environment.actions import ContinuousActions, MultiDiscreteActions
from kinetix.environment.bounds import as_number
from kinetix.errors import KinetixError
from kinetix.forks import SPAWN, refuse_forked_process
from kinetix.level.codec import check_computable, load_level
from kinetix.level.compile import Labels, compile_level
from kinetix.level.features import features_of
from kinetix.level.model import Level, Solution
from kinetix.level.sizes import capacity_of, needed_capacity
from kinetix.level.slots import body_slots
from kinetix.programs import make_room
from kinetix.wording import plural

UNCLIPPED: Final = 1e6
"""A bound of positions and speeds far beyond anything that may happen [m], [m/s], [rad/s]."""
CHUNK: Final = 128
"""Steps of one compiled scan: runs of any length share it."""
RECORDED_DT: Final = 1 / 60
"""Time step at which solutions are recorded [s]."""
MOST_STEPS: Final = 10_000_000
"""Longer runs would fill the memory."""


@dataclasses.dataclass(frozen=True, kw_only=True, eq=False, repr=False)
class Run:
    """A simulated level. Axis `k` is time with the start, `b` the level's bodies in order."""

    level: Level
    physics: str
    """The preset or solver."""
    ids: Int[np.ndarray, " b"]
    """Of the bodies, as the level has them."""
    time: Float[np.ndarray, " k"]
    """Times of the frames [s]."""
    position: Float[np.ndarray, "k b 2"]
    """Centres of mass [m]."""
    rotation: Float[np.ndarray, "k b"]
    """Angles, counter-clockwise, never wrapped [rad]."""
    velocity: Float[np.ndarray, "k b 2"]
    """Of the centres of mass [m/s]."""
    angular_velocity: Float[np.ndarray, "k b"]
    """Angular velocities of the bodies [rad/s]."""
    dropped_contacts: Int[np.ndarray, " s"]
    """Per step (one fewer than moments): 0 where every contact was solved."""

    def index(self, body_id: int) -> int:
        """Return the place of a body on the axis `b`.

        Raises:
            KinetixError: The level has no such body.
        """
        found = np.flatnonzero(self.ids == body_id)
        if not len(found):
            raise KinetixError(
                f"there is no body {body_id!r} in level {self.level.name!r}: expected one of "
                f"{', '.join(map(str, self.ids[:20]))}"
            )
        return int(found[0])

    def __repr__(self) -> str:
        """The name, how much there is, and whether all contacts were solved."""
        dropped = int((self.dropped_contacts > 0).sum())
        noted = f", contacts dropped in {plural(dropped, 'step')}" if dropped else ""
        return (
            f"Run({self.level.name!r}: {plural(len(self.ids), 'body', 'bodies')}, "
            f"{self.time[-1]:g} s in {plural(len(self.time) - 1, 'step')}, {self.physics}{noted})"
        )


def simulate(
    level: Level | str | Path,
    seconds: float,
    *,
    physics: str | AbstractSolver = DEFAULT_PHYSICS,
    actions: Any = None,
    dt: float = 1 / 60,
    specialised: bool = True,
) -> Run:
    """Simulate a level and return the motion of its bodies.

    Positions and speeds are clipped as in the environment, but not in a level without walls
    (`LevelBuilder(arena=False)`). The first run of a scene compiles; later ones of levels that
    differ in numbers alone, such as places, sizes, speeds and masses, do not.

    Args:
        level: Any level, its file, or the name of a bundled one.
        seconds: For how long.
        physics: A preset, or a solver: by its name, or one of one's own; `reference` computes in
            binary64.
        actions: What drives motors and thrusters: nothing (motors with `auto` run all the same);
            six numbers (motor channels −1 … 1, then thruster channels 0 … 1) that are held; a row
            of them per step; or a `Solution`, such as the level's own, whose actions last as long
            as when they were recorded, whatever `dt`.
        dt: Time step [s].
        specialised: Compile a step for this scene alone. Otherwise it is that of the level's size.

    Raises:
        KinetixError: An argument is none of that; or the process was forked from one in which JAX
            runs.
        LevelError: The level does not exist, or cannot be compiled.
    """
    refuse_forked_process(f"{SPAWN}; a sweep in one process reuses what it has compiled")
    make_room()
    if isinstance(level, str | Path):
        level = load_level(level)
    if not isinstance(level, Level):
        raise KinetixError(
            f"level {level!r:.60}: expected a name, a file, or a kinetix.Level, from "
            "LevelBuilder.build() or load_level()"
        )
    for name, value in (("seconds", seconds), ("actions", actions), ("dt", dt)):
        if any(isinstance(x, Tracer) for x in jax.tree.leaves(value)):
            raise KinetixError(
                f"{name}: simulate takes numbers, no tracers: it cannot stand inside jax.jit, "
                "jax.vmap or jax.grad (the engine has no derivative); env.step can, but for grad"
            )
    seconds, dt = as_number(seconds), as_number(dt)
    steps = _steps(seconds, dt)
    solver = solver_named(physics)
    rows = _action_rows(actions, steps, dt)
    # There is no step for no body at all.
    specialised = specialised and bool(level.bodies)
    check_computable(level)
    with usual_promotion():
        spec = SceneSpec(capacity=needed_capacity(level) if specialised else capacity_of(level))
        if specialised:
            features = features_of(level, capacity=spec.capacity)
            spec = dataclasses.replace(spec, features=features)
        scene = compile_level(level, spec=spec, solver=solver)
    binary64 = physics == "reference"
    with precision(binary64), usual_promotion():
        world, labels, state = converted(
            (scene.world, scene.labels, scene.state), binary64=binary64
        )
        parameters = scene_parameters(level, dt)
        frames = [_start(state)]
        for first in range(0, steps, CHUNK):
            part = rows[first : first + CHUNK]
            part = np.pad(part, ((0, CHUNK - len(part)), (0, 0)))
            state, frame = _advance(world, labels, state, part, parameters, spec, solver)
            frames.append(jax.tree.map(np.asarray, frame))
    slots = body_slots(level, spec.capacity)
    order = np.array([slots[body.id] for body in level.bodies], int)
    *moved, dropped = (_frozen(np.concatenate(parts)) for parts in zip(*frames, strict=True))
    position, rotation, velocity, angular = (_frozen(x[: steps + 1, order]) for x in moved)
    return Run(
        level=level,
        physics=physics if isinstance(physics, str) else repr(physics),
        ids=_frozen(np.array([body.id for body in level.bodies], int)),
        time=_frozen(np.arange(steps + 1) * dt),
        position=position,
        rotation=rotation,
        velocity=velocity,
        angular_velocity=angular,
        dropped_contacts=dropped[:steps],
    )


@functools.partial(jax.jit, static_argnames=("spec", "solver"))
def _advance(
    world: World,
    labels: Labels,
    state: State,
    actions: Float[Array, "k u"],
    parameters: Parameters,
    spec: SceneSpec,
    solver: AbstractSolver,
) -> tuple[State, tuple[Any, ...]]:
    def once(state: State, action: Float[Array, " u"]) -> tuple[State, tuple[Any, ...]]:
        control = ContinuousActions().process_action(action, labels)
        state = step(world, state, control, parameters, spec=spec, solver=solver)
        return state, (
            state.position,
            state.rotation,
            state.velocity,
            state.angular_velocity,
            state.overflow.astype(jnp.int32),
        )

    return jax.lax.scan(once, state, actions)


def _start(state: State) -> tuple[np.ndarray, ...]:
    first = (state.position, state.rotation, state.velocity, state.angular_velocity)
    # Steps, not moments, drop contacts.
    return (*(np.asarray(x)[None] for x in first), np.zeros(0, np.int32))


def scene_parameters(level: Level, dt: float) -> Parameters:
    """Return the parameters of a run: without walls nothing is clipped."""
    arena = (level.arena.floor, level.arena.left_wall, level.arena.right_wall, level.arena.ceiling)
    if all(part.collision == "ghost" for part in arena):
        return unclipped(dt)
    return default_parameters(dt=dt)


def unclipped(dt: float) -> Parameters:
    """Return parameters without bounds of positions and speeds."""
    return default_parameters(
        dt=dt,
        clip_position=UNCLIPPED,
        clip_velocity=UNCLIPPED,
        clip_angular_velocity=UNCLIPPED,
    )


@contextlib.contextmanager
def precision(binary64: bool) -> Iterator[None]:
    """Within it JAX computes in binary64, or as it is set."""
    with jax.enable_x64(True) if binary64 else contextlib.nullcontext():
        yield


def converted(tree: Any, *, binary64: bool) -> Any:
    """Return the arrays as JAX's, reals in binary64 or binary32."""
    real = jnp.float64 if binary64 else jnp.float32

    def convert(leaf: np.ndarray) -> jax.Array:
        return jnp.asarray(leaf, real if np.issubdtype(leaf.dtype, np.floating) else leaf.dtype)

    return jax.tree.map(convert, tree)


def _steps(seconds: float, dt: float) -> int:
    for name, value in (("seconds", seconds), ("dt", dt)):
        if not (isinstance(value, int | float | np.number) and 0 < value < math.inf):
            raise KinetixError(f"{name} {value!r}: expected a finite number above 0")
    steps = math.ceil(seconds / dt - 1e-6)
    if steps > MOST_STEPS:
        raise KinetixError(
            f"seconds {seconds:g} with dt {dt:g}: expected at most {MOST_STEPS} steps"
        )
    return max(steps, 1)


def _action_rows(actions: Any, steps: int, dt: float) -> Float[np.ndarray, "s u"]:
    """Return one row of the unified action per step."""
    kind = ContinuousActions()
    channels = kind.motor_bindings + kind.thruster_bindings
    if actions is None:
        return np.zeros((steps, channels), np.float32)
    if isinstance(actions, Solution):
        return _solution_rows(actions, steps, dt)
    if isinstance(actions, str):
        raise KinetixError(
            f"actions {actions!r:.60}: expected finite numbers, a row per step; those that a level "
            "records are its .solution"
        )
    try:
        rows = np.asarray(actions, np.float32)
    except (TypeError, ValueError):
        rows = np.full(0, np.nan, np.float32)
    if rows.shape not in ((channels,), (steps, channels)) or not np.isfinite(rows).all():
        raise KinetixError(
            f"actions of shape {rows.shape}: expected finite numbers of shape ({channels},) or "
            f"({steps}, {channels}), a row per step"
        )
    return np.broadcast_to(rows, (steps, channels))


def _solution_rows(solution: Solution, steps: int, dt: float) -> Float[np.ndarray, "s u"]:
    """Return the recorded actions, each for as long as it was recorded, then nothing.

    Raises:
        KinetixError: A step would be longer than an action.
    """
    lasts = solution.frame_skip * RECORDED_DT
    if dt > lasts * (1 + 1e-6):
        raise KinetixError(
            f"dt {dt:g}: expected at most {lasts:.4g} s, for which each action of the solution "
            "lasts"
        )
    # By the middle of a step, so that actions change at the step nearest to their time.
    played = ((np.arange(steps) + 0.5) * (dt / lasts)).astype(int)
    chosen = jnp.array(list(solution.unrolled()), int).reshape(-1, 6)
    rows = np.asarray(jax.vmap(MultiDiscreteActions().unified)(chosen), np.float32)
    idle = np.zeros((1, rows.shape[1]), np.float32)
    return np.concatenate([rows, idle])[np.minimum(played, len(rows))]


def _frozen(array: np.ndarray) -> np.ndarray:
    array = np.ascontiguousarray(array)
    array.setflags(write=False)
    return array
