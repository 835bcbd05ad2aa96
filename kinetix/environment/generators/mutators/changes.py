"""Mutations that change what is there.

Q9 and Q10 are quirks of `UEDParams.kinetix_quirks`.
"""

import dataclasses
import math
from typing import Final

import jax
import jax.numpy as jnp
from jaxtyping import Array, Bool, Float, Int

from kinetix.engine.spec import Capacity
from kinetix.environment.generators.blocks import new_dimensions, size_limit
from kinetix.environment.generators.draft import Draft, components, hit, spread
from kinetix.environment.generators.draws import PER_SHAPE, between, shape_draws
from kinetix.environment.generators.figures import (
    VERTICES,
    Figures,
    bounds,
    centroid,
    has_vertex,
    movable_rows,
    pick,
    rotate,
)
from kinetix.environment.generators.mutators.picking import (
    Marks,
    Numbers,
    any_row,
    ends,
    one_body,
    some,
    with_figures,
)
from kinetix.environment.generators.params import UEDParams
from kinetix.level.geometry import ARENA_WIDTH, FLOOR_TOP

LARGEST_STEP: Final = 0.5
"""Largest shift of a body along each axis [m]."""
LARGEST_TURN: Final = math.pi / 2
"""Largest rotation of a body [rad]."""
MUTATED_GRAVITY: Final = -9.8
"""Gravity that half of the mutated levels get, and the strongest of the others [m/s²]."""
OFF_CENTRE: Final = 1e-5
"""Largest distance of a frame's origin from the centre of mass that is left alone [m]."""


def swap_role(
    draft: Draft, numbers: Numbers, marked: Marks, ued: UEDParams, capacity: Capacity
) -> Draft:
    """Exchange the roles of two bodies whose roles differ."""
    del ued, capacity
    bodies, role = movable_rows(draft.figures), draft.figures.role
    first = some(bodies, numbers[0])
    first_role = pick(role, first)
    others = bodies & (role != first_role[None])
    second = some(others, numbers[1])
    marked = marked & any_row(bodies) & any_row(others)
    role = jnp.where(hit(role, first, marked), pick(draft.figures.role, second)[None], role)
    return with_figures(draft, role=jnp.where(hit(role, second, marked), first_role[None], role))


def toggle_fixture(
    draft: Draft, numbers: Numbers, marked: Marks, ued: UEDParams, capacity: Capacity
) -> Draft:
    """Fix a body, or free a fixed one, which then turns about its centre of mass."""
    del capacity
    _, body = one_body(draft, numbers[0], marked)
    draft = _recentred(draft, body & draft.figures.fixed, ued)
    return with_figures(draft, fixed=draft.figures.fixed ^ body)


def _recentred(draft: Draft, freed: Bool[Array, "b n"], ued: UEDParams) -> Draft:
    """Make the centre of mass of some bodies the origin of their frames; nothing moves."""
    figures, joints, thrusters = draft.figures, draft.joints, draft.thrusters
    shift = centroid(figures, ued.inertia_model)
    # Rounding alone is no reason to touch a body.
    off = jnp.max(jnp.abs(shift), axis=1) > OFF_CENTRE
    shift = jnp.where((freed & off & ~figures.circle)[:, None], shift, 0.0)
    real = jnp.stack([has_vertex(figures, k) for k in range(VERTICES)], axis=1)[:, :, None]
    return dataclasses.replace(
        draft,
        figures=dataclasses.replace(
            figures,
            vertices=figures.vertices - jnp.where(real, shift[:, None], 0.0),
            position=figures.position + rotate(shift, figures.rotation),
        ),
        joints=dataclasses.replace(
            joints,
            anchor_a=joints.anchor_a - pick(shift, joints.body_a),
            anchor_b=joints.anchor_b - pick(shift, joints.body_b),
        ),
        thrusters=dataclasses.replace(
            thrusters, position=thrusters.position - pick(shift, thrusters.body)
        ),
    )


def change_gravity(
    draft: Draft, numbers: Numbers, marked: Marks, ued: UEDParams, capacity: Capacity
) -> Draft:
    """Ordinary gravity, or any weaker one."""
    del ued, capacity
    pull = jnp.where(numbers[0] < 0.5, 1.0, numbers[1]) * MUTATED_GRAVITY
    gravity = jnp.stack([jnp.zeros_like(pull), pull])
    return dataclasses.replace(draft, gravity=jnp.where(marked[None], gravity, draft.gravity))


def change_size(
    draft: Draft, numbers: Numbers, marked: Marks, ued: UEDParams, capacity: Capacity
) -> Draft:
    """Give a body new dimensions, its anchors with it; jointed bodies are to be settled."""
    del capacity
    row, body = one_body(draft, numbers[-1], marked)
    old = draft.figures
    circle = pick(old.circle, row)
    draws = shape_draws(numbers[:PER_SHAPE, None])
    new = jax.tree.map(
        lambda leaf: leaf[0], new_dimensions(draws, circle[None], size_limit(ued).limit, ued)
    )
    # The drawn rectangle is the size of the bounding box, whatever the shape.
    was = _half_extents(pick(old.vertices, row), pick(old.vertex_count, row))
    drawn = _half_extents(new.vertices, new.vertex_count)
    scale = jnp.where(was > 1e-6, drawn / jnp.maximum(was, 1e-6), 1.0)
    round_scale = new.radius / jnp.maximum(pick(old.radius, row), 1e-6)
    scale = jnp.where(circle[None], round_scale[None], scale)
    figures = dataclasses.replace(
        old,
        vertices=jnp.where(
            spread(body, old.vertices), old.vertices * scale[None, None], old.vertices
        ),
        radius=jnp.where(body & circle[None], new.radius[None], old.radius),
    )
    joints, thrusters = draft.joints, draft.thrusters
    at_a, at_b = (end[:, None] for end in ends(joints, body))
    joints = dataclasses.replace(
        joints,
        anchor_a=jnp.where(at_a, joints.anchor_a * scale[None], joints.anchor_a),
        anchor_b=jnp.where(at_b, joints.anchor_b * scale[None], joints.anchor_b),
    )
    if not ued.kinetix_quirks:
        # Q9: kinetix-env leaves thrusters where they were.
        moved = (thrusters.active & pick(body, thrusters.body))[:, None]
        thrusters = dataclasses.replace(
            thrusters,
            position=jnp.where(moved, thrusters.position * scale[None], thrusters.position),
        )
    return dataclasses.replace(draft, figures=figures, joints=joints, thrusters=thrusters)


def _half_extents(vertices: Float[Array, "4 2 n"], count: Int[Array, " n"]) -> Float[Array, "2 n"]:
    """Half the width and the height of a polygon's bounding box [m]."""
    real = (jnp.arange(vertices.shape[0])[:, None] < count[None])[:, None]
    low = jnp.min(jnp.where(real, vertices, jnp.inf), axis=0)
    return (jnp.max(jnp.where(real, vertices, -jnp.inf), axis=0) - low) / 2


def change_location(
    draft: Draft, numbers: Numbers, marked: Marks, ued: UEDParams, capacity: Capacity
) -> Draft:
    """Move a body and everything jointed to it, but keep it inside the arena."""
    row, body = one_body(draft, numbers[0], marked)
    label = components(draft.joints, capacity.bodies)
    bodies = movable_rows(draft.figures)
    moved = bodies & (label == pick(label, row)[None]) & any_row(body)[None]
    step = between(numbers[1:3], -LARGEST_STEP, LARGEST_STEP)
    position = draft.figures.position + jnp.where(moved[:, None], step[None], 0.0)
    figures = dataclasses.replace(draft.figures, position=position)
    # Q10: kinetix-env measures all bodies, unturned, but moves the component only.
    low, high = _extents(figures, turned=not ued.kinetix_quirks)
    measured = (bodies if ued.kinetix_quirks else moved)[:, None]
    low = jnp.min(jnp.where(measured, low, jnp.inf), axis=0)
    high = jnp.max(jnp.where(measured, high, -jnp.inf), axis=0)
    least = jnp.array([0.0, FLOOR_TOP])[:, None]
    back = jnp.maximum(0.0, least - low) - jnp.maximum(0.0, high - ARENA_WIDTH)
    position = position + jnp.where(moved[:, None], back[None], 0.0)
    return with_figures(draft, position=position)


def _extents(figures: Figures, *, turned: bool) -> tuple[Array, Array]:
    """Bounding boxes of all bodies [m], with their rotation or without it."""
    if turned:
        angles = figures.rotation[:, None]
        figures = dataclasses.replace(figures, vertices=rotate(figures.vertices, angles))
    low, high = bounds(figures)
    low = jnp.where(figures.circle[:, None], -figures.radius[:, None], low)
    high = jnp.where(figures.circle[:, None], figures.radius[:, None], high)
    return figures.position + low, figures.position + high


def change_rotation(
    draft: Draft, numbers: Numbers, marked: Marks, ued: UEDParams, capacity: Capacity
) -> Draft:
    """Turn a body; its welds keep the new angle, jointed bodies are to be settled."""
    del ued, capacity
    _, body = one_body(draft, numbers[0], marked)
    turn = numbers[1] * LARGEST_TURN
    joints = draft.joints
    at_a, at_b = ends(joints, body)
    change = jnp.where(at_a, -turn[None], 0.0) + jnp.where(at_b, turn[None], 0.0)
    reference = joints.reference_angle + jnp.where(joints.fixed, change, 0.0)
    rotation = draft.figures.rotation + jnp.where(body, turn[None], 0.0)
    return dataclasses.replace(
        with_figures(draft, rotation=rotation),
        joints=dataclasses.replace(joints, reference_angle=reference),
    )
