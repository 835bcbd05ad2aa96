"""New shapes that are jointed to one that is there, and their joints."""

import dataclasses
from typing import Final

import jax.numpy as jnp
from jaxtyping import Array, Bool, Float, Int

from kinetix.engine.types import Joints
from kinetix.environment.generators.blocks.places import pick_figures, place_within
from kinetix.environment.generators.blocks.proposals import Proposals, SizeLimit, Surroundings
from kinetix.environment.generators.blocks.shapes import draw_figure, draw_role
from kinetix.environment.generators.draws import JointDraws, ShapeDraws, among, between, choose
from kinetix.environment.generators.figures import (
    VERTICES,
    Figures,
    has_vertex,
    movable_rows,
    rotate,
)
from kinetix.environment.generators.params import UEDParams
from kinetix.environment.goal import BLUE, GREEN, NEUTRAL, RED
from kinetix.level.model import MOTOR_BINDINGS

PEER_WELD_CHANCE: Final = 0.5
"""Q1: what kinetix-env uses in place of `UEDParams.joint_fixed_chance`."""


def connected_shape(  # noqa: PLR0913 (one more than the limit, all of them different things)
    draws: ShapeDraws,
    figures: Figures,
    joint_counts: Int[Array, "b n"],
    around: Surroundings,
    ued: UEDParams,
    size: SizeLimit,
    *,
    new_polygon_row: Int[Array, "1 n"] | int,
    triangles: bool = False,
) -> Proposals:
    """Draw bodies that are jointed to one that is there; none where that is not possible.

    Args:
        draws: Uniform numbers.
        figures: The bodies that are there.
        joint_counts: How many active joints each of them has.
        around: What there is room for, and which roles are missing.
        ued: The options.
        size: How large it may be.
        new_polygon_row: Where a new polygon would be listed: of two polygons the first listed is
            body a (polygons come before circles in any case, a new circle comes last).
        triangles: Whether the bodies that are there may be triangles.
    """
    kind_u, target_u, u, v, target_u1, target_u2 = draws.further
    polygon_weights, circle_weights = _target_weights(figures, joint_counts)
    target_circle, target, found = _draw_target(
        kind_u, target_u, figures, polygon_weights, circle_weights, around, ued
    )
    partner: Figures = pick_figures(figures, target)

    circle = around.circle_room & (draws.kind < 0.5) & ~target_circle
    circle = circle | (around.circle_room & ~around.polygon_room)
    figure, _ = draw_figure(draws, circle, size.limit, ued)
    anchor = place_within(figure, u, v, triangles=ued.generate_triangles)
    target_anchor = place_within(
        partner, target_u1, target_u2, triangles=triangles or ued.generate_triangles
    )
    joint_place = partner.position + rotate(target_anchor, partner.rotation)
    position = joint_place - rotate(anchor, figure.rotation)

    neutral = partner.role == NEUTRAL
    allowed = (True, neutral | (partner.role == GREEN), neutral | (partner.role == BLUE))
    role = draw_role(draws.role, around, (*allowed, neutral | (partner.role == RED)))

    exists = found & around.joint_room & (around.polygon_room | around.circle_room)
    target_first = jnp.where(circle, True, ~target_circle & (target < new_polygon_row))
    figure = dataclasses.replace(figure, position=position, role=role, active=exists)
    if ued.kinetix_quirks:
        # Q8: the anchors were swapped with the bodies' order, but the bodies were not.
        swapped = target_first[..., None, :]
        own = jnp.where(swapped, target_anchor, anchor)
        others = jnp.where(swapped, anchor, target_anchor)
    else:
        own, others = anchor, target_anchor
    seen = _sticks_out(figure, own, partner, others, ued) & _sticks_out(
        partner, others, figure, own, ued
    )
    return Proposals(
        figure=figure,
        joint=exists,
        target=target,
        target_circle=target_circle,
        target_rotation=partner.rotation,
        anchor=anchor,
        target_anchor=target_anchor,
        target_first=target_first,
        valid=exists & seen,
    )


def _target_weights(
    figures: Figures, joint_counts: Int[Array, "b n"]
) -> tuple[Float[Array, "b n"], Float[Array, "b n"]]:
    """Return weights of polygons and of circles as partners of a new joint, fixed bodies at 1."""
    body = movable_rows(figures)
    free_ends = jnp.maximum(0.0, (2.0 - joint_counts.astype(jnp.float32)) / 2)
    polygon = jnp.where(body & ~figures.circle, free_ends, 0.0)
    circle = jnp.where(body & figures.circle & (joint_counts == 0), 1.0, 0.0)
    return polygon, circle


def _draw_target(
    kind_u: Float[Array, "q n"],
    target_u: Float[Array, "q n"],
    figures: Figures,
    polygon_weights: Float[Array, "b n"],
    circle_weights: Float[Array, "b n"],
    around: Surroundings,
    ued: UEDParams,
) -> tuple[Bool[Array, "q n"], Int[Array, "q n"], Bool[Array, "q n"]]:
    """Draw the partner of a new shape: circle or polygon, its row, and whether there is one."""
    body = movable_rows(figures)
    fixed_weight = jnp.where(figures.fixed, ued.connect_to_fixated_prob_coeff, 1.0)
    some_polygon = jnp.any(body & ~figures.circle, axis=0, keepdims=True)
    # A fixed circle counts with its weight before the 0.05, which is positive all the same.
    some_circle = jnp.any(circle_weights > 0, axis=0, keepdims=True)
    target_circle = some_circle & (~some_polygon | (kind_u < 0.5)) & around.polygon_room
    polygon_weights = polygon_weights * fixed_weight
    circle_weights = circle_weights * fixed_weight
    hopeless = ~jnp.any(polygon_weights > 0, axis=0, keepdims=True)
    exists = jnp.any(body, axis=0, keepdims=True)
    if ued.kinetix_quirks:
        # Q5: where every polygon is taken, any active one will do, walls and floor included.
        anyone = (figures.active & ~figures.circle).astype(jnp.float32)
        polygon_weights = jnp.where(hopeless, anyone, polygon_weights)
        found = jnp.broadcast_to(exists, target_circle.shape)
    else:
        found = exists & (target_circle | ~hopeless)
    target = jnp.where(
        target_circle, choose(target_u, circle_weights), choose(target_u, polygon_weights)
    )
    return target_circle, target, found


def _sticks_out(
    small: Figures,
    small_anchor: Float[Array, "q 2 n"],
    big: Figures,
    big_anchor: Float[Array, "q 2 n"],
    ued: UEDParams,
) -> Bool[Array, "q n"]:
    """Return whether the small body reaches beyond the big one in a full turn about the joint."""
    away = small.vertices - small_anchor[..., None, :, :]
    squares = away[..., 0, :] ** 2 + away[..., 1, :] ** 2
    real = jnp.stack([has_vertex(small, k) for k in range(VERTICES)], axis=-2)
    farthest = jnp.sqrt(jnp.max(jnp.where(real, squares, 0.0), axis=-2))
    half = jnp.max(jnp.abs(big.vertices), axis=-3)
    slack = jnp.min(half - jnp.abs(big_anchor), axis=-2)
    reach = jnp.where(small.circle, small.radius, farthest)
    cover = jnp.where(big.circle, big.radius, slack)
    return (reach > cover + ued.connect_visibility_min) & ~(small.circle & big.circle)


def joint_of(
    proposal: Proposals,
    new_row: Int[Array, " n"] | int,
    draws: JointDraws,
    *,
    force_rjoint: Bool[Array, " n"] | bool,
    revolute_count: Int[Array, " n"],
    ued: UEDParams,
) -> tuple[Joints, Int[Array, " n"]]:
    """Return the joint of a chosen proposal (its axis `q` is gone), and its motor's channel.

    The joint is inactive where the proposal has none.

    Args:
        proposal: The chosen one of `connected_shape`.
        new_row: Where the new body is listed.
        draws: Uniform numbers.
        force_rjoint: It must be revolute, because the level needs a motor.
        revolute_count: Active revolute joints that the level has.
        ued: The options.
    """
    weld_chance = PEER_WELD_CHANCE if ued.kinetix_quirks else ued.joint_fixed_chance
    weld = draws.weld >= 1 - weld_chance
    weld = weld & ~jnp.asarray(force_rjoint) & (revolute_count >= ued.min_rjoints_bias)
    first = proposal.target_first
    new_row = jnp.broadcast_to(jnp.asarray(new_row, jnp.int32), first.shape)
    turn = proposal.target_rotation - proposal.figure.rotation
    reference = jnp.where(first, -turn, turn)
    if ued.kinetix_quirks:
        # Q7: limits of kinetix-env's revolute joints are measured from the absolute difference.
        reference = jnp.where(weld, reference, 0.0)
    rectangles = ~proposal.figure.circle & ~proposal.target_circle
    motor_on = draws.motor_on < ued.motor_on_chance
    if not ued.kinetix_quirks:
        # Q6: kinetix-env's forced motor is off in one level of five.
        motor_on = motor_on | jnp.asarray(force_rjoint)
    most_power = jnp.where(rectangles, ued.motor_max_power, ued.wheel_max_power)
    speed = between(draws.speed, ued.motor_min_speed, ued.motor_max_speed)
    limited = (draws.limited < ued.joint_limit_chance) & rectangles & ~weld
    motor = proposal.joint & ~weld
    joint = Joints(
        body_a=jnp.where(first, proposal.target, new_row),
        body_b=jnp.where(first, new_row, proposal.target),
        anchor_a=jnp.where(first[None], proposal.target_anchor, proposal.anchor),
        anchor_b=jnp.where(first[None], proposal.anchor, proposal.target_anchor),
        active=proposal.joint,
        fixed=weld & proposal.joint,
        reference_angle=reference,
        motor_on=motor_on & motor,
        motor_speed=jnp.where(motor, speed, 0.0),
        motor_power=jnp.where(motor, between(draws.power, ued.motor_min_power, most_power), 0.0),
        limited=limited & proposal.joint,
        limit_min=jnp.where(limited, between(draws.limit_min, -ued.joint_limit_max, 0.0), 0.0),
        limit_max=jnp.where(limited, between(draws.limit_max, 0.0, ued.joint_limit_max), 0.0),
    )
    return joint, among(draws.binding, MOTOR_BINDINGS)
