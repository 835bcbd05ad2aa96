"""The locomotion family: a body on limbs, driven to a goal.

Q11 and Q12 are quirks of `LocomotionParams.kinetix_quirks`.
"""

import dataclasses
import functools
import math
from collections.abc import Callable
from typing import Any, Final

import jax
import jax.numpy as jnp
from jaxtyping import Array, Bool, Float, Int, Key, UInt

from kinetix.engine.spec import ARENA_BODIES, Capacity
from kinetix.engine.types import Joints
from kinetix.environment.generators.blocks import (
    BLUE,
    GREEN,
    MOTOR_BINDINGS,
)
from kinetix.environment.generators.draft import (
    Draft,
    empty_draft,
    shuffle_length,
    shuffled,
    spread,
    states,
)
from kinetix.environment.generators.draws import Tape, among, between, raw_keys, sampler_of
from kinetix.environment.generators.figures import (
    ARENA_SIDE,
    Figures,
    rotate,
)
from kinetix.environment.generators.params import UEDParams
from kinetix.environment.generators.sample import draw_floor_role
from kinetix.environment.params import PhysicsEngine
from kinetix.environment.state import EnvState
from kinetix.errors import KinetixError
from kinetix.level.model import InertiaModel
from kinetix.pytree import pytree, static

OVERLAP: Final = 0.05
"""Distance of a limb's joint from the end of the limb, inwards [m]."""
HIP_ANGLE: Final = math.pi / 8
"""Initial angle of the legs, to either side [rad]."""
LIMIT: Final = math.pi / 4
"""Every joint turns this far to either side [rad]."""
MOTOR_SPEED: Final = 1.0
MOTOR_POWER: Final = 3.0
PEER_RANDOM_BINDINGS: Final = 3
"""Q11 and Q12: the bindings that kinetix-env's random motors get."""
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

Exclude = tuple[float, float]
Row = Int[Array, " n"]


@pytree
class LocomotionParams:
    """The options of the locomotion family. Hashable and never traced, like `UEDParams`.

    A dimension is (width, height) [m]; it is drawn uniform in default·(1 ± ratio) per component,
    without the part default·(1 ± exclude) where that is set.
    """

    random_motors: bool = static(default=False)
    """True if the limbs' channels are drawn; otherwise each limb has its own."""
    body_rotation_range: float = static(default=0.0)
    """The body is turned by up to this much to either side [rad]."""
    body_dim_default: Exclude = static(default=(0.6, 0.2))
    leg_dim_default: Exclude = static(default=(0.1, 0.3))
    ankle_dim_default: Exclude = static(default=(0.1, 0.2))
    body_dim_sampling_ratio: float = static(default=0.5)
    leg_dim_sampling_ratio: float = static(default=0.5)
    ankle_dim_sampling_ratio: float = static(default=0.5)
    body_dim_exclude: float | None = static(default=None)
    leg_dim_exclude: float | None = static(default=None)
    ankle_dim_exclude: float | None = static(default=None)
    add_ankles: bool = static(default=True)
    num_random_legs_min: int = static(default=1)
    num_random_legs_max: int = static(default=1)
    """Limbs added at random, if there is room."""
    friction_default: float = static(default=1.0)
    friction_range: float = static(default=0.0)
    friction_exclude: float | None = static(default=None)
    """Friction is uniform in default ± range, outside default ± exclude."""
    density_default: float = static(default=1.0)
    density_range: float = static(default=0.0)
    density_exclude: float | None = static(default=None)
    """Density [kg/m²], likewise."""
    ensure_leg_dims_equal: bool = static(default=False)
    ensure_ankle_dims_equal: bool = static(default=False)
    ensure_limb_thickness_equal: bool = static(default=False)
    fix_goal_position: bool = static(default=False)
    """True if the goal is in the middle of its range."""
    do_permute_state: bool = static(default=False)
    kinetix_quirks: bool = static(default=True)
    inertia_model: InertiaModel = static(default="kinetix")
    legacy_ceiling: bool = static(default=False)


@pytree
class Limb:
    """One rectangle of the creature; all arrays over the worlds."""

    row: Row
    """Row in which the limb is listed."""
    position: Float[Array, "2 n"]
    rotation: Float[Array, " n"]
    size: Float[Array, "2 n"]
    """Width and height [m]."""


@pytree
class Trait:
    """Random properties of a limb besides its size."""

    friction: Float[Array, " n"]
    density: Float[Array, " n"]


def outside(
    u: Float[Array, "*r n"], default: float, spread: float, exclude: float | None
) -> Float[Array, "*r n"]:
    """Uniform in default ± spread, without the inner interval default ± exclude."""
    if exclude is None:
        return between(u, default - spread, default + spread)
    # Both outer intervals are equally long: one number picks the side and the place.
    reach = spread - exclude
    low = default - spread + 2 * u * reach
    return jnp.where(u < 0.5, low, low + 2 * exclude)


class _Creature:
    """Collects limbs and joints while the creature is put together."""

    def __init__(self, tape: Tape, worlds: int, params: LocomotionParams) -> None:
        self.tape, self.worlds, self.params = tape, worlds, params
        self.limbs: list[tuple[Limb, Trait, Bool[Array, " n"]]] = []
        self.joints: list[tuple[Joints, Array]] = []

    def dimension(self, part: str) -> Float[Array, "2 n"]:
        """Draw width and height of a body, leg or ankle."""
        params = self.params
        default = getattr(params, f"{part}_dim_default")
        ratio = getattr(params, f"{part}_dim_sampling_ratio")
        cut = getattr(params, f"{part}_dim_exclude")
        u = self.tape.take(2)
        return jnp.stack(
            [
                outside(u[k], size, size * ratio, None if cut is None else size * cut)
                for k, size in enumerate(default)
            ]
        )

    def surface(self) -> Float[Array, " n"]:
        """Draw a friction."""
        params = self.params
        return outside(
            self.tape.take(1)[0],
            params.friction_default,
            params.friction_range,
            params.friction_exclude,
        )

    def add(
        self,
        size: Float[Array, "2 n"],
        position: Float[Array, "2 n"],
        rotation: Float[Array, " n"],
        active: Bool[Array, " n"],
    ) -> Limb:
        """List one more limb."""
        params = self.params
        density = outside(
            self.tape.take(1)[0],
            params.density_default,
            params.density_range,
            params.density_exclude,
        )
        trait = Trait(friction=self.surface(), density=density)
        row = jnp.full((self.worlds,), ARENA_BODIES + len(self.limbs), jnp.int32)
        limb = Limb(row=row, position=position, rotation=rotation, size=size)
        self.limbs.append((limb, trait, active))
        return limb

    def hang(
        self,
        parent: Limb,
        anchor: Float[Array, "2 n"],
        size: Float[Array, "2 n"],
        angle: float,
        binding: Int[Array, " n"],
        active: Bool[Array, " n"],
    ) -> Limb:
        """Hang a limb by its top end from a place on its parent.

        Args:
            parent: What it hangs from.
            anchor: Where, in the parent's frame [m].
            size: Width and height of the new limb [m].
            angle: Its rotation relative to the parent [rad].
            binding: The motor's channel.
            active: In which worlds there is such a limb.
        """
        rotation = parent.rotation + angle
        own = jnp.stack([jnp.zeros_like(rotation), size[1] / 2 - OVERLAP])
        place = parent.position + rotate(anchor, parent.rotation)
        limb = self.add(size, place - rotate(own, rotation), rotation, active)
        constant = functools.partial(jnp.full, (self.worlds,))
        self.joints.append(
            (
                Joints(
                    body_a=parent.row,
                    body_b=limb.row,
                    anchor_a=anchor,
                    anchor_b=own,
                    active=active,
                    fixed=constant(False),
                    reference_angle=constant(0.0),
                    motor_on=active,
                    motor_speed=constant(MOTOR_SPEED),
                    motor_power=constant(MOTOR_POWER),
                    limited=active,
                    limit_min=constant(-LIMIT),
                    limit_max=constant(LIMIT),
                ),
                binding,
            )
        )
        return limb

    def binding(self, channel: int) -> Int[Array, " n"]:
        """The channel of a limb: its own, or drawn with random motors."""
        u = self.tape.take(1)[0]
        if not self.params.random_motors:
            return jnp.full((self.worlds,), channel, jnp.int32)
        return self.random_binding(u)

    def random_binding(self, u: Float[Array, " n"]) -> Int[Array, " n"]:
        """A drawn channel; Q11: kinetix-env never draws the last one."""
        quirks = self.params.kinetix_quirks
        return among(u, PEER_RANDOM_BINDINGS if quirks else MOTOR_BINDINGS)


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
    """Levels of the locomotion family, one per key.

    Args:
        keys: A level is a function of its key alone.
        capacity: Slots; there must be room for the body, two legs, their ankles and the goal.
        params: The options.
        ued: Only for the floor's role; None: neutral 0.75, red 0.25.

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
    creature = _Creature(tape, worlds, params)
    _assemble(creature, turn_u, mirror, count_u, most)
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


def _assemble(
    creature: _Creature,
    turn_u: Float[Array, " n"],
    mirror: Bool[Array, " n"],
    count_u: Float[Array, " n"],
    most: int,
) -> None:
    """Body, legs, ankles and the limbs at random."""
    params, worlds = creature.params, creature.worlds
    always = jnp.ones((worlds,), bool)
    turn = between(turn_u, -params.body_rotation_range, params.body_rotation_range)
    seed = jnp.stack([jnp.where(mirror, ARENA_SIDE, 0.0), jnp.zeros((worlds,))])
    body = creature.add(creature.dimension("body"), seed, turn, always)

    left_size, right_size = creature.dimension("leg"), creature.dimension("leg")
    if params.ensure_leg_dims_equal:
        right_size = left_size
    left_foot, right_foot = creature.dimension("ankle"), creature.dimension("ankle")
    if params.ensure_ankle_dims_equal:
        right_foot = left_foot

    def thick(size: Float[Array, "2 n"]) -> Float[Array, "2 n"]:
        equal = params.ensure_limb_thickness_equal
        return jnp.stack([left_size[0], size[1]]) if equal else size

    hip = jnp.stack([body.size[0] / 2 - OVERLAP, jnp.zeros((worlds,))])
    left = creature.hang(body, -hip, left_size, -HIP_ANGLE, creature.binding(0), always)
    right = creature.hang(body, hip, thick(right_size), HIP_ANGLE, creature.binding(1), always)
    if params.add_ankles:
        left = creature.hang(
            left, _bottom(left), thick(left_foot), 0.0, creature.binding(2), always
        )
        right = creature.hang(
            right, _bottom(right), thick(right_foot), 0.0, creature.binding(3), always
        )

    lowest = min(params.num_random_legs_min, most)
    highest = min(params.num_random_legs_max, most)
    count = lowest + among(count_u, highest - lowest + 1)
    tips = [body, left, right]
    for extra in range(highest):
        choice_u, binding_u = creature.tape.take(2)
        # Q12: kinetix-env never lengthens the right chain.
        choice = among(choice_u, 2 if params.kinetix_quirks else 3)
        parent = _chosen(tips, choice)
        active = extra < count
        size = thick(creature.dimension("leg"))
        binding = creature.random_binding(binding_u)
        limb = creature.hang(parent, _bottom(parent), size, 0.0, binding, active)
        tips = [_either((choice == index) & active, limb, tip) for index, tip in enumerate(tips)]


def _bottom(limb: Limb) -> Float[Array, "2 n"]:
    """The bottom end of a limb, a little inside, in its frame [m]."""
    return jnp.stack([jnp.zeros_like(limb.rotation), OVERLAP - limb.size[1] / 2])


def _either(condition: Bool[Array, " n"], limb: Limb, other: Limb) -> Limb:
    return Limb(
        row=jnp.where(condition, limb.row, other.row),
        position=jnp.where(condition[None], limb.position, other.position),
        rotation=jnp.where(condition, limb.rotation, other.rotation),
        size=jnp.where(condition[None], limb.size, other.size),
    )


def _chosen(tips: list[Limb], choice: Int[Array, " n"]) -> Limb:
    parent = tips[0]
    for index, tip in enumerate(tips[1:], start=1):
        parent = _either(choice == index, tip, parent)
    return parent


def _put_together(
    creature: _Creature, mirror: Bool[Array, " n"], goal_u: Float[Array, " n"], capacity: Capacity
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
    x = jnp.broadcast_to(jnp.where(mirror, ARENA_SIDE - x, x), (worlds,))
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
    """The bodies with these fields in these slots, where they are active."""
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


@functools.cache
def locomotion_sampler(
    engine: PhysicsEngine,
    params: LocomotionParams | None = None,
    ued: UEDParams | None = None,
) -> Callable[[Key[Array, ""]], EnvState]:
    """The function from a key to a locomotion level, to be used under jit and vmap.

    Args:
        engine: Sizes and solver.
        params: The options; None for the defaults.
        ued: Only for the floor's role.
    """
    options = params or LocomotionParams()

    def batched(keys: UInt[Array, "n 2"]) -> EnvState:
        draft = draw_locomotion(keys, engine.spec.capacity, options, ued)
        return states(draft, engine, options.inertia_model)

    return sampler_of(batched)
