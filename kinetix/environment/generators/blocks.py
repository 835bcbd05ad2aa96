"""The building blocks of random levels: a free shape, a jointed shape, a thruster.

A block draws `q` proposals for one new body at once, as rows of its own; who calls it chooses one
and writes it where there is room. Per-world facts carry a first axis of one, so that they broadcast
over the proposals.

Q1 … Q8 are the quirks of `UEDParams.kinetix_quirks`.
"""

import dataclasses
import math
from typing import Final

import jax.numpy as jnp
from jaxtyping import Array, Bool, Float, Int

from kinetix.engine.types import Joints, Thrusters
from kinetix.environment.generators.draws import (
    JointDraws,
    ShapeDraws,
    ThrusterDraws,
    among,
    between,
    choose,
)
from kinetix.environment.generators.figures import (
    ARENA_SIDE,
    FLOOR_TOP,
    VERTICES,
    Figures,
    area,
    bounds,
    has_vertex,
    mass,
    movable_rows,
    pick,
    rotate,
)
from kinetix.environment.generators.params import UEDParams
from kinetix.pytree import pytree

MIN_HALF_SIDE: Final = 0.05
"""Least half extent of a rectangle [m]."""
MIN_RADIUS: Final = 0.1
"""Least radius of a circle [m]."""
MOTOR_BINDINGS: Final = 4
THRUSTER_BINDINGS: Final = 2
PEER_WELD_CHANCE: Final = 0.5
"""Q1: what kinetix-env uses in place of `UEDParams.joint_fixed_chance`."""
NEUTRAL, GREEN, BLUE, RED = range(4)


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
    """The limits that the options say."""
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


def draw_role(
    u: Float[Array, "q n"],
    around: Surroundings,
    allowed: tuple[Bool[Array, "q n"] | bool, ...] = (True, True, True, True),
) -> Int[Array, "q n"]:
    """Draw a role: green and blue first, later one red in four until there is a red body.

    Args:
        u: Uniform numbers.
        around: Which roles are missing.
        allowed: The prior, per role; the draw is neutral where nothing allowed is left.
    """
    complete = ~(around.green_missing | around.blue_missing)
    weights = [
        jnp.where(possible & allow, weight, 0.0)
        for possible, allow, weight in zip(
            (complete, around.green_missing, around.blue_missing, complete & around.red_missing),
            allowed,
            (1.0, 1.0, 1.0, 1 / 3),
            strict=True,
        )
    ]
    first = weights[0]
    second = first + weights[1]
    third = second + weights[2]
    total = third + weights[3]
    threshold = u * total
    role = sum((threshold >= level).astype(jnp.int32) for level in (first, second, third))
    return jnp.where(total > 0, role, NEUTRAL)


def _draw_figure(
    draws: ShapeDraws,
    circle: Bool[Array, "q n"],
    limit: Float[Array, "q n"] | Float[Array, "1 n"] | float,
    ued: UEDParams,
) -> tuple[Figures, Float[Array, "q n"]]:
    """Shape and rotation of a new body at the origin, and its extent [m] for free placing."""
    longest = limit / (2 * math.sqrt(2)) - MIN_HALF_SIDE
    largest_radius = ued.circle_max_size_coeff * limit / 2
    half_x = jnp.where(circle, MIN_HALF_SIDE, MIN_HALF_SIDE + draws.size_x * longest)
    half_y = jnp.where(circle, MIN_HALF_SIDE, MIN_HALF_SIDE + draws.size_y * longest)
    long = draws.long < ued.large_rect_dim_chance
    along_x = draws.long_axis < 0.5
    half_x = jnp.where(long & along_x, half_x * ued.large_rect_dim_scale, half_x)
    half_y = jnp.where(long & ~along_x, half_y * ued.large_rect_dim_scale, half_y)
    radius = MIN_RADIUS + jnp.where(circle, draws.size_x * (largest_radius - MIN_RADIUS), 0.0)
    reach = jnp.maximum(half_x, half_y) * math.sqrt(2)
    # Q3: what the other kind would have measured counts too.
    extent = jnp.maximum(reach, radius) if ued.kinetix_quirks else jnp.where(circle, radius, reach)
    vertices, count = _corners(draws, circle, half_x, half_y, ued)
    figure = Figures(
        position=jnp.zeros_like(vertices[..., 0, :, :]),
        rotation=draws.rotation * (2 * math.pi),
        vertices=jnp.where(circle[..., None, None, :], 0.0, vertices),
        vertex_count=count,
        radius=jnp.where(circle, radius, 0.0),
        circle=circle,
        role=jnp.zeros(circle.shape, jnp.int32),
        density=jnp.ones_like(radius),
        fixed=jnp.zeros_like(circle),
        active=jnp.ones_like(circle),
    )
    return figure, extent


def new_dimensions(
    draws: ShapeDraws,
    circle: Bool[Array, "q n"],
    limit: Float[Array, "1 n"] | float,
    ued: UEDParams,
) -> Figures:
    """A shape as a new body would have it, at the origin: a rectangle, or a circle where asked."""
    return _draw_figure(draws, circle, limit, dataclasses.replace(ued, generate_triangles=False))[0]


def _corners(
    draws: ShapeDraws,
    circle: Bool[Array, "q n"],
    half_x: Float[Array, "q n"],
    half_y: Float[Array, "q n"],
    ued: UEDParams,
) -> tuple[Float[Array, "q 4 2 n"], Int[Array, "q n"]]:
    """Corners in kinetix-env's clockwise order, around their mean, and how many there are."""
    signs = ((1.0, 1.0), (1.0, -1.0), (-1.0, -1.0), (-1.0, 1.0))
    corners = [jnp.stack([x * half_x, y * half_y], axis=-2) for x, y in signs]
    count = jnp.full(circle.shape, VERTICES, jnp.int32)
    if ued.generate_triangles:
        triangle = ((draws.corners < 0.5) & ~circle)[..., None, :]
        mean = (corners[0] + corners[1] + corners[2]) / 3
        corners = [jnp.where(triangle, corner - mean, corner) for corner in corners[:3]] + [
            jnp.where(triangle, 0.0, corners[3])
        ]
        count = jnp.where(triangle[..., 0, :], 3, count)
    return jnp.stack(corners, axis=-3), count


def free_shape(
    draws: ShapeDraws,
    around: Surroundings,
    force_no_fixate: Bool[Array, "1 n"] | bool,
    ued: UEDParams,
    size: SizeLimit,
) -> Proposals:
    """Draw free bodies; none where no slot is free.

    Args:
        draws: Uniform numbers.
        around: What there is room for, and which roles are missing.
        force_no_fixate: The body must be able to move.
        ued: The options.
        size: How large it may be.
    """
    at_x, at_y, opposite, fixate, lower, _ = draws.further
    circle = around.circle_room & (~around.polygon_room | (draws.kind < 0.5))
    role = draw_role(draws.role, around)
    has_goal_role = (role == GREEN) | (role == BLUE)
    limit = jnp.where(has_goal_role, size.limit * size.goal_factor, size.limit)
    figure, extent = _draw_figure(draws, circle, limit, ued)

    kept_apart = opposite < ued.goal_body_opposide_side_chance
    half = ARENA_SIDE / 2
    least_x = extent + jnp.where(kept_apart & (role == BLUE), half, 0.0)
    most_x = ARENA_SIDE - extent - jnp.where(kept_apart & (role == GREEN), half, 0.0)
    x = between(at_x, least_x, most_x)
    y = between(at_y, FLOOR_TOP + extent, ARENA_SIDE - extent)

    chance = jnp.minimum(
        ued.fixate_chance_max, ued.fixate_chance_min + ued.fixate_chance_scale * area(figure)
    )
    fixed = (fixate < chance) & ~jnp.asarray(force_no_fixate)
    bias = jnp.where(
        role == NEUTRAL, ued.fixate_shape_bottom_bias, ued.fixate_shape_bottom_bias_special_role
    )
    lowered = y - half
    if not ued.kinetix_quirks:
        # Q4: kinetix-env lets it sink into the floor.
        lowered = jnp.maximum(lowered, FLOOR_TOP + extent)
    y = jnp.where(fixed & (lower < bias) & (y >= half), lowered, y)

    figure = dataclasses.replace(
        figure,
        position=jnp.stack([x, y], axis=-2),
        role=role,
        fixed=fixed,
        active=jnp.broadcast_to(around.polygon_room | around.circle_room, x.shape),
    )
    nothing = jnp.zeros_like(circle)
    origin = jnp.zeros_like(figure.position)
    return Proposals(
        figure=figure,
        joint=nothing,
        target=jnp.zeros(x.shape, jnp.int32),
        target_circle=nothing,
        target_rotation=jnp.zeros_like(x),
        anchor=origin,
        target_anchor=origin,
        target_first=nothing,
        valid=jnp.ones_like(circle),
    )


def _target_weights(
    figures: Figures, joint_counts: Int[Array, "b n"]
) -> tuple[Float[Array, "b n"], Float[Array, "b n"]]:
    """Weights of polygons and of circles as partners of a new joint, fixed bodies at 1."""
    body = movable_rows(figures)
    free_ends = jnp.maximum(0.0, (2.0 - joint_counts.astype(jnp.float32)) / 2)
    polygon = jnp.where(body & ~figures.circle, free_ends, 0.0)
    circle = jnp.where(body & figures.circle & (joint_counts == 0), 1.0, 0.0)
    return polygon, circle


def _anchor(
    figures: Figures, u: Float[Array, "q n"], v: Float[Array, "q n"], *, triangles: bool
) -> Float[Array, "q 2 n"]:
    """A place uniform in a polygon; the centre of a circle [m, body's frame]."""
    low, high = bounds(figures)
    place = jnp.stack(
        [
            between(u, low[..., 0, :], high[..., 0, :]),
            between(v, low[..., 1, :], high[..., 1, :]),
        ],
        axis=-2,
    )
    if triangles:
        # Folding the unit square along its diagonal keeps the density uniform.
        outside = u + v > 1
        s = jnp.where(outside, 1 - u, u)[..., None, :]
        t = jnp.where(outside, 1 - v, v)[..., None, :]
        first, second, third = (figures.vertices[..., k, :, :] for k in range(3))
        within = first + s * (second - first) + t * (third - first)
        place = jnp.where((figures.vertex_count == 3)[..., None, :], within, place)
    return jnp.where(figures.circle[..., None, :], 0.0, place)


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
    partner: Figures = _pick_figures(figures, target)

    circle = around.circle_room & (draws.kind < 0.5) & ~target_circle
    circle = circle | (around.circle_room & ~around.polygon_room)
    figure, _ = _draw_figure(draws, circle, size.limit, ued)
    anchor = _anchor(figure, u, v, triangles=ued.generate_triangles)
    target_anchor = _anchor(
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


def _pick_figures(figures: Figures, index: Int[Array, "q n"]) -> Figures:
    return Figures(
        **{name: pick(getattr(figures, name), index) for name in figures.__dataclass_fields__}
    )


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


def thrusters_on(
    draws: ThrusterDraws,
    figures: Figures,
    eligible: Bool[Array, "b n"],
    ued: UEDParams,
    *,
    order: Int[Array, "k n"] | None = None,
    triangles: bool = False,
) -> tuple[Thrusters, Int[Array, "t n"]]:
    """Draw thrusters, each on one of the eligible bodies, and their channels.

    A thruster is inactive where no body is eligible.

    Args:
        draws: Uniform numbers for `t` thrusters.
        figures: The bodies.
        eligible: Which of them may carry one (they must be able to move).
        ued: The options.
        order: The slots to choose from, one after the other (−1: none); by default all of them.
        triangles: Whether there may be triangles among the bodies.
    """
    if order is not None:
        eligible = pick(eligible, order) & (order >= 0)
    body = choose(draws.body, eligible.astype(jnp.float32))
    body = body if order is None else pick(order, body)
    carrier = _pick_figures(figures, body)
    turn = draws.place_x * (2 * math.pi)
    distance = draws.place_y * carrier.radius
    on_disc = jnp.stack([distance * jnp.cos(turn), distance * jnp.sin(turn)], axis=-2)
    within = _anchor(
        carrier, draws.place_x, draws.place_y, triangles=triangles or ued.generate_triangles
    )
    position = jnp.where(carrier.circle[..., None, :], on_disc, within)
    x, y = position[..., 0, :], position[..., 1, :]
    outward = jnp.where((x == 0) & (y == 0), 0.0, jnp.arctan2(y, x))
    # One number for both: half of the aligned thrusters push inwards.
    inward = draws.angle >= 0.5
    aligned = jnp.where(inward, outward + math.pi, outward)
    along = draws.aligned < ued.thruster_align_com_prob
    push = ued.thruster_power_multiplier * between(draws.power, 0.5, 2.0)
    thrusters = Thrusters(
        body=body,
        position=position,
        angle=jnp.where(along, aligned, draws.angle * (2 * math.pi)),
        power=mass(carrier) * push,
        active=jnp.broadcast_to(jnp.any(eligible, axis=0, keepdims=True), x.shape),
    )
    return thrusters, among(draws.binding, THRUSTER_BINDINGS)
