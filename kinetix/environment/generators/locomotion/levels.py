"""The levels of the locomotion family: a creature in the arena, moved inside, and a goal."""

import dataclasses
from typing import Any, Final

import jax
import jax.numpy as jnp
from jaxtyping import Array, Bool, Float, UInt

from kinetix.engine.spec import ARENA_BODIES, Capacity
from kinetix.environment.generators.draft import (
    Draft,
    empty_draft,
    shuffle_length,
    shuffled,
    spread,
)
from kinetix.environment.generators.draws import Tape, between, raw_keys
from kinetix.environment.generators.figures import Figures
from kinetix.environment.generators.locomotion.creature import Creature, assemble
from kinetix.environment.generators.locomotion.params import LocomotionParams
from kinetix.environment.generators.params import UEDParams
from kinetix.environment.generators.sample import draw_floor_role
from kinetix.environment.goal import BLUE, GREEN
from kinetix.errors import KinetixError
from kinetix.level.geometry import ARENA_WIDTH

LOWEST, LEFTMOST, RIGHTMOST = 0.5, 0.2, 4.8
"""Bounds of all corners of the creature at the start (rotation ignored) [m]."""
GOAL_RADIUS: Final = 0.3
GOAL_HEIGHT: Final = 1.0
GOAL_RANGE: Final = (2.0, 4.5)
"""Range of the goal along x, before mirroring [m]."""
FLOOR_ODDS: Final = UEDParams(
    floor_prob_normal=0.75, floor_prob_green=0.0, floor_prob_blue=0.0, floor_prob_red=0.25
)
"""The floor's roles where no UEDParams are given."""
_CORNERS: Final = ((-1.0, 1.0), (1.0, 1.0), (1.0, -1.0), (-1.0, -1.0))
"""Clockwise, but from another corner than all other generated rectangles."""


def most_extra_legs(capacity: Capacity, params: LocomotionParams) -> int:
    """Count the limbs that can be added at random."""
    ankles = 2 if params.add_ankles else 0
    return max(0, min(capacity.polygons - ARENA_BODIES - 3 - ankles, capacity.joints - 2 - ankles))


def draw_locomotion(
    keys: UInt[Array, "n 2"],
    capacity: Capacity,
    params: LocomotionParams,
    ued: UEDParams | None = None,
) -> Draft:
    """Return levels of the locomotion family, one per key.

    Args:
        keys: A level is a function of its key alone.
        capacity: Slots; there must be room for the body, two legs, their ankles and the goal.
        params: The options.
        ued: Only for the floor's role; None: none 0.75, red 0.25.

    Raises:
        KinetixError: The capacity is too small.
    """
    _check_room(capacity, params)
    worlds = keys.shape[0]
    most = most_extra_legs(capacity, params)
    numbers = 64 + 8 * most + shuffle_length(capacity)
    tape = Tape(raw_keys(keys), numbers)
    mirror_u, turn_u, goal_u, floor_u, count_u = tape.take(5)
    mirror = mirror_u < 0.5
    creature = Creature(tape, worlds, params)
    assemble(creature, turn_u, mirror, count_u, most)
    floor_friction = creature.surface()
    draft = _put_together(creature, mirror, goal_u, capacity)
    role = draft.figures.role.at[0].set(draw_floor_role(floor_u, ued or FLOOR_ODDS))
    draft = dataclasses.replace(
        draft,
        figures=dataclasses.replace(draft.figures, role=role),
        friction=draft.friction.at[0].set(floor_friction),
    )
    if not params.do_permute_state:
        return draft
    return shuffled(draft, tape.take(shuffle_length(capacity)), capacity, capacity)


def _check_room(capacity: Capacity, params: LocomotionParams) -> None:
    limbs = 5 if params.add_ankles else 3
    need = (ARENA_BODIES + limbs, 1, limbs - 1)
    have = (capacity.polygons, capacity.circles, capacity.joints)
    if any(got < want for got, want in zip(have, need, strict=True)):
        raise KinetixError(
            f"locomotion levels do not fit {have} polygons, circles and joints: expected at least "
            f"{need}"
        )


def _put_together(
    creature: Creature, mirror: Bool[Array, " n"], goal_u: Float[Array, " n"], capacity: Capacity
) -> Draft:
    """The levels: arena, creature (moved inside) and goal in the first slots of their kinds."""
    params, worlds = creature.params, creature.worlds
    draft = empty_draft(worlds, capacity, legacy_ceiling=params.legacy_ceiling)
    limbs = [limb for limb, _, _ in creature.limbs]
    active = jnp.stack([active for _, _, active in creature.limbs])
    half = jnp.stack([limb.size / 2 for limb in limbs])
    position = jnp.stack([limb.position for limb in limbs])
    body = {
        "position": position + _inside(position, half, active)[None],
        "rotation": jnp.stack([limb.rotation for limb in limbs]),
        "vertices": half[:, None] * jnp.array(_CORNERS)[None, :, :, None],
        "role": jnp.zeros(active.shape, jnp.int32).at[0].set(GREEN),
        "density": jnp.stack([trait.density for _, trait, _ in creature.limbs]),
        "active": active,
    }
    low, high = GOAL_RANGE
    x = (low + high) / 2 if params.fix_goal_position else between(goal_u, low, high)
    x = jnp.broadcast_to(jnp.where(mirror, ARENA_WIDTH - x, x), (worlds,))
    goal = {
        "position": jnp.stack([x, jnp.full_like(x, GOAL_HEIGHT)]),
        "radius": GOAL_RADIUS,
        "role": BLUE,
        "fixed": True,
        "active": True,
    }
    slots = slice(ARENA_BODIES, ARENA_BODIES + len(limbs))
    figures = _written(_written(draft.figures, slots, body), capacity.polygons, goal)
    friction = jnp.stack([trait.friction for _, trait, _ in creature.limbs])
    joints, bindings = jax.tree.map(lambda *rows: jnp.stack(rows), *creature.joints)
    part = slice(0, len(creature.joints))

    def write(old: Array, new: Array) -> Array:
        kept = jnp.where(spread(joints.active, new), new, old[part])
        return old.at[part].set(kept.astype(old.dtype))

    return dataclasses.replace(
        draft,
        figures=figures,
        friction=draft.friction.at[slots].set(jnp.where(active, friction, 1.0)),
        joints=jax.tree.map(write, draft.joints, joints),
        motor_binding=draft.motor_binding.at[part].set(jnp.where(joints.active, bindings, 0)),
    )


def _written(figures: Figures, slots: slice | int, fields: dict[str, Any]) -> Figures:
    """Return the bodies with these fields in these slots, where they are active."""
    active = jnp.asarray(fields["active"])
    changed = {}
    for name, value in fields.items():
        old = getattr(figures, name)
        shape = (*active.shape[:-1], *(1,) * (old[slots].ndim - active.ndim), *active.shape[-1:])
        kept = jnp.where(active.reshape(shape), value, old[slots])
        changed[name] = old.at[slots].set(kept.astype(old.dtype))
    return dataclasses.replace(figures, **changed)


def _inside(
    position: Float[Array, "b 2 n"], half: Float[Array, "b 2 n"], active: Bool[Array, "b n"]
) -> Float[Array, "2 n"]:
    """Return the shift that brings all corners of the creature, unturned, inside the arena [m]."""
    there = active[:, None]
    low = jnp.min(jnp.where(there, position - half, jnp.inf), axis=0)
    high = jnp.max(jnp.where(there, position + half, -jnp.inf), axis=0)
    right = jnp.maximum(0.0, LEFTMOST - low[0])
    left = jnp.maximum(0.0, high[0] - RIGHTMOST)
    return jnp.stack([right - left, jnp.maximum(0.0, LOWEST - low[1])])
