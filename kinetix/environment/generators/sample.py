"""Random levels, drawn natively batched.

Everything that differs between worlds is data: the loop over shapes runs once for the whole batch,
each step draws either a free or a jointed shape (or none) per world, and only the chosen kind of
proposal is compared by its contacts.

Source: level_generation.md 3.
"""

import dataclasses
import functools
from collections.abc import Callable
from typing import Any

import jax
import jax.numpy as jnp
from jaxtyping import Array, Bool, Float, Int, Key, UInt

from kinetix.engine.spec import ARENA_BODIES, Capacity
from kinetix.environment.generators.arrange import arranged, shuffle_length
from kinetix.environment.generators.batching import for_one_world
from kinetix.environment.generators.blocks import (
    BLUE,
    GREEN,
    NEUTRAL,
    JointRows,
    Proposals,
    ThrusterRows,
    connected_shape,
    free_shape,
    joint_of,
    look_around,
    size_limit,
    thrusters_on,
)
from kinetix.environment.generators.boxes import Boxes, boxes, count_box_contacts
from kinetix.environment.generators.contacts import Outlines, count_contacts, outlines
from kinetix.environment.generators.draft import Draft, states
from kinetix.environment.generators.draws import (
    PER_JOINT,
    PER_SHAPE,
    PER_THRUSTER,
    Tape,
    joint_draws,
    raw_keys,
    shape_draws,
    thruster_draws,
)
from kinetix.environment.generators.figures import Figures, arena, pick
from kinetix.environment.generators.params import UEDParams
from kinetix.environment.params import EnvParams, PhysicsEngine, StaticEnvParams
from kinetix.environment.state import EnvState
from kinetix.pytree import pytree

SMALL_BODIES = 7
"""Capacities with at most this many bodies, the arena included, are drawn without proposals."""
SHAPES_AT_FIRST = 3
"""Green, blue and the shape that may carry the motor."""


@pytree
class Plan:
    """What one step adds, decided before anything is placed."""

    free: Bool[Array, " n"]
    connected: Bool[Array, " n"]
    force_no_fixate: Bool[Array, " n"]
    force_rjoint: Bool[Array, " n"]


@pytree
class Growing:
    """A level that grows by one body a step; rows in the order of creation."""

    figures: Figures
    outlines: Outlines | Boxes
    """What contacts are counted on."""
    joint_counts: Int[Array, "b n"]
    """Active joints on each body."""
    polygon_count: Int[Array, " n"]
    circle_count: Int[Array, " n"]
    joint_count: Int[Array, " n"]
    revolute_count: Int[Array, " n"]


def is_small(capacity: Capacity) -> bool:
    """Whether levels of this capacity are drawn without proposals, and nothing in them is fixed."""
    return capacity.bodies <= SMALL_BODIES


def draw_floor_role(u: Float[Array, " n"], ued: UEDParams) -> Int[Array, " n"]:
    """The floor's role by the floor probabilities."""
    weights = ued.floor_probabilities
    threshold = u * sum(weights)
    passed = (threshold >= sum(weights[: k + 1]) for k in range(len(weights) - 1))
    return sum((part.astype(jnp.int32) for part in passed), start=jnp.zeros(u.shape, jnp.int32))


def draw_levels(
    keys: UInt[Array, "n 2"], capacity: Capacity, ued: UEDParams, slots: Capacity | None = None
) -> Draft:
    """Random levels, one per key.

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

    grown = _empty(keys.shape[0], steps, ued)
    floor = draw_floor_role(floor_u, ued)
    role = grown.figures.role.at[0].set(floor)
    grown = dataclasses.replace(grown, figures=dataclasses.replace(grown.figures, role=role))

    # One of (thruster, motor) = (0, 1), (1, 0), (1, 1).
    thruster_forced = control_u >= 1 / 3
    motor_forced = (control_u < 1 / 3) | (control_u >= 2 / 3)
    first_moves = (first_u < 0.5) | (floor == BLUE)
    plan = _plan(tape.take(steps), first_moves, motor_forced, capacity, ued)
    grown, joints = _grow(
        grown,
        plan,
        tape.take(steps, PER_SHAPE, proposals),
        tape.take(steps, PER_JOINT),
        capacity,
        ued,
    )
    thrusters = _draw_thrusters(tape, grown.figures, thruster_forced, capacity, ued)
    roles = _swap_roles(grown.figures.role, (floor == NEUTRAL) & (swap_u < 0.5))
    shuffle_u = tape.take(shuffle_length(capacity))
    figures = dataclasses.replace(grown.figures, role=roles)
    return arranged(figures, joints, thrusters, shuffle_u, capacity, slots or capacity)[0]


def _plan(
    u: Float[Array, "k n"],
    first_moves: Bool[Array, " n"],
    motor_forced: Bool[Array, " n"],
    capacity: Capacity,
    ued: UEDParams,
) -> Plan:
    """What each step adds: two free shapes, one for the motor, then by the chances."""
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


def _empty(worlds: int, steps: int, ued: UEDParams) -> Growing:
    """The arena, and inactive rows for as many bodies as there are steps."""
    floor_and_walls = arena(worlds, legacy_ceiling=ued.legacy_ceiling)

    def room(rows: Array) -> Array:
        return jnp.concatenate([rows, jnp.zeros((steps, *rows.shape[1:]), rows.dtype)])

    none = jnp.zeros((worlds,), jnp.int32)
    return Growing(
        figures=jax.tree.map(room, floor_and_walls),
        # The legacy ceiling differs on its far side only, and is no rectangle.
        outlines=jax.tree.map(room, _traced(arena(worlds, legacy_ceiling=False), ued)),
        joint_counts=jnp.zeros((ARENA_BODIES + steps, worlds), jnp.int32),
        polygon_count=none + ARENA_BODIES,
        circle_count=none,
        joint_count=none,
        revolute_count=none,
    )


def _grow(
    grown: Growing,
    plan: Plan,
    shape_u: Float[Array, "k 14 q n"],
    joint_u: Float[Array, "k 8 n"],
    capacity: Capacity,
    ued: UEDParams,
) -> tuple[Growing, JointRows]:
    """Run all steps; the joint of step k (active or not) is row k of the joints."""

    def step(carry: Growing, inputs: tuple[Array, Plan, Array, Array]) -> tuple[Growing, JointRows]:
        row, what, shape_rows, joint_rows = inputs
        chosen, outline = _propose(carry, what, shape_rows, row, capacity, ued)
        joint = joint_of(
            chosen,
            row,
            joint_draws(joint_rows),
            force_rjoint=what.force_rjoint,
            revolute_count=carry.revolute_count,
            ued=ued,
        )
        return _added(carry, chosen, outline, joint, row), joint

    rows = ARENA_BODIES + jnp.arange(shape_u.shape[0], dtype=jnp.int32)
    return jax.lax.scan(step, grown, (rows, plan, shape_u, joint_u))


def _propose(
    grown: Growing,
    what: Plan,
    shape_rows: Float[Array, "14 q n"],
    row: Int[Array, ""],
    capacity: Capacity,
    ued: UEDParams,
) -> tuple[Proposals, Outlines | Boxes]:
    """The best proposal of the planned kind in each world, and its outline."""
    draws = shape_draws(shape_rows)
    around = look_around(
        grown.figures,
        polygon_room=grown.polygon_count < capacity.polygons,
        circle_room=grown.circle_count < capacity.circles,
        joint_room=grown.joint_count < capacity.joints,
    )
    size = size_limit(ued)
    free = free_shape(draws, around, what.force_no_fixate[None], ued, size)
    connected = connected_shape(
        draws, grown.figures, grown.joint_counts, around, ued, size, new_polygon_row=row
    )
    proposals = jax.tree.map(
        lambda a, b: jnp.where(_over(what.connected, a), b, a), free, connected
    )
    happens = (what.free | what.connected)[None]
    figure = proposals.figure
    figure = dataclasses.replace(figure, active=figure.active & happens)
    proposals = dataclasses.replace(proposals, figure=figure, joint=proposals.joint & happens)
    candidates = _traced(figure, ued)
    if shape_rows.shape[1] == 1:
        best = jnp.zeros((shape_rows.shape[2],), jnp.int32)
    else:
        count = _count(candidates, grown.outlines, row).astype(jnp.float32)
        score = count + jnp.where(proposals.valid, 0.0, ued.connect_no_visibility_bias)
        best = _first_minimum(score)
    return jax.tree.map(lambda leaf: pick(leaf, best), (proposals, candidates))


def _traced(figures: Figures, ued: UEDParams) -> Outlines | Boxes:
    """Bodies in the cheapest form that contacts can be counted on."""
    return outlines(figures) if ued.generate_triangles else boxes(figures)


def _count(new: Outlines | Boxes, others: Outlines | Boxes, rows: Int[Array, ""]) -> Array:
    if isinstance(new, Boxes) and isinstance(others, Boxes):
        return count_box_contacts(new, others, rows)
    assert isinstance(new, Outlines) and isinstance(others, Outlines)
    return count_contacts(new, others, rows)


def _over(condition: Bool[Array, " n"], like: Array) -> Array:
    """The condition with as many axes as `like`, worlds last."""
    return condition.reshape((1,) * (like.ndim - 1) + condition.shape)


def _first_minimum(score: Float[Array, "q n"]) -> Int[Array, " n"]:
    best = jnp.zeros(score.shape[1:], jnp.int32)
    least = score[0]
    for k in range(1, score.shape[0]):
        better = score[k] < least
        best = jnp.where(better, k, best)
        least = jnp.where(better, score[k], least)
    return best


def _added(
    grown: Growing,
    chosen: Proposals,
    outline: Outlines | Boxes,
    joint: JointRows,
    row: Int[Array, ""],
) -> Growing:
    """The level with the chosen body in the given row (inactive where there is none)."""

    def write(rows: Array, new: Array) -> Array:
        return jax.lax.dynamic_update_index_in_dim(rows, new, row, 0)

    rows = jnp.arange(grown.joint_counts.shape[0], dtype=jnp.int32)[:, None]
    ends = (rows == chosen.target[None]) | (rows == row)
    active, circle = chosen.figure.active, chosen.figure.circle
    return Growing(
        figures=jax.tree.map(write, grown.figures, chosen.figure),
        outlines=jax.tree.map(write, grown.outlines, outline),
        joint_counts=grown.joint_counts + (ends & chosen.joint[None]).astype(jnp.int32),
        polygon_count=grown.polygon_count + (active & ~circle).astype(jnp.int32),
        circle_count=grown.circle_count + (active & circle).astype(jnp.int32),
        joint_count=grown.joint_count + joint.active.astype(jnp.int32),
        revolute_count=grown.revolute_count + (joint.active & ~joint.weld).astype(jnp.int32),
    )


def _draw_thrusters(
    tape: Tape,
    figures: Figures,
    forced: Bool[Array, " n"],
    capacity: Capacity,
    ued: UEDParams,
) -> ThrusterRows:
    """The forced thruster, on one of the first three bodies, and the others on any body."""
    count = capacity.thrusters
    draws = thruster_draws(tape.take(PER_THRUSTER, count))
    wanted = tape.take(count) < ued.add_thruster_chance
    eligible = figures.active & ~figures.fixed
    # The forced one comes before the further shapes; nothing changes about those bodies later.
    early = jnp.arange(eligible.shape[0]) < ARENA_BODIES + SHAPES_AT_FIRST
    first = thrusters_on(_rows(draws, slice(0, 1)), figures, eligible & early[:, None], ued)
    later = thrusters_on(_rows(draws, slice(1, None)), figures, eligible, ued)
    both = jax.tree.map(lambda a, b: jnp.concatenate([a, b]), first, later)
    if count:
        wanted = wanted.at[0].set(forced)
    return dataclasses.replace(both, active=both.active & wanted)


def _rows(draws: Any, part: slice) -> Any:
    return jax.tree.map(lambda leaf: leaf[part], draws)


def _swap_roles(role: Int[Array, "b n"], swap: Bool[Array, " n"]) -> Int[Array, "b n"]:
    goal = (role == GREEN) | (role == BLUE)
    return jnp.where(goal & swap[None], GREEN + BLUE - role, role)


@functools.cache
def level_sampler(
    engine: PhysicsEngine, ued: UEDParams, capacity: Capacity | None = None
) -> Callable[[Key[Array, ""]], EnvState]:
    """The function from a key to a random level; compiled once per engine and options.

    Args:
        engine: Sizes and solver of the states.
        ued: The options.
        capacity: The size that levels are drawn for; the default is the engine's.
    """
    slots = engine.spec.capacity

    def batched(keys: UInt[Array, "n 2"]) -> EnvState:
        draft = draw_levels(keys, capacity or slots, ued, slots)
        return states(draft, engine, ued.inertia_model)

    single = for_one_world(batched)
    return lambda key: single(raw_keys(key))


def sample_kinetix_level(
    key: Key[Array, ""],
    physics_engine: PhysicsEngine,
    env_params: EnvParams,
    static_env_params: StaticEnvParams,
    ued_params: UEDParams | None = None,
) -> EnvState:
    """A random level at the start of its episode.

    Args:
        key: Random key; the same key gives the same level.
        physics_engine: `env.physics_engine`: sizes and solver.
        env_params: Taken for the peer's sake; random levels leave the time limit to it.
        static_env_params: Taken for the peer's sake; its sizes are those of the engine.
        ued_params: The options; None for the defaults.
    """
    del env_params, static_env_params
    return level_sampler(physics_engine, ued_params or UEDParams())(key)
