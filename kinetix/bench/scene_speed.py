"""Steps per second of our engine in the suite's own scenes: the chart's other axis."""

import dataclasses
import functools
from collections.abc import Callable, Iterator, Sequence
from typing import Any, Final

import jax
import jax.numpy as jnp
import numpy as np
from jaxtyping import Array

from kinetix.bench.runner import compiled_trials
from kinetix.bench.timing import seconds_of, steps_per_second
from kinetix.engine.pipeline import step
from kinetix.engine.solvers.base import AbstractSolver
from kinetix.environment.devices import place, spread
from kinetix.scenes import SCENES, Trial

SECONDS: Final = 0.25
"""A run is made about as long as this."""
SPEED_SCENES: Final = {
    "integrator": ("I2", 0),
    "impacts": ("B6", 0),
    "friction": ("F1", 0),
    "joints": ("D5", 4),
    "contacts": ("S1", 1),
    "built": ("U2", 9),
}
"""The scene of a class in which engines are timed, and which of its trials: a projectile, eight
discs in a box, a sliding box, a chain of five links with a load of 100, a stack of ten boxes, a
pyramid of ten."""


@dataclasses.dataclass(frozen=True, kw_only=True)
class Rate:
    """Speed of an engine."""

    steps_per_s: float
    """Steps per second of all worlds together."""
    compile_s: float | None
    """Tracing, compiling and the first steps; None where that is not measured."""
    devices: int


def speed_trial(group: str) -> Trial:
    """Return the trial on which engines are timed for a class.

    Raises:
        KeyError: The class has no scene of its own for this.
    """
    scene, trial = SPEED_SCENES[group]
    return SCENES[scene].make_trials()[trial]


def scene_speed(trial: Trial, solver: AbstractSolver, batch: int) -> Rate:
    """Time a method on so many copies of a trial, compiled for that scene alone.

    The copies are spread over all devices where their number allows it.
    """
    spec, (world, control, parameters), state = compiled_trials([trial], solver)
    repeated = functools.partial(_repeated, batch=batch)
    given = repeated((world, control, parameters)), repeated(state)
    advance = jax.vmap(functools.partial(step, spec=spec, solver=solver))

    def loop(given: Any, count: Array) -> Any:
        (world, control, parameters), state = given
        return jax.lax.fori_loop(
            0, count[0], lambda _, state: advance(world, state, control, parameters), state
        )

    devices = jax.local_device_count() if batch % jax.local_device_count() == 0 else 1
    if devices > 1:
        return _timed(spread(loop), place(given), batch, devices)
    return _timed(jax.jit(loop), given, batch, 1)


def _repeated(tree: Any, *, batch: int) -> Any:
    return jax.tree.map(lambda x: jnp.asarray(np.repeat(np.asarray(x), batch, axis=0)), tree)


def _timed(run: Callable[..., Any], given: Any, batch: int, devices: int) -> Rate:
    def steps(count: int) -> Any:
        return run(given, jnp.full(devices, count))

    compile_s = seconds_of(steps, 16)
    rate = batch * steps_per_second(steps, about=SECONDS)
    return Rate(steps_per_s=rate, compile_s=compile_s, devices=devices)


def measure_scenes(
    batches: Sequence[int], measure: Callable[[Trial, int], Rate | None]
) -> Iterator[dict[str, Any]]:
    """A row for every class and batch: `class`, `scene`, `batch` and the fields of `Rate`.

    Args:
        batches: Worlds stepped at once.
        measure: Times an engine on a trial; None where it cannot represent the scene.
    """
    for group, (scene, _) in SPEED_SCENES.items():
        for batch in batches:
            rate = measure(speed_trial(group), batch)
            if rate is not None:
                head = {"class": group, "scene": scene, "batch": batch}
                yield head | dataclasses.asdict(rate)
