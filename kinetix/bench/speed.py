"""Steps per second of the engine and of the environment on hand-made levels."""

import dataclasses
import functools
import statistics
from collections.abc import Callable, Iterator, Sequence
from pathlib import Path
from typing import Any, ClassVar, Final

import jax
import jax.numpy as jnp
from jaxtyping import Array

from kinetix.bench.timing import seconds_of, steps_per_second
from kinetix.engine.names import DEFAULT_PHYSICS
from kinetix.engine.pipeline import step as physics_step
from kinetix.engine.spec import Capacity, Features
from kinetix.environment.actions import MultiDiscreteActions
from kinetix.environment.devices import place, spread
from kinetix.environment.env import KinetixEnv, make_kinetix_env
from kinetix.environment.observations import AbstractObservation, Feature, Layout
from kinetix.environment.params import (
    EnvParams,
    StaticEnvParams,
    engine_parameters,
    physics_engine,
    static_env_params_of,
)
from kinetix.environment.reset import level_state, static_env_params_for_levels
from kinetix.environment.spaces import ActionType, Dict, ObservationType
from kinetix.environment.state import EnvState, stack_states
from kinetix.errors import KinetixError
from kinetix.level.codec import load_document
from kinetix.level.sets import level_files
from kinetix.level.sizes import parse_capacity
from kinetix.paths import levels_dir

SECONDS: Final = 0.5
"""A run is made about as long as this."""
SHORTEST_SECONDS: Final = 0.1
"""A run is no shorter than this where many levels share the time of one."""
DRAWN: Final = 16
"""Random actions a world, which are taken in turn."""


@dataclasses.dataclass(frozen=True, kw_only=True)
class NoObservation(AbstractObservation):
    """Nothing, to time the step alone."""

    name: ClassVar[str] = "none"

    @property
    def space(self) -> Dict:
        """No parts."""
        return Dict(spaces={})

    @property
    def columns(self) -> dict[str, tuple[Feature, ...]]:
        """No columns."""
        return {}

    def __call__(self, state: EnvState) -> tuple[()]:
        """Return an empty observation."""
        del state
        return ()


@dataclasses.dataclass(frozen=True, kw_only=True)
class SpeedSettings:
    """Settings of the measurement."""

    sizes: tuple[str, ...] = ("s", "m", "l")
    batches: tuple[int, ...] = (1, 64, 1024)
    physics: str = DEFAULT_PHYSICS
    observation: str = "none"
    """A kind of observation, or none."""
    levels: Path | None = None
    """Folder of levels; the bundled ones by default."""
    specialised: bool = False
    """Compile each level for itself alone, and take the median over the levels."""


@dataclasses.dataclass(frozen=True, kw_only=True)
class _Rate:
    steps_per_s: float
    compile_s: float


def measure_speed(settings: SpeedSettings) -> Iterator[dict[str, Any]]:
    """One row per size and batch.

    Each row has `size`, `batch`, `physics`, `observation`, `engine_steps_per_s` (the bare engine),
    `env_steps_per_s` (`KinetixEnv.step` with auto-reset to the same level), `compile_s` (of the
    environment's step), `devices` and `levels` (how many are timed). They are cycled over the
    batch; where it has room for fewer, all are timed batch by batch, and the median counts. Random
    actions, frame_skip 1, jitted scans, the median of at least five runs after a warm-up.

    Raises:
        KinetixError: A size has no level, or the observation is unknown.
    """
    kinds = ("none", *(kind.value for kind in ObservationType))
    if settings.observation not in kinds:
        raise KinetixError(
            f"observation {settings.observation!r}: expected one of {', '.join(kinds)}"
        )
    folder = settings.levels or levels_dir()
    found = {size: levels_of(folder, parse_capacity(size)) for size in settings.sizes}
    for size, files in found.items():
        if not files:
            raise KinetixError(f"{folder}: there is no level of size {size}")
    for size, files in found.items():
        for batch in settings.batches:
            groups = [[file] for file in files] if settings.specialised else [files]
            rates = [_rates(group, size, batch, settings) for group in groups]
            engine = statistics.median(engine.steps_per_s for engine, _ in rates)
            env = statistics.median(env.steps_per_s for _, env in rates)
            yield {
                "size": size,
                "batch": batch,
                "physics": settings.physics,
                "observation": settings.observation,
                "engine_steps_per_s": round(engine, 1),
                "env_steps_per_s": round(env, 1),
                "compile_s": round(statistics.median(env.compile_s for _, env in rates), 2),
                "devices": _devices(batch),
                "levels": len(files),
            }


def levels_of(folder: Path, capacity: Capacity) -> list[Path]:
    """The levels below a folder that have a capacity, level sets left out."""
    return [file for file in level_files(folder) if load_document(file).capacity == capacity]


def _rates(
    files: Sequence[Path], size: str, batch: int, settings: SpeedSettings
) -> tuple[_Rate, _Rate]:
    """Return the bare engine's rate and the environment's, of steps that are compiled once."""
    static = static_env_params_of(
        parse_capacity(size), physics=settings.physics, frame_skip=1, features=Features()
    )
    if settings.specialised:
        static = static_env_params_for_levels(files, static)
    states = [level_state(file, static) for file in files]
    starts = [_cycled(states[k : k + batch], batch) for k in range(0, len(states), batch)]
    actions = jax.random.split(jax.random.key(0), batch)
    return (
        _time(_engine_loop(static), starts, actions, batch),
        _time(_env_loop(static, settings.observation), starts, actions, batch),
    )


def _cycled(states: Sequence[EnvState], batch: int) -> EnvState:
    return stack_states([states[index % len(states)] for index in range(batch)])


def _engine_loop(static: StaticEnvParams) -> Callable[..., Any]:
    engine, parameters = physics_engine(static), engine_parameters(EnvParams())
    actions = MultiDiscreteActions()

    def loop(state: EnvState, keys: Array, count: Array) -> Any:
        drawn = jax.vmap(lambda key: _draw(actions, key))(keys)

        def advance(index: Array, physics: Any) -> Any:
            chosen = jax.lax.dynamic_index_in_dim(drawn, index % DRAWN, 1, keepdims=False)
            control = jax.vmap(actions.process_action)(chosen, state.labels)
            step = jax.vmap(
                lambda world, physics, control: physics_step(
                    world, physics, control, parameters, spec=engine.spec, solver=engine.solver
                )
            )
            return step(state.world, physics, control)

        return jax.lax.fori_loop(0, count[0], advance, state.physics)

    return loop


def _env_loop(static: StaticEnvParams, observation: str) -> Callable[..., Any]:
    kind = ObservationType.BLIND if observation == "none" else observation
    env = make_kinetix_env(ActionType.MULTI_DISCRETE, kind, None, EnvParams(), static)
    assert isinstance(env, KinetixEnv)
    if observation == "none":
        layout = Layout.of(env.env_params, static)
        env = dataclasses.replace(env, observations=NoObservation(layout=layout))

    def loop(state: EnvState, keys: Array, count: Array) -> Any:
        drawn = jax.vmap(lambda key: _draw(env.actions, key))(keys)

        def advance(index: Array, carry: Any) -> Any:
            current, _, _ = carry
            chosen = jax.lax.dynamic_index_in_dim(drawn, index % DRAWN, 1, keepdims=False)
            step = jax.vmap(env.step, in_axes=(0, 0, 0, None, 0))
            seen, current, reward, _, _ = step(keys, current, chosen, EnvParams(), state)
            return current, seen, reward

        first = jax.vmap(env.get_obs)(state)
        return jax.lax.fori_loop(
            0, count[0], advance, (state, first, jnp.zeros(keys.shape[0], jnp.float32))
        )

    return loop


def _draw(actions: Any, key: Array) -> Array:
    """Some random actions, so that drawing them is not what is timed."""
    return jax.vmap(actions.random_action)(jax.random.split(key, DRAWN))


def _devices(batch: int) -> int:
    """Count the devices over which a batch of this size can be spread."""
    count = jax.local_device_count()
    return count if batch % count == 0 else 1


def _time(loop: Callable[..., Any], starts: Sequence[EnvState], keys: Array, batch: int) -> _Rate:
    """Return the median rate over batches of worlds."""

    def count(steps: int) -> Array:
        return jnp.full(jax.local_device_count() if _devices(batch) > 1 else 1, steps)

    if _devices(batch) > 1:
        compiled, keys = spread(loop), place(keys)
        starts = [place(state) for state in starts]
    else:
        compiled = jax.jit(loop)

    def run(steps: int, state: EnvState) -> Any:
        return compiled(state, keys, count(steps))

    compile_s = seconds_of(functools.partial(run, state=starts[0]), 1)
    about = max(SECONDS / len(starts), min(SHORTEST_SECONDS, SECONDS))
    rates = [steps_per_second(functools.partial(run, state=each), about=about) for each in starts]
    return _Rate(steps_per_s=batch * statistics.median(rates), compile_s=compile_s)
