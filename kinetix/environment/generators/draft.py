"""A whole level under construction, and how it becomes the environment's state and back.

A `Draft` lists bodies by slot (polygons, the arena first, then circles), worlds on the last axis.
It has the data of a level and nothing derived: masses, the collision filter and the engine's empty
memory come in `states`.
"""

import dataclasses
import functools
from typing import Any

import jax
import jax.numpy as jnp
import numpy as np
from jaxtyping import Array, Bool, Float, Int

from kinetix.engine.pairs import candidate_pairs
from kinetix.engine.pipeline import empty_cache
from kinetix.engine.presets import solver_named
from kinetix.engine.spec import ARENA_BODIES, Capacity, SceneSpec
from kinetix.engine.types import Bodies, Joints, State, Thrusters, World
from kinetix.environment.generators.figures import VERTICES, Figures, inertia, mass, pick
from kinetix.environment.params import PhysicsEngine
from kinetix.environment.state import NO_DISTANCE, EnvState, state_of
from kinetix.level.compile import Labels, compile_level
from kinetix.level.limits import FARTHEST
from kinetix.level.model import InertiaModel, Level
from kinetix.pytree import pytree

LEGACY_CEILING_CORNER = (5.0, 5.2)
"""First corner of the ceiling in kinetix-env's generated levels [m, its frame]."""


@pytree
class Draft:
    """Levels by slot, worlds last; joints and thrusters as in the engine."""

    figures: Figures
    velocity: Float[Array, "b 2 n"]
    angular_velocity: Float[Array, "b n"]
    friction: Float[Array, "b n"]
    restitution: Float[Array, "b n"]
    collision_mode: Int[Array, "b n"]
    joints: Joints
    motor_binding: Int[Array, "j n"]
    motor_auto: Bool[Array, "j n"]
    thrusters: Thrusters
    thruster_binding: Int[Array, "t n"]
    gravity: Float[Array, "2 n"]


_OF_BODIES = (
    "figures",
    "velocity",
    "angular_velocity",
    "friction",
    "restitution",
    "collision_mode",
)
_OF_JOINTS = ["joints", "motor_binding", "motor_auto"]
_OF_THRUSTERS = ["thrusters", "thruster_binding"]


@functools.cache
def _empty_draft(capacity: Capacity, legacy_ceiling: bool) -> Draft:
    """Return one world, as numpy arrays: compiled programs hold them as constants."""
    solver = solver_named("jax2d")
    scene = compile_level(Level(name=""), spec=SceneSpec(capacity=capacity), solver=solver)
    with jax.ensure_compile_time_eval():
        state = jax.tree.map(lambda leaf: np.asarray(leaf)[None], state_of(scene))
        draft = jax.tree.map(np.array, jax.jit(draft_of)(state))
    if legacy_ceiling:
        draft.figures.vertices[ARENA_BODIES - 1, 0] = np.array(LEGACY_CEILING_CORNER)[:, None]
    return draft


def empty_draft(worlds: int, capacity: Capacity, *, legacy_ceiling: bool = False) -> Draft:
    """Return levels with nothing but the arena."""
    return jax.tree.map(
        lambda leaf: jnp.broadcast_to(leaf, (*leaf.shape[:-1], worlds)),
        _empty_draft(capacity, legacy_ceiling),
    )


def components(joints: Joints, bodies: int) -> Int[Array, "b n"]:
    """Return a number per body that is the same within a jointed component, and only there."""
    worlds = joints.active.shape[-1]
    labels = jnp.broadcast_to(jnp.arange(bodies, dtype=jnp.int32)[:, None], (bodies, worlds))
    for joint in range(joints.active.shape[0]):
        kept = pick(labels, joints.body_a[joint])
        gone = pick(labels, joints.body_b[joint])
        merge = joints.active[joint][None] & (labels == gone[None])
        labels = jnp.where(merge, kept[None], labels)
    return labels


def spread(marks: Bool[Array, "b n"], like: Array) -> Array:
    """Return marks over rows with as many axes as `like`, worlds last."""
    return marks.reshape(marks.shape[0], *(1,) * (like.ndim - 2), marks.shape[1])


def hit(rows: Array, index: Int[Array, " n"], marked: Bool[Array, " n"]) -> Bool[Array, "b n"]:
    """Mark the row with this index in each marked world."""
    numbers = jnp.arange(rows.shape[0], dtype=jnp.int32)[:, None]
    return (numbers == index[None]) & marked[None]


def put(rows: Any, new: Any, index: Int[Array, " n"], marked: Bool[Array, " n"]) -> Any:
    """Return rows (a pytree) with one new row in each marked world."""

    def write(old: Array, fresh: Array) -> Array:
        if old.shape[0] == 0:
            return old
        return jnp.where(spread(hit(old, index, marked), old), fresh[None], old)

    return jax.tree.map(write, rows, new)


def first_free(taken: Bool[Array, "k n"]) -> Int[Array, " n"]:
    """Return the first row that is not taken; meaningless where all are."""
    # Row by row: XLA does not vectorise `argmin` over the worlds.
    row, full = jnp.zeros(taken.shape[1:], jnp.int32), jnp.ones(taken.shape[1:], bool)
    for one in taken[:-1]:
        full = full & one
        row = row + full.astype(jnp.int32)
    return row


def free_slot(figures: Figures, circle: Bool[Array, " n"], capacity: Capacity) -> Int[Array, " n"]:
    """Return the lowest slot without a body, among circles or among polygons."""
    polygon = first_free(figures.active[: capacity.polygons])
    return jnp.where(
        circle, capacity.polygons + first_free(figures.active[capacity.polygons :]), polygon
    )


def with_joint(
    draft: Draft, joint: Joints, binding: Int[Array, " n"], marked: Bool[Array, " n"]
) -> Draft:
    """Add an active joint, whose motor actions drive, in the marked worlds' lowest free slot."""
    old = (draft.joints, draft.motor_binding, draft.motor_auto)
    new = (joint, binding, jnp.zeros_like(joint.active))
    slot = first_free(draft.joints.active)
    joints, bindings, automatic = put(old, new, slot, marked & joint.active)
    return dataclasses.replace(draft, joints=joints, motor_binding=bindings, motor_auto=automatic)


def joint_counts(joints: Joints, bodies: int) -> Int[Array, "b n"]:
    """Count the active joints on each body."""
    rows = jnp.arange(bodies, dtype=jnp.int32)[:, None, None]
    ends = (rows == joints.body_a[None]) | (rows == joints.body_b[None])
    return jnp.sum((ends & joints.active[None]).astype(jnp.int32), axis=1)


def permutation(u: Float[Array, "k n"]) -> Int[Array, "k n"]:
    """Return a uniform permutation: the rank of each number among the numbers of its world."""
    count = u.shape[0]
    earlier = (jnp.arange(count)[:, None] < jnp.arange(count)[None, :])[:, :, None]
    below = (u[:, None] < u[None, :]) | ((u[:, None] == u[None, :]) & earlier)
    return jnp.sum(below.astype(jnp.int32), axis=0)


def shuffle_length(capacity: Capacity) -> int:
    """Count the uniform numbers that `shuffled` uses."""
    return capacity.bodies - ARENA_BODIES + capacity.joints + capacity.thrusters


def shuffled(draft: Draft, u: Float[Array, "k n"], capacity: Capacity, slots: Capacity) -> Draft:
    """Permute polygons (the arena stays), circles, joints and thrusters independently.

    Args:
        draft: The levels.
        u: `shuffle_length(capacity)` uniform numbers.
        capacity: Sizes of the draft.
        slots: Sizes of the result, at least as large; the further slots of a kind stay empty.
    """
    kinds = (
        capacity.polygons - ARENA_BODIES, capacity.circles, capacity.joints, capacity.thrusters
    )  # fmt: skip
    polygons, circles, joints, thrusters = map(permutation, jnp.split(u, np.cumsum(kinds)[:-1]))
    arena = jnp.broadcast_to(jnp.arange(ARENA_BODIES)[:, None], (ARENA_BODIES, u.shape[1]))
    slot_of = jnp.concatenate([arena, ARENA_BODIES + polygons, slots.polygons + circles])
    blank = empty_draft(1, slots)
    moved = {}
    for names, places in ((_OF_BODIES, slot_of), (_OF_JOINTS, joints), (_OF_THRUSTERS, thrusters)):
        for name in names:
            moved[name] = jax.tree.map(
                functools.partial(_placed, places), getattr(draft, name), getattr(blank, name)
            )
    new = dataclasses.replace(draft, **moved)
    ends = {name: pick(slot_of, getattr(new.joints, name)) for name in ("body_a", "body_b")}
    return dataclasses.replace(
        new,
        joints=dataclasses.replace(new.joints, **ends),
        thrusters=dataclasses.replace(new.thrusters, body=pick(slot_of, new.thrusters.body)),
    )


def _placed(slot_of: Int[Array, "k n"], rows: Array, blank: Array) -> Array:
    """Return rows in their slots; the blank rows elsewhere."""
    here = jnp.arange(blank.shape[0])[:, None, None] == slot_of[None]
    source = jnp.sum(here * jnp.arange(slot_of.shape[0])[None, :, None], axis=1)
    if not rows.shape[0]:
        return jnp.broadcast_to(blank, (*blank.shape[:-1], slot_of.shape[-1]))
    return jnp.where(spread(jnp.any(here, axis=1), blank), pick(rows, source), blank)


def _first(tree: Any) -> Any:
    return jax.tree.map(lambda rows: jnp.moveaxis(rows, -1, 0), tree)


def _last(tree: Any) -> Any:
    return jax.tree.map(lambda rows: jnp.moveaxis(rows, 0, -1), tree)


def states(draft: Draft, engine: PhysicsEngine, inertia_model: InertiaModel) -> EnvState:
    """Return the drafts as environment states at the start of an episode, worlds first.

    Args:
        draft: The levels.
        engine: Sizes and solver.
        inertia_model: How the moments of inertia follow from the shapes.
    """
    capacity = engine.spec.capacity
    figures, polygons = draft.figures, capacity.polygons
    worlds = figures.rotation.shape[-1]
    labels = components(draft.joints, capacity.bodies)
    moves = figures.active & ~figures.fixed
    world = World(
        bodies=Bodies(
            inverse_mass=_inverse(mass(figures), moves),
            inverse_inertia=_inverse(inertia(figures, inertia_model), moves),
            friction=draft.friction,
            restitution=draft.restitution,
            collision_mode=draft.collision_mode,
            active=figures.active,
            vertices=figures.vertices[:polygons],
            vertex_count=figures.vertex_count[:polygons],
            radius=figures.radius[polygons:],
        ),
        joints=draft.joints,
        thrusters=draft.thrusters,
        gravity=draft.gravity,
        collides=labels[:, None] != labels[None, :],
    )
    none = jnp.zeros((worlds,), jnp.int32)
    described = Labels(
        role=figures.role,
        density=figures.density,
        motor_binding=draft.motor_binding,
        motor_auto=draft.motor_auto,
        thruster_binding=draft.thruster_binding,
        max_timesteps=none,
    )
    cache = empty_cache(engine.spec, engine.solver)
    physics = State(
        position=jnp.clip(figures.position, -FARTHEST, FARTHEST),
        rotation=figures.rotation,
        velocity=draft.velocity,
        angular_velocity=draft.angular_velocity,
        touching=jnp.zeros((len(candidate_pairs(capacity)), worlds), bool),
        overflow=jnp.zeros((worlds,), bool),
        cache=jax.tree.map(lambda x: jnp.zeros((*np.shape(x), worlds), np.asarray(x).dtype), cache),
    )
    drawn = EnvState(
        world=_first(world),
        physics=_first(physics),
        labels=_first(described),
        timestep=none,
        last_distance=jnp.full((worlds,), NO_DISTANCE, jnp.float32),
    )
    return jax.tree.map(_as_from_files, drawn)


def _as_from_files(x: Array) -> Array:
    """Return the array as a level that is read has it: of 32 bits, in JAX's 64-bit mode too."""
    return x.astype({"float64": jnp.float32, "int64": jnp.int32}.get(str(x.dtype), x.dtype))


def _inverse(quantity: Float[Array, "b n"], moves: Bool[Array, "b n"]) -> Float[Array, "b n"]:
    return jnp.where(moves, 1 / jnp.where(quantity == 0, 1.0, quantity), 0.0)


def draft_of(state: EnvState) -> Draft:
    """Return environment states (worlds first) as drafts, the solver's memory left behind."""
    world, physics, labels = _last((state.world, state.physics, state.labels))
    bodies = world.bodies
    polygons, circles = bodies.vertex_count.shape[0], bodies.radius.shape[0]

    def more(rows: Array, fill: float) -> Array:
        return jnp.concatenate([rows, jnp.full((circles, *rows.shape[1:]), fill, rows.dtype)])

    radius = jnp.concatenate([jnp.zeros((polygons, *bodies.radius.shape[1:])), bodies.radius])
    circle = jnp.arange(polygons + circles) >= polygons
    figures = Figures(
        position=physics.position,
        rotation=physics.rotation,
        vertices=more(bodies.vertices, 0),
        vertex_count=more(bodies.vertex_count, VERTICES),
        radius=radius,
        circle=jnp.broadcast_to(circle[:, None], radius.shape),
        role=labels.role,
        density=labels.density,
        fixed=bodies.active & (bodies.inverse_mass == 0),
        active=bodies.active,
    )
    return Draft(
        figures=figures,
        velocity=physics.velocity,
        angular_velocity=physics.angular_velocity,
        friction=bodies.friction,
        restitution=bodies.restitution,
        collision_mode=bodies.collision_mode,
        joints=world.joints,
        motor_binding=labels.motor_binding,
        motor_auto=labels.motor_auto,
        thrusters=world.thrusters,
        thruster_binding=labels.thruster_binding,
        gravity=world.gravity,
    )
