"""Mutations of environment states: one by name, or the random series of the ACCEL curriculum."""

import dataclasses
import functools
from collections.abc import Callable
from typing import Any, Final

import jax
import jax.numpy as jnp
from jaxtyping import Array, Bool, Key

from kinetix.engine.batch import worlds_first
from kinetix.engine.pipeline import step
from kinetix.engine.presets import solver_named
from kinetix.engine.spec import ARENA_BODIES, Capacity, Features, SceneSpec
from kinetix.engine.types import Control, default_parameters
from kinetix.environment.generators.draft import Draft, components, draft_of, states
from kinetix.environment.generators.draws import Tape, choose, raw_keys
from kinetix.environment.generators.mutators import MUTATORS, NUMBERS, SETTLED
from kinetix.environment.generators.params import UEDParams
from kinetix.environment.params import PhysicsEngine
from kinetix.environment.state import EnvState
from kinetix.errors import KinetixError
from kinetix.level.features import capacity_of_world

SETTLING_STEPS: Final = 5
"""Physics steps that put jointed bodies together again."""
SETTLING_PHYSICS: Final = "jax2d"
"""kinetix-env's engine: what "together again" means is part of the distribution."""

ACCEL_WEIGHTS: Final[dict[str, float]] = {
    "add_shape": 1.0,
    "add_connected_shape": 1.0,
    "swap_role": 1.0,
    "add_thruster": 1.0,
    "remove_thruster": 1.0,
    "toggle_fixture": 0.1,
    "change_size": 1.0,
    "change_location": 1.0,
    "change_rotation": 1.0,
}
"""Weight of each mutation in the ACCEL edit, where there is room for it."""


def mutate_state(
    key: Key[Array, ""],
    state: EnvState,
    name: str,
    ued_params: UEDParams | None = None,
    **forced: bool,
) -> EnvState:
    """Return a level with one mutation; the same level where the mutation finds nothing to act on.

    Args:
        key: Random key.
        state: The level, at the start of an episode; `vmap` for many.
        name: One of `MUTATORS`.
        ued_params: The options; None for the defaults.
        **forced: `force_no_fixate` of `add_shape`: the body can move; `force_rjoint` of
            `add_connected_shape`: the joint is a hinge.

    Raises:
        KinetixError: No mutation has this name.
    """
    if name not in MUTATORS:
        raise KinetixError(f"unknown mutation {name!r}: expected one of {', '.join(MUTATORS)}")
    ued = ued_params or UEDParams()
    only = tuple(option for option, value in forced.items() if value)
    return _mutation(name, ued, capacity_of_world(state.world), only)(raw_keys(key), state)


def accel_edit(
    key: Key[Array, ""],
    state: EnvState,
    num_edits: int,
    ued_params: UEDParams | None = None,
) -> EnvState:
    """Return a level with a series of random mutations, drawn by `ACCEL_WEIGHTS`.

    Args:
        key: Random key.
        state: The level, at the start of an episode; `vmap` for many.
        num_edits: How many mutations are made in a row.
        ued_params: The options; None for the defaults.
    """
    ued = ued_params or UEDParams()
    return _series(num_edits, ued, capacity_of_world(state.world))(raw_keys(key), state)


@functools.cache
def _mutation(
    name: str, ued: UEDParams, capacity: Capacity, forced: tuple[str, ...]
) -> Callable[[Array, EnvState], EnvState]:
    def batched(keys: Array, state: EnvState) -> EnvState:
        numbers = Tape(keys, NUMBERS).take(NUMBERS)
        everywhere = jnp.ones((keys.shape[0],), bool)
        before = draft_of(state)
        change: Callable[..., Draft] = MUTATORS[name]
        options = dict.fromkeys(forced, True)
        draft = change(before, numbers, everywhere, ued, capacity, **options)
        if name in SETTLED:
            draft = settled(before, draft, everywhere, capacity, ued)
        return _rebuilt(state, before, draft, capacity, ued)

    return worlds_first(batched)


@functools.cache
def _series(
    num_edits: int, ued: UEDParams, capacity: Capacity
) -> Callable[[Array, EnvState], EnvState]:
    def batched(keys: Array, state: EnvState) -> EnvState:
        rows = Tape(keys, num_edits * (NUMBERS + 1)).take(num_edits, NUMBERS + 1)

        def edit(old: Draft, numbers: Array) -> tuple[Draft, None]:
            draft, drawn = old, choose(numbers[NUMBERS], _weights(old))
            for index, name in enumerate(ACCEL_WEIGHTS):
                draft = MUTATORS[name](draft, numbers[:NUMBERS], drawn == index, ued, capacity)
            loose = [drawn == index for index, name in enumerate(ACCEL_WEIGHTS) if name in SETTLED]
            marked = functools.reduce(jnp.logical_or, loose)
            return settled(old, draft, marked, capacity, ued), None

        before = draft_of(state)
        draft, _ = jax.lax.scan(edit, before, rows)
        return _rebuilt(state, before, draft, capacity, ued)

    return worlds_first(batched)


def _weights(draft: Draft) -> Array:
    """Return weights of the ACCEL mutations, 0 where there is no room or nothing to take away."""
    body = jnp.any(~draft.figures.active[ARENA_BODIES:], axis=0)
    possible = {
        "add_shape": body,
        "add_connected_shape": body & jnp.any(~draft.joints.active, axis=0),
        "add_thruster": jnp.any(~draft.thrusters.active, axis=0),
        "remove_thruster": jnp.any(draft.thrusters.active, axis=0),
    }
    always = jnp.ones_like(body)
    return jnp.stack(
        [
            jnp.where(possible.get(name, always), weight, 0.0)
            for name, weight in ACCEL_WEIGHTS.items()
        ]
    )


def settled(
    before: Draft, draft: Draft, marked: Bool[Array, " n"], capacity: Capacity, ued: UEDParams
) -> Draft:
    """Put jointed bodies together again in the marked worlds.

    A few physics steps without gravity, collisions and controls, from rest each time. Bodies keep
    their velocities; with `kinetix_quirks` the changed ones and all that is jointed to them rest.

    Args:
        before: The levels before the mutation.
        draft: The levels after it.
        marked: Which of them are put together.
        capacity: Sizes of both.
        ued: The options.
    """
    # No pair can push: what is not listed is not even compiled.
    spec = SceneSpec(capacity=capacity, features=Features(pairs=()))
    engine = PhysicsEngine(spec=spec, solver=solver_named(SETTLING_PHYSICS))
    start = states(draft, engine, ued.inertia_model)
    world = dataclasses.replace(
        start.world,
        gravity=jnp.zeros_like(start.world.gravity),
        collides=jnp.zeros_like(start.world.collides),
    )
    worlds = marked.shape[0]
    control = Control(
        motor=jnp.zeros((worlds, capacity.joints)),
        thruster=jnp.zeros((worlds, capacity.thrusters)),
    )
    advance = functools.partial(
        step, parameters=default_parameters(), spec=engine.spec, solver=engine.solver
    )

    def at_rest(physics: Any) -> Any:
        return dataclasses.replace(
            physics,
            velocity=jnp.zeros_like(physics.velocity),
            angular_velocity=jnp.zeros_like(physics.angular_velocity),
        )

    def once(_: Any, physics: Any) -> Any:
        return at_rest(jax.vmap(advance)(world, physics, control))

    physics = jax.lax.fori_loop(0, SETTLING_STEPS, once, at_rest(start.physics))
    position = jnp.moveaxis(physics.position, 0, -1)
    rotation = jnp.moveaxis(physics.rotation, 0, -1)
    figures, velocity, spin = draft.figures, draft.velocity, draft.angular_velocity
    if ued.kinetix_quirks:
        resting = marked[None] & _with_jointed(_differing(before, draft), draft, capacity)
        velocity = jnp.where(resting[:, None], 0.0, velocity)
        spin = jnp.where(resting, 0.0, spin)
    return dataclasses.replace(
        draft,
        figures=dataclasses.replace(
            figures,
            position=jnp.where(marked[None, None], position, figures.position),
            rotation=jnp.where(marked[None], rotation, figures.rotation),
        ),
        velocity=velocity,
        angular_velocity=spin,
    )


def _differing(before: Draft, after: Draft) -> Bool[Array, "b n"]:
    """Return bodies of another shape or angle."""
    old, new = before.figures, after.figures
    return ~_same_bodies(before, after) | (old.rotation != new.rotation)


def _with_jointed(
    bodies: Bool[Array, "b n"], draft: Draft, capacity: Capacity
) -> Bool[Array, "b n"]:
    """These bodies and all that are jointed to them, directly or through others."""
    label = components(draft.joints, capacity.bodies)
    return jnp.any((label[:, None] == label[None]) & bodies[None], axis=1)


def _rebuilt(
    state: EnvState, before: Draft, after: Draft, capacity: Capacity, ued: UEDParams
) -> EnvState:
    """The mutated state: what no mutation touched stays as it was, stored masses included."""
    engine = PhysicsEngine(spec=SceneSpec(capacity=capacity), solver=solver_named(SETTLING_PHYSICS))
    new = states(after, engine, ued.inertia_model)
    same = jnp.moveaxis(_same_bodies(before, after), -1, 0)
    bodies = dataclasses.replace(
        new.world.bodies,
        inverse_mass=jnp.where(
            same, state.world.bodies.inverse_mass, new.world.bodies.inverse_mass
        ),
        inverse_inertia=jnp.where(
            same, state.world.bodies.inverse_inertia, new.world.bodies.inverse_inertia
        ),
    )
    return dataclasses.replace(
        new,
        world=dataclasses.replace(new.world, bodies=bodies),
        physics=dataclasses.replace(
            new.physics, cache=jax.tree.map(jnp.zeros_like, state.physics.cache)
        ),
        labels=dataclasses.replace(new.labels, max_timesteps=state.labels.max_timesteps),
    )


def _same_bodies(before: Draft, after: Draft) -> Bool[Array, "b n"]:
    """Return bodies whose mass has no reason to change."""
    old, new = before.figures, after.figures
    same = jnp.all(old.vertices == new.vertices, axis=(1, 2)) & (old.radius == new.radius)
    same = same & (old.density == new.density)
    return same & (old.fixed == new.fixed) & (old.active == new.active)
