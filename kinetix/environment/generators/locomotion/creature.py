"""A creature put together: limbs of random sizes, joined to each other by motors."""

import functools
import math
from typing import Final

import jax.numpy as jnp
from jaxtyping import Array, Bool, Float, Int

from kinetix.engine.spec import ARENA_BODIES
from kinetix.engine.types import Joints
from kinetix.environment.generators.draws import Tape, among, between
from kinetix.environment.generators.figures import rotate
from kinetix.environment.generators.locomotion.params import LocomotionParams
from kinetix.level.geometry import ARENA_WIDTH
from kinetix.level.model import MOTOR_BINDINGS
from kinetix.pytree import pytree

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

Row = Int[Array, " n"]


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
    """Return a number uniform in default ± spread, without the inner interval default ± exclude."""
    if exclude is None:
        return between(u, default - spread, default + spread)
    # Both outer intervals are equally long: one number picks the side and the place.
    reach = spread - exclude
    low = default - spread + 2 * u * reach
    return jnp.where(u < 0.5, low, low + 2 * exclude)


class Creature:
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
        """Attach a limb by its top end to a place on its parent.

        Args:
            parent: The limb that it is attached to.
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
        """Return the channel of a limb: its own, or drawn with random motors."""
        u = self.tape.take(1)[0]
        if not self.params.random_motors:
            return jnp.full((self.worlds,), channel, jnp.int32)
        return self.random_binding(u)

    def random_binding(self, u: Float[Array, " n"]) -> Int[Array, " n"]:
        """Return a drawn channel; Q11: kinetix-env never draws the last one."""
        quirks = self.params.kinetix_quirks
        return among(u, PEER_RANDOM_BINDINGS if quirks else MOTOR_BINDINGS)


def assemble(
    creature: Creature,
    turn_u: Float[Array, " n"],
    mirror: Bool[Array, " n"],
    count_u: Float[Array, " n"],
    most: int,
) -> None:
    """Body, legs, ankles and the limbs at random."""
    params, worlds = creature.params, creature.worlds
    always = jnp.ones((worlds,), bool)
    turn = between(turn_u, -params.body_rotation_range, params.body_rotation_range)
    seed = jnp.stack([jnp.where(mirror, ARENA_WIDTH, 0.0), jnp.zeros((worlds,))])
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
