"""Random levels and mutations as documents: what the editor and the command line ask for."""

import dataclasses
import functools
from collections.abc import Callable, Iterator
from typing import Any, Final

import jax
import jax.numpy as jnp
import numpy as np
from jaxtyping import Array

from kinetix.engine.presets import solver_named
from kinetix.engine.spec import ARENA_BODIES, Capacity, SceneSpec
from kinetix.environment.generators.draft import states
from kinetix.environment.generators.edits import mutate_state
from kinetix.environment.generators.locomotion import LocomotionParams, draw_locomotion
from kinetix.environment.generators.params import UEDParams
from kinetix.environment.generators.sample import draw_levels
from kinetix.environment.params import EnvParams, PhysicsEngine
from kinetix.environment.state import EnvState, state_of
from kinetix.level.compile import Scene, compile_level
from kinetix.level.decompile import level_from_scene
from kinetix.level.model import Body, BodyReference, InertiaModel, Joint, Level, Thruster
from kinetix.level.sizes import SIZES, capacity_of, size_name
from kinetix.level.slots import body_slots

_BATCH: Final = 64
"""Levels that are drawn at once for the command line."""
_CREATURES: Final = "locomotion"
_LARGEST_SEED: Final = 2**32


def random_level(seed: int, size: str | Capacity) -> Level:
    """Return a random level as a document; the same seed gives the same level.

    Args:
        seed: Any integer.
        size: A named size (`s`, `m`, `l`, `locomotion`) or a capacity.
    """
    return next(random_levels(seed, size, 1))


def random_levels(seed: int, size: str | Capacity, count: int) -> Iterator[Level]:
    """Random levels as documents: level k depends on the seed and on k alone.

    Args:
        seed: Any integer.
        size: A named size (`s`, `m`, `l`, `locomotion`) or a capacity; creatures are drawn for the
            name `locomotion` alone.
        count: How many.
    """
    capacity = SIZES[size] if isinstance(size, str) else size
    creatures = size == _CREATURES
    label = size if isinstance(size, str) else _label(size)
    first = jax.random.key(seed % _LARGEST_SEED)
    batch = 1 if count == 1 else _BATCH
    draw = _drawer(capacity, creatures)
    for start in range(0, count, batch):
        numbers = jnp.arange(start, start + batch)
        drawn = draw(jax.vmap(functools.partial(jax.random.fold_in, first))(numbers))
        drawn = jax.tree.map(np.asarray, drawn)
        for row in range(min(batch, count - start)):
            one = jax.tree.map(lambda leaf, row=row: leaf[row], drawn)
            yield random_document(one, f"Random {label} {seed}-{start + row}")


def _label(capacity: Capacity) -> str:
    """Return the name of the size that has this capacity, `custom` where none but creatures has."""
    name = size_name(capacity)
    return "custom" if name is None or name == _CREATURES else name


@functools.cache
def _drawer(capacity: Capacity, locomotion: bool) -> Callable[[Array], EnvState]:
    engine = PhysicsEngine(spec=SceneSpec(capacity=capacity), solver=solver_named("jax2d"))

    @jax.jit
    def draw(keys: Array) -> EnvState:
        raw = jax.random.key_data(keys)
        ued = UEDParams()
        draft = (
            draw_locomotion(raw, capacity, LocomotionParams())
            if locomotion
            else draw_levels(raw, capacity, ued)
        )
        return states(draft, engine, ued.inertia_model)

    return draw


def random_document(state: EnvState, name: str, inertia_model: InertiaModel = "kinetix") -> Level:
    """Return a random level, drawn as a state, as a document.

    Args:
        state: Of one level; its motion becomes the initial one.
        name: Name of the new level.
        inertia_model: By which the state's masses were made.
    """
    limit = np.int32(EnvParams().max_timesteps)
    scene = Scene(
        world=state.world,
        state=state.physics,
        labels=dataclasses.replace(state.labels, max_timesteps=limit),
    )
    return level_from_scene(scene, name=name, inertia_model=inertia_model, tags=("random",))


def mutate_level(level: Level, mutation_name: str, seed: int) -> Level:
    """Return a document with one mutation; the document itself where nothing came of it.

    What the mutation does not touch keeps its ids and numbers; a recorded solution is dropped,
    because it may not win any more. New entities need room in the level's size.

    Args:
        level: The document.
        mutation_name: Its name.
        seed: Any integer.

    Raises:
        KinetixError: No mutation has this name.
        LevelError: The level does not fit its own size.
    """
    capacity = capacity_of(level)
    engine = PhysicsEngine(spec=SceneSpec(capacity=capacity), solver=solver_named("jax2d"))
    scene = compile_level(level, spec=engine.spec, solver=engine.solver)
    mutate = _mutator(mutation_name, UEDParams(inertia_model=level.inertia_model))
    key = jax.random.key(seed % _LARGEST_SEED)
    after = jax.tree.map(np.asarray, mutate(key, state_of(scene)))
    mutated = Scene(world=after.world, state=after.physics, labels=after.labels)
    return _merged(level, scene, mutated, body_slots(level, capacity))


@functools.cache
def _mutator(name: str, ued: UEDParams) -> Callable[[Array, EnvState], EnvState]:
    return jax.jit(lambda key, state: mutate_state(key, state, name, ued))


def _merged(level: Level, before: Scene, after: Scene, slots: dict[Any, int]) -> Level:
    """Return the level with what differs between two compiled forms of it."""
    old = _by_slot(
        level_from_scene(before, name=level.name, inertia_model=level.inertia_model), before
    )
    fresh = level_from_scene(after, name=level.name, inertia_model=level.inertia_model)
    new = _by_slot(fresh, after)
    own = {
        "bodies": {slots[body.id]: body for body in level.bodies},
        "joints": dict(enumerate(level.joints)),
        "thrusters": dict(enumerate(level.thrusters)),
    }
    next_id = level.next_id
    ids: dict[int, int] = {}
    for kind, entities in new.items():
        for slot, entity in entities.items():
            if slot in own[kind]:
                ids[entity.id] = own[kind][slot].id
            else:
                ids[entity.id] = next_id
                next_id += 1
    old_ids = {entity.id: own[kind][slot].id for kind in old for slot, entity in old[kind].items()}
    merged: dict[str, list[Any]] = {}
    for kind, entities in new.items():
        result = {}
        for slot, entity in entities.items():
            renamed = _renamed(entity, ids)
            kept = slot in old[kind] and _renamed(old[kind][slot], old_ids) == renamed
            if slot in own[kind]:
                # Scenes have no names.
                renamed = renamed.replace(name=own[kind][slot].name)
            result[slot] = own[kind][slot] if kept else renamed
        listed = [slot for slot in own[kind] if slot in result]
        added = [slot for slot in result if slot not in own[kind]]
        merged[kind] = [result[slot] for slot in listed + added]
    changed = level.replace(
        gravity=fresh.gravity,
        next_id=next_id,
        **{kind: tuple(entities) for kind, entities in merged.items()},
    )
    return level if changed == level else changed.replace(solution=None)


def _by_slot(document: Level, scene: Scene) -> dict[str, dict[int, Any]]:
    """Return the entities of a document by the slots that they were read from."""
    active = {
        "bodies": np.flatnonzero(scene.world.bodies.active)[ARENA_BODIES:],
        "joints": np.flatnonzero(scene.world.joints.active),
        "thrusters": np.flatnonzero(scene.world.thrusters.active),
    }
    return {
        kind: dict(zip(rows.tolist(), getattr(document, kind), strict=True))
        for kind, rows in active.items()
    }


def _renamed(entity: Body | Joint | Thruster, ids: dict[int, int]) -> Body | Joint | Thruster:
    """Return the entity under other ids."""

    def name(reference: BodyReference) -> BodyReference:
        return ids[reference] if isinstance(reference, int) else reference

    if isinstance(entity, Joint):
        return entity.replace(id=ids[entity.id], a=name(entity.a), b=name(entity.b))
    if isinstance(entity, Thruster):
        return entity.replace(id=ids[entity.id], body=ids[entity.body])
    return entity.replace(id=ids[entity.id])
