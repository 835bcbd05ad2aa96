"""Proposals for a new body, and the facts that they depend on."""

import jax.numpy as jnp
from jaxtyping import Array, Bool, Float, Int

from kinetix.environment.generators.figures import Figures
from kinetix.environment.generators.params import UEDParams
from kinetix.environment.goal import BLUE, GREEN, RED
from kinetix.pytree import pytree


@pytree
class Surroundings:
    """Facts about a level that a new shape depends on; one row, to broadcast over proposals."""

    polygon_room: Bool[Array, "1 n"]
    circle_room: Bool[Array, "1 n"]
    joint_room: Bool[Array, "1 n"]
    green_missing: Bool[Array, "1 n"]
    blue_missing: Bool[Array, "1 n"]
    red_missing: Bool[Array, "1 n"]


@pytree
class SizeLimit:
    """Largest size of new shapes."""

    limit: Float[Array, "1 n"] | float
    """M [m]."""
    goal_factor: Float[Array, "1 n"] | float
    """Factor on M for free green and blue bodies."""


@pytree
class Proposals:
    """Proposals for one new body. `figure.active` says whether there is a body at all."""

    figure: Figures
    joint: Bool[Array, "q n"]
    """True where it comes with a joint."""
    target: Int[Array, "q n"]
    """Row of the body that it is jointed to."""
    target_circle: Bool[Array, "q n"]
    target_rotation: Float[Array, "q n"]
    anchor: Float[Array, "q 2 n"]
    """Attachment in the new body's frame [m]."""
    target_anchor: Float[Array, "q 2 n"]
    """Attachment in the target's frame [m]."""
    target_first: Bool[Array, "q n"]
    """True where the target is body a of the joint."""
    valid: Bool[Array, "q n"]
    """False where a jointed shape was asked for and none came about, or one hides the other."""


def size_limit(ued: UEDParams) -> SizeLimit:
    """Return the limits of the options."""
    return SizeLimit(limit=ued.max_shape_size, goal_factor=ued.goal_body_size_factor)


def look_around(
    figures: Figures,
    *,
    polygon_room: Bool[Array, " n"],
    circle_room: Bool[Array, " n"],
    joint_room: Bool[Array, " n"],
) -> Surroundings:
    """Return which roles are missing and which slots are free."""

    def missing(role: int) -> Bool[Array, "1 n"]:
        return ~jnp.any(figures.active & (figures.role == role), axis=0, keepdims=True)

    return Surroundings(
        polygon_room=polygon_room[None],
        circle_room=circle_room[None],
        joint_room=joint_room[None],
        green_missing=missing(GREEN),
        blue_missing=missing(BLUE),
        red_missing=missing(RED),
    )
