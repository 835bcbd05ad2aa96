"""R5: thousands of random levels under random actions, and what goes wrong in them."""

import dataclasses
from typing import Any, Final

import jax
import jax.numpy as jnp
import numpy as np
from jaxtyping import Array

from kinetix.bench.judges.base import Metric
from kinetix.bench.motion import most_apart, outside, turned
from kinetix.engine.pairs import candidate_pairs, may_push
from kinetix.engine.pipeline import step
from kinetix.engine.spec import Capacity
from kinetix.engine.types import State, World
from kinetix.environment.actions import MultiDiscreteActions
from kinetix.environment.generators.params import UEDParams
from kinetix.environment.generators.sample import level_sampler
from kinetix.environment.params import (
    EnvParams,
    PhysicsEngine,
    engine_parameters,
    physics_engine,
    static_env_params_from_size,
)
from kinetix.environment.state import EnvState

SAMPLED: Final = 8
"""Overlaps and joint gaps are measured at every n-th step."""
JUMP: Final = 10.0
"""Kinetic energy that no step should add [J]."""


@dataclasses.dataclass(frozen=True, kw_only=True)
class WildSettings:
    """Settings of the measurement."""

    physics: str
    worlds: int = 4096
    steps: int = 256
    sizes: tuple[str, ...] = ("s", "m", "l")
    """The worlds are shared out among these."""
    seed: int = 0


def measure_wild(settings: WildSettings) -> list[Metric]:
    """Shares and percentiles over the worlds of all sizes."""
    parts = [_run_size(settings, index) for index in range(len(settings.sizes))]
    broken, gap, depth, jumps, overflow = (
        np.concatenate([part[k] for part in parts]) for k in range(5)
    )
    return [
        Metric(name="not finite", unit="1", value=float(broken.mean()), good=0.0, fail=0.0),
        _percentile("joint gap", gap, 99, 0.01, 0.1),
        _percentile("penetration", depth, 99, 0.01, 0.05),
        _percentile("joint gap", gap, 50),
        _percentile("penetration", depth, 50),
        Metric(name="jumps of energy per world", unit="1", value=float(jumps.mean())),
        Metric(name="worlds without room for all contacts", unit="1", value=float(overflow.mean())),
    ]


def _percentile(
    name: str, values: np.ndarray, share: int, good: float | None = None, fail: float | None = None
) -> Metric:
    value = float(np.percentile(np.nan_to_num(values, nan=np.inf), share, method="lower"))
    return Metric(
        name=name,
        unit="m",
        value=value if np.isfinite(value) else None,
        good=good,
        fail=fail,
        variant=f"p{share}",
    )


def _run_size(settings: WildSettings, index: int) -> tuple[np.ndarray, ...]:
    """Per world: broken, joint gap [m], penetration [m], jumps of energy, overflow."""
    static = static_env_params_from_size(settings.sizes[index], physics=settings.physics)
    engine = physics_engine(static)
    worlds = len(range(index, settings.worlds, len(settings.sizes)))
    keys = jax.random.split(jax.random.fold_in(jax.random.key(settings.seed), index), worlds)
    start = jax.jit(jax.vmap(level_sampler(engine, UEDParams())))(keys)
    frames, broken, jumps, overflow = jax.jit(_rollout, static_argnums=(2, 3))(
        start, keys, engine, settings.steps // SAMPLED
    )
    world = jax.tree.map(np.asarray, start.world)
    position, rotation = (np.asarray(x, np.float64) for x in frames)
    gap = _joint_gap(world, position, rotation)
    # Random levels may start with overlaps; as everywhere in the suite the last half counts.
    half = len(position) // 2
    depth = _penetration(world, position[half:], rotation[half:], engine.spec.capacity)
    return np.asarray(broken), gap, depth, np.asarray(jumps), np.asarray(overflow)


def _rollout(
    start: EnvState, keys: Array, engine: PhysicsEngine, frames: int
) -> tuple[Any, Array, Array, Array]:
    """Poses (frame, world, body, …) and, per world: broken, jumps of energy, overflow."""
    parameters, actions = engine_parameters(EnvParams()), MultiDiscreteActions()
    world = start.world

    def advance(world: World, state: State, control: Any) -> State:
        return step(world, state, control, parameters, spec=engine.spec, solver=engine.solver)

    def once(carry: Any, moment: Array) -> tuple[Any, None]:
        state, energy, broken, jumps, overflow = carry
        drawn = jax.vmap(lambda key: actions.random_action(jax.random.fold_in(key, moment)))(keys)
        control = jax.vmap(actions.process_action)(drawn, start.labels)
        state = jax.vmap(advance)(world, state, control)
        now = _kinetic_energy(world, state)
        broken |= ~jnp.isfinite(now) | ~jnp.isfinite(state.position).all(axis=(1, 2))
        jumps += now > energy + JUMP
        return (state, now, broken, jumps, overflow | state.overflow), None

    def frame(carry: Any, number: Array) -> tuple[Any, Any]:
        carry, _ = jax.lax.scan(once, carry, number * SAMPLED + jnp.arange(SAMPLED))
        return carry, (carry[0].position, carry[0].rotation)

    none = jnp.zeros(len(keys), bool)
    first = (
        start.physics,
        _kinetic_energy(world, start.physics),
        none,
        jnp.zeros(len(keys), jnp.int32),
        none,
    )
    (_, _, broken, jumps, overflow), poses = jax.lax.scan(frame, first, jnp.arange(frames))
    return poses, broken, jumps, overflow


def _kinetic_energy(world: World, state: State) -> Array:
    def energy(inverse: Array, squared: Array) -> Array:
        counts = (inverse > 0) & world.bodies.active
        return jnp.where(counts, squared / jnp.where(counts, inverse, 1), 0).sum(axis=1) / 2

    return energy(world.bodies.inverse_mass, (state.velocity**2).sum(-1)) + energy(
        world.bodies.inverse_inertia, state.angular_velocity**2
    )


def _joint_gap(world: World, position: np.ndarray, rotation: np.ndarray) -> np.ndarray:
    """Return the largest gap of any joint at any frame, per world [m]."""
    joints = world.joints
    rows = np.arange(position.shape[1])[:, None]

    def end(body: np.ndarray, anchor: np.ndarray) -> np.ndarray:
        return position[:, rows, body] + turned(rotation[:, rows, body], anchor)

    ends = (
        end(np.asarray(joints.body_a), np.asarray(joints.anchor_a)),
        end(np.asarray(joints.body_b), np.asarray(joints.anchor_b)),
    )
    gap = np.linalg.norm(ends[1] - ends[0], axis=-1)
    # A joint between two fixed bodies is never solved.
    inverse = np.asarray(world.bodies.inverse_mass)
    free = inverse[rows, joints.body_a] + inverse[rows, joints.body_b] > 0
    return np.where(np.asarray(joints.active) & free, gap, 0).max(axis=(0, 2), initial=0)


def _penetration(
    world: World, position: np.ndarray, rotation: np.ndarray, capacity: Capacity
) -> np.ndarray:
    """Deepest overlap of bodies that push each other at any of the frames, per world [m]."""
    bodies = world.bodies
    mode, active = np.asarray(bodies.collision_mode), np.asarray(bodies.active)
    free = np.asarray(bodies.inverse_mass) > 0
    # The engine's corners run clockwise, the plane geometry here counter-clockwise.
    local = np.asarray(bodies.vertices)[:, :, ::-1]
    radius = np.asarray(bodies.radius)
    deepest = np.zeros(position.shape[1])
    for a, b in candidate_pairs(capacity).tolist():
        meet = may_push(mode[:, a], mode[:, b])
        meet &= active[:, a] & active[:, b] & (free[:, a] | free[:, b])
        meet &= np.asarray(world.collides)[:, a, b]
        chosen = np.flatnonzero(meet)
        if len(chosen) == 0:
            continue
        frames = len(position)

        def corners(body: int, chosen: np.ndarray = chosen, frames: int = frames) -> np.ndarray:
            shape = turned(rotation[:, chosen, body, None], local[chosen, body][None])
            return (position[:, chosen, body, None] + shape).reshape(frames * len(chosen), -1, 2)

        if b >= capacity.polygons:
            apart = np.linalg.norm(position[:, chosen, a] - position[:, chosen, b], axis=-1)
            apart -= radius[chosen, a - capacity.polygons] + radius[chosen, b - capacity.polygons]
        elif a >= capacity.polygons:
            centres = position[:, chosen, a].reshape(-1, 2)
            apart = outside(corners(b), centres).reshape(frames, -1)
            apart -= radius[chosen, a - capacity.polygons]
        else:
            first, second = corners(a), corners(b)
            apart = np.maximum(most_apart(first, second), most_apart(second, first))
            apart = apart.reshape(frames, -1)
        deepest[chosen] = np.maximum(deepest[chosen], -apart.min(axis=0))
    return deepest


__all__ = ["WildSettings", "measure_wild"]
