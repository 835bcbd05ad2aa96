"""From bodies in the order of their creation to slots in random order.

Random levels end with a uniform permutation of polygons, circles, joints and thrusters, so it does
not matter which slots they were created in: here they get their final ones at once.
"""

import dataclasses
import itertools

import jax.numpy as jnp
from jaxtyping import Array, Bool, Float, Int

from kinetix.engine.spec import ARENA_BODIES, Capacity
from kinetix.environment.generators.blocks import JointRows, ThrusterRows
from kinetix.environment.generators.draft import Draft, plain_draft
from kinetix.environment.generators.figures import VERTICES, Figures, pick


def permutation(u: Float[Array, "k n"]) -> Int[Array, "k n"]:
    """A uniform permutation: the rank of each number among the numbers of its world."""
    count = u.shape[0]
    earlier = (jnp.arange(count)[:, None] < jnp.arange(count)[None, :])[:, :, None]
    below = (u[:, None] < u[None, :]) | ((u[:, None] == u[None, :]) & earlier)
    return jnp.sum(below.astype(jnp.int32), axis=0)


def slots_for(
    members: Bool[Array, "b n"], order: Int[Array, "k n"], first: int
) -> Int[Array, "b n"]:
    """Slots for the marked rows, one after the other along `order`; −1 for the other rows."""
    slots = []
    taken = jnp.zeros(members.shape[-1], jnp.int32)
    for member in members:
        slot = pick(order, taken) + first if order.shape[0] else taken
        slots.append(jnp.where(member, slot, -1))
        taken = taken + member.astype(jnp.int32)
    return jnp.stack(slots)


def sources(slots: Int[Array, "b n"], first: int, count: int) -> Int[Array, "c n"]:
    """Which row sits in each of `count` slots from `first` on; −1 where none does."""
    wanted = jnp.arange(first, first + count)[:, None, None]
    rows = jnp.arange(slots.shape[0])[None, :, None]
    return jnp.max(jnp.where(slots[None] == wanted, rows, -1), axis=1, initial=-1)


def _place(rows: Array, source: Int[Array, "c n"], empty: float) -> Array:
    """The rows in their slots, `empty` elsewhere."""
    found = pick(rows, source)
    there = (source >= 0).reshape(source.shape[0], *(1,) * (rows.ndim - 2), source.shape[1])
    return jnp.where(there, found, jnp.asarray(empty, rows.dtype))


def arranged(
    figures: Figures,
    joints: JointRows,
    thrusters: ThrusterRows,
    u: Float[Array, "k n"],
    capacity: Capacity,
    slots: Capacity,
    *,
    shuffle: bool = True,
) -> tuple[Draft, Int[Array, "c n"]]:
    """Put everything into random slots.

    Args:
        figures: The arena, then bodies in the order of their creation.
        joints: Joints whose bodies are rows of `figures`.
        thrusters: As many as `capacity` has, active or not; their bodies are rows of `figures`.
        u: Uniform numbers, `shuffle_length(capacity)` of them.
        capacity: Slots among which things are shuffled: the size the level was drawn for.
        slots: Slots of the result, at least as many; the further ones stay empty.
        shuffle: False: slots are filled in the order of the rows.

    Returns:
        The levels, and which row each body slot got (−1: none).
    """
    free_polygons = capacity.polygons - ARENA_BODIES
    ends = [free_polygons, capacity.circles, capacity.joints, capacity.thrusters]
    starts = [sum(ends[:k]) for k in range(len(ends) + 1)]
    polygon_order, circle_order, joint_order, thruster_order = (
        permutation(u[low:high] if shuffle else _ascending(high - low, u.shape[1]))
        for low, high in itertools.pairwise(starts)
    )
    arena_rows = (jnp.arange(figures.active.shape[0]) < ARENA_BODIES)[:, None]
    drawn = figures.active & ~arena_rows
    of_body = jnp.maximum(
        slots_for(drawn & ~figures.circle, polygon_order, ARENA_BODIES),
        slots_for(drawn & figures.circle, circle_order, slots.polygons),
    )
    of_body = jnp.where(arena_rows, jnp.arange(of_body.shape[0])[:, None], of_body)
    of_joint = slots_for(joints.active, joint_order, 0)
    source = sources(of_body, 0, slots.bodies)
    draft = plain_draft(
        _place_figures(figures, source, slots),
        _place_joints(joints, sources(of_joint, 0, slots.joints), of_body),
        _place_thrusters(thrusters, sources(thruster_order, 0, slots.thrusters), of_body),
    )
    return draft, source


def _ascending(count: int, worlds: int) -> Float[Array, "k n"]:
    """Numbers whose ranks are their own order."""
    return jnp.broadcast_to(jnp.arange(count, dtype=jnp.float32)[:, None], (count, worlds))


def shuffle_length(capacity: Capacity) -> int:
    """How many uniform numbers `arranged` uses."""
    return capacity.bodies - ARENA_BODIES + capacity.joints + capacity.thrusters


def _place_figures(figures: Figures, source: Int[Array, "c n"], slots: Capacity) -> Figures:
    empty = {"vertex_count": VERTICES, "density": 1}
    names = figures.__dataclass_fields__
    placed = {name: _place(getattr(figures, name), source, empty.get(name, 0)) for name in names}
    placed["circle"] = jnp.broadcast_to(
        (jnp.arange(slots.bodies) >= slots.polygons)[:, None], source.shape
    )
    return Figures(**placed)


def _place_joints(
    joints: JointRows, source: Int[Array, "c n"], of_body: Int[Array, "b n"]
) -> JointRows:
    joints = dataclasses.replace(
        joints,
        body_a=jnp.maximum(pick(of_body, joints.body_a), 0),
        body_b=jnp.maximum(pick(of_body, joints.body_b), 0),
    )
    names = joints.__dataclass_fields__
    return JointRows(**{name: _place(getattr(joints, name), source, 0) for name in names})


def _place_thrusters(
    thrusters: ThrusterRows, source: Int[Array, "c n"], of_body: Int[Array, "b n"]
) -> ThrusterRows:
    thrusters = dataclasses.replace(thrusters, body=jnp.maximum(pick(of_body, thrusters.body), 0))
    names = thrusters.__dataclass_fields__
    active = (thrusters.active).astype(jnp.float32)
    placed = {
        # An unused slot is all zero.
        name: _place(_masked(getattr(thrusters, name), active), source, 0)
        for name in names
    }
    return ThrusterRows(**placed)


def _masked(rows: Array, active: Float[Array, "t n"]) -> Array:
    shape = (active.shape[0], *(1,) * (rows.ndim - 2), active.shape[1])
    return jnp.where(active.reshape(shape) > 0, rows, jnp.zeros_like(rows))
