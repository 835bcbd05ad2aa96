"""New shapes: roles, sizes, and the placement of bodies without joints."""

import dataclasses
import math
from typing import Final

import jax.numpy as jnp
from jaxtyping import Array, Bool, Float, Int

from kinetix.environment.generators.blocks.proposals import Proposals, SizeLimit, Surroundings
from kinetix.environment.generators.draws import ShapeDraws, between
from kinetix.environment.generators.figures import VERTICES, Figures, area
from kinetix.environment.generators.params import UEDParams
from kinetix.environment.goal import BLUE, GREEN, NEUTRAL
from kinetix.level.geometry import ARENA_WIDTH, FLOOR_TOP

MIN_HALF_SIDE: Final = 0.05
"""Least half extent of a rectangle [m]."""
MIN_RADIUS: Final = 0.1
"""Least radius of a circle [m]."""


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


def draw_figure(
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
    return draw_figure(draws, circle, limit, dataclasses.replace(ued, generate_triangles=False))[0]


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
    figure, extent = draw_figure(draws, circle, limit, ued)

    kept_apart = opposite < ued.goal_body_opposide_side_chance
    half = ARENA_WIDTH / 2
    least_x = extent + jnp.where(kept_apart & (role == BLUE), half, 0.0)
    most_x = ARENA_WIDTH - extent - jnp.where(kept_apart & (role == GREEN), half, 0.0)
    x = between(at_x, least_x, most_x)
    y = between(at_y, FLOOR_TOP + extent, ARENA_WIDTH - extent)

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
