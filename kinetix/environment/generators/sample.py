"""Random levels, drawn natively batched.

Everything that differs between worlds is data: the loop over shapes runs once for the whole batch,
each step draws either a free or a jointed shape (or none) per world, and only the chosen kind of
proposal is compared by its contacts.
"""

import dataclasses
import functools
from collections.abc import Callable

import jax
import jax.numpy as jnp
from jaxtyping import Array, Bool, Float, Int, Key, UInt

from kinetix.aliases import also_named
from kinetix.engine.spec import ARENA_BODIES, Capacity
from kinetix.environment.generators.blocks import (
    Proposals,
    connected_shape,
    free_shape,
    joint_of,
    look_around,
    size_limit,
    thrusters_on,
)
from kinetix.environment.generators.boxes import Boxes, boxes, count_box_contacts
from kinetix.environment.generators.contacts import count_contacts
from kinetix.environment.generators.draft import (
    Draft,
    empty_draft,
    first_free,
    free_slot,
    joint_counts,
    put,
    shuffle_length,
    shuffled,
    spread,
    states,
    with_joint,
)
from kinetix.environment.generators.draws import (
    PER_JOINT,
    PER_SHAPE,
    PER_THRUSTER,
    Tape,
    joint_draws,
    raw_keys,
    sampler_of,
    shape_draws,
    thruster_draws,
)
from kinetix.environment.generators.figures import pick
from kinetix.environment.generators.params import UEDParams, checked_drawing
from kinetix.environment.goal import BLUE, GREEN, NEUTRAL
from kinetix.environment.params import EnvParams, PhysicsEngine, StaticEnvParams
from kinetix.environment.state import EnvState
from kinetix.pytree import pytree

SMALL_BODIES = 7
"""Capacities with at most this many bodies, the arena included, are drawn without proposals."""
SHAPES_AT_FIRST = 3
"""Green, blue and the shape that may carry the motor."""


@pytree
class Plan:
    """The addition of one step, decided before anything is placed."""

    free: Bool[Array, " n"]
    connected: Bool[Array, " n"]
    force_no_fixate: Bool[Array, " n"]
    force_rjoint: Bool[Array, " n"]


def is_small(capacity: Capacity) -> bool:
    """Return whether levels of this capacity have no proposals and no fixed bodies."""
    return capacity.bodies <= SMALL_BODIES


def draw_floor_role(u: Float[Array, " n"], ued: UEDParams) -> Int[Array, " n"]:
    """Return the floor's role by the floor probabilities."""
    weights = ued.floor_probabilities
    threshold = u * sum(weights)
    passed = (threshold >= sum(weights[: k + 1]) for k in range(len(weights) - 1))
    return sum((part.astype(jnp.int32) for part in passed), start=jnp.zeros(u.shape, jnp.int32))


def draw_levels(
    keys: UInt[Array, "n 2"], capacity: Capacity, ued: UEDParams, slots: Capacity | None = None
) -> Draft:
    """Return random levels, one per key.

    Args:
        keys: A level is a function of its key alone, whatever the batch.
        capacity: The size that the level is drawn for.
        ued: The options.
        slots: Slots of the result; the default is `capacity`.
    """
    steps = max(SHAPES_AT_FIRST, capacity.bodies - ARENA_BODIES)
    proposals = 1 if is_small(capacity) else ued.add_shape_n_proposals
    numbers = steps * (PER_SHAPE * proposals + PER_JOINT + 1) + 4 + shuffle_length(capacity)
    tape = Tape(raw_keys(keys), numbers + (PER_THRUSTER + 1) * capacity.thrusters)
    floor_u, first_u, control_u, swap_u = tape.take(4)

    draft = empty_draft(keys.shape[0], capacity, legacy_ceiling=ued.legacy_ceiling)
    floor = draw_floor_role(floor_u, ued)
    draft = _with_roles(draft, draft.figures.role.at[0].set(floor))

    # One of (thruster, motor) = (0, 1), (1, 0), (1, 1).
    thruster_forced = control_u >= 1 / 3
    motor_forced = (control_u < 1 / 3) | (control_u >= 2 / 3)
    first_moves = (first_u < 0.5) | (floor == BLUE)
    plan = _plan(tape.take(steps), first_moves, motor_forced, capacity, ued)
    shape_u, joint_u = tape.take(steps, PER_SHAPE, proposals), tape.take(steps, PER_JOINT)
    draft, added = _grow(draft, plan, shape_u, joint_u, capacity, ued)
    draft = _with_thrusters(draft, tape, thruster_forced, added, capacity, ued)
    roles = _swap_roles(draft.figures.role, (floor == NEUTRAL) & (swap_u < 0.5))
    shuffle_u = tape.take(shuffle_length(capacity))
    return shuffled(_with_roles(draft, roles), shuffle_u, capacity, slots or capacity)


def _with_roles(draft: Draft, role: Int[Array, "b n"]) -> Draft:
    return dataclasses.replace(draft, figures=dataclasses.replace(draft.figures, role=role))


def _plan(
    u: Float[Array, "k n"],
    first_moves: Bool[Array, " n"],
    motor_forced: Bool[Array, " n"],
    capacity: Capacity,
    ued: UEDParams,
) -> Plan:
    """Plan each step: two free shapes, one for the motor, then by the chances."""
    total = ued.add_connected_shape_chance + ued.add_shape_chance + ued.add_no_shape_chance
    threshold = u * total
    connected = threshold < ued.add_connected_shape_chance
    free = ~connected & (threshold < ued.add_connected_shape_chance + ued.add_shape_chance)
    free = free.at[0].set(True).at[1].set(True).at[2].set(~motor_forced)
    connected = connected.at[0].set(False).at[1].set(False).at[2].set(motor_forced)
    never_fixed = jnp.zeros_like(free) | is_small(capacity)
    return Plan(
        free=free,
        connected=connected,
        force_no_fixate=never_fixed.at[0]
        .set(never_fixed[0] | first_moves)
        .at[1]
        .set(never_fixed[1] | ~first_moves),
        force_rjoint=jnp.zeros_like(free).at[2].set(motor_forced),
    )


def _grow(
    draft: Draft,
    plan: Plan,
    shape_u: Float[Array, "k 14 q n"],
    joint_u: Float[Array, "k 8 n"],
    capacity: Capacity,
    ued: UEDParams,
) -> tuple[Draft, Int[Array, "k n"]]:
    """Run all steps of the plan; also return the slot that each one filled, −1 where none."""

    def step(
        carry: tuple[Draft, Boxes | None], inputs: tuple[Array, Plan, Array, Array]
    ) -> tuple[tuple[Draft, Boxes | None], Array]:
        draft, outlines = carry
        number, what, shape_rows, joint_rows = inputs
        chosen, outline = _propose(draft, outlines, what, shape_rows, number, capacity, ued)
        slot = free_slot(draft.figures, chosen.figure.circle, capacity)
        joint, binding = joint_of(
            chosen,
            slot,
            joint_draws(joint_rows),
            force_rjoint=what.force_rjoint,
            revolute_count=_count(draft.joints.active & ~draft.joints.fixed),
            ued=ued,
        )
        old, new = (draft.figures, outlines), (chosen.figure, outline)
        figures, outlines = put(old, new, slot, chosen.figure.active)
        draft = dataclasses.replace(draft, figures=figures)
        filled = jnp.where(chosen.figure.active, slot, -1)
        return (with_joint(draft, joint, binding, chosen.joint), outlines), filled

    inputs = (jnp.arange(shape_u.shape[0], dtype=jnp.int32), plan, shape_u, joint_u)
    # The legacy ceiling differs on its far side only, and is no rectangle.
    outlines = None if ued.generate_triangles else _arena_boxes(joint_u.shape[-1], capacity)
    (draft, _), added = jax.lax.scan(step, (draft, outlines), inputs)
    return draft, added


def _arena_boxes(worlds: int, capacity: Capacity) -> Boxes:
    """Return the outlines of levels with nothing but the arena."""
    one = boxes(empty_draft(1, capacity).figures)
    return jax.tree.map(lambda x: jnp.broadcast_to(x, (*x.shape[:-1], worlds)), one)


def _count(marks: Bool[Array, "k n"]) -> Int[Array, " n"]:
    return jnp.sum(marks.astype(jnp.int32), axis=0)


def _propose(
    draft: Draft,
    outlines: Boxes | None,
    what: Plan,
    shape_rows: Float[Array, "14 q n"],
    number: Int[Array, ""],
    capacity: Capacity,
    ued: UEDParams,
) -> tuple[Proposals, Boxes | None]:
    """Return the best proposal of the planned kind in each world, and its outline."""
    draws, size = shape_draws(shape_rows), size_limit(ued)
    figures, joints, polygons = draft.figures, draft.joints, capacity.polygons
    around = look_around(
        figures,
        polygon_room=_count(figures.active[:polygons]) < polygons,
        circle_room=_count(figures.active[polygons:]) < capacity.circles,
        joint_room=_count(joints.active) < capacity.joints,
    )
    free = free_shape(draws, around, what.force_no_fixate[None], ued, size)
    connected = connected_shape(
        draws,
        figures,
        joint_counts(joints, capacity.bodies),
        around,
        ued,
        size,
        new_polygon_row=first_free(figures.active[:polygons])[None],
    )
    proposals = jax.tree.map(
        lambda a, b: jnp.where(_over(what.connected, a), b, a), free, connected
    )
    happens = (what.free | what.connected)[None]
    figure = proposals.figure
    figure = dataclasses.replace(figure, active=figure.active & happens)
    proposals = dataclasses.replace(proposals, figure=figure, joint=proposals.joint & happens)
    candidates = None if outlines is None else boxes(figure)
    if shape_rows.shape[1] == 1:
        best = jnp.zeros((shape_rows.shape[2],), jnp.int32)
    else:
        if candidates is None or outlines is None:
            count = count_contacts(figure, figures)
        else:
            parts = slice(None, polygons), slice(polygons, None)
            rectangles, discs = (jax.tree.map(lambda x, p=p: x[p], outlines) for p in parts)
            # Slots are filled from the first one on.
            rows = (
                jnp.minimum(ARENA_BODIES + number, polygons),
                jnp.minimum(number, capacity.circles),
            )
            count = count_box_contacts(candidates, rectangles, discs, rows)
        hidden = jnp.where(proposals.valid, 0.0, ued.connect_no_visibility_bias)
        best = _first_minimum(count + hidden)
    return jax.tree.map(lambda leaf: pick(leaf, best), (proposals, candidates))


def _over(condition: Bool[Array, " n"], like: Array) -> Array:
    """Return the condition with as many axes as `like`, worlds last."""
    return condition.reshape((1,) * (like.ndim - 1) + condition.shape)


def _first_minimum(score: Float[Array, "q n"]) -> Int[Array, " n"]:
    """Return the row of the least score; XLA does not vectorise `argmin` over the worlds."""
    best, least = jnp.zeros(score.shape[1:], jnp.int32), score[0]
    for k in range(1, score.shape[0]):
        better = score[k] < least
        best = jnp.where(better, k, best)
        least = jnp.where(better, score[k], least)
    return best


def _with_thrusters(
    draft: Draft,
    tape: Tape,
    forced: Bool[Array, " n"],
    added: Int[Array, "k n"],
    capacity: Capacity,
    ued: UEDParams,
) -> Draft:
    """Add the forced thruster to one of the first bodies that were added, the others to any."""
    count = capacity.thrusters
    numbers, wanted = tape.take(PER_THRUSTER, count), tape.take(count) < ued.add_thruster_chance
    if not count:
        return draft
    figures = draft.figures
    eligible = figures.active & ~figures.fixed
    # The forced one comes before the further shapes; nothing changes about those bodies later.
    early = added[:SHAPES_AT_FIRST]
    first = thrusters_on(thruster_draws(numbers[:, :1]), figures, eligible, ued, order=early)
    later = thrusters_on(thruster_draws(numbers[:, 1:]), figures, eligible, ued, order=added)
    both = jax.tree.map(lambda a, b: jnp.concatenate([a, b]), first, later)
    active = both[0].active & wanted.at[0].set(forced)
    thrusters, binding = jax.tree.map(
        lambda x: jnp.where(spread(active, x), x, jnp.zeros_like(x)), both
    )
    thrusters = dataclasses.replace(thrusters, active=active)
    return dataclasses.replace(draft, thrusters=thrusters, thruster_binding=binding)


def _swap_roles(role: Int[Array, "b n"], swap: Bool[Array, " n"]) -> Int[Array, "b n"]:
    goal = (role == GREEN) | (role == BLUE)
    return jnp.where(goal & swap[None], GREEN + BLUE - role, role)


@functools.cache
def level_sampler(
    engine: PhysicsEngine, ued: UEDParams, capacity: Capacity | None = None
) -> Callable[[Key[Array, ""]], EnvState]:
    """Return the function from a key to a random level; compiled once per engine and options.

    Args:
        engine: Sizes and solver of the states.
        ued: The options.
        capacity: The size that levels are drawn for; the default is the engine's.
    """
    slots = engine.spec.capacity

    def batched(keys: UInt[Array, "n 2"]) -> EnvState:
        draft = draw_levels(keys, capacity or slots, ued, slots)
        return states(draft, engine, ued.inertia_model)

    return sampler_of(batched)


@also_named(rng="key", engine="physics_engine")
def sample_kinetix_level(
    key: Key[Array, ""],
    physics_engine: PhysicsEngine | None,
    env_params: EnvParams,
    static_env_params: StaticEnvParams,
    ued_params: UEDParams | None = None,
) -> EnvState:
    """Return a random level at the start of its episode.

    Args:
        key: Random key; the same key gives the same level.
        physics_engine: `env.physics_engine`: sizes and solver; None: that of `static_env_params`.
        env_params: Taken for kinetix-env's sake; random levels leave the time limit to it.
        static_env_params: Taken for kinetix-env's sake; its sizes are those of the engine.
        ued_params: The options; None for the defaults.

    Raises:
        KinetixError: An argument is something else, or has a number that cannot be.
    """
    order = "physics_engine, env_params, static_env_params, ued_params"
    order = f"the order is sample_kinetix_level(key, {order})"
    engine, options = checked_drawing(
        physics_engine, env_params, static_env_params, ued_params, order
    )
    return level_sampler(engine, options)(key)
