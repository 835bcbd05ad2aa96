"""Mutations of drafts, each applied to the worlds that are marked.

Every mutation takes the drafts, its own uniform numbers and the marks, and leaves the other worlds
as they are; so a batch in which every world gets another mutation runs each of them once. What they
have in common: where there is nothing to act on, nothing happens.

Q2, Q9 and Q10 are quirks of `UEDParams.kinetix_quirks`.
"""

import dataclasses
import math
from collections.abc import Callable
from typing import Final

import jax
import jax.numpy as jnp
from jaxtyping import Array, Bool, Float, Int

from kinetix.engine.spec import Capacity
from kinetix.engine.types import Joints
from kinetix.environment.generators.blocks import (
    Proposals,
    SizeLimit,
    Surroundings,
    connected_shape,
    free_shape,
    joint_of,
    look_around,
    new_dimensions,
    size_limit,
    thrusters_on,
)
from kinetix.environment.generators.draft import (
    Draft,
    components,
    first_free,
    free_slot,
    hit,
    joint_counts,
    put,
    spread,
    with_joint,
)
from kinetix.environment.generators.draws import (
    PER_JOINT,
    PER_SHAPE,
    PER_THRUSTER,
    between,
    choose,
    joint_draws,
    shape_draws,
    thruster_draws,
)
from kinetix.environment.generators.figures import (
    ARENA_SIDE,
    FLOOR_TOP,
    VERTICES,
    Figures,
    bounds,
    centroid,
    has_vertex,
    movable_rows,
    pick,
    rotate,
)
from kinetix.environment.generators.params import UEDParams

LARGEST_STEP: Final = 0.5
"""Largest shift of a body along each axis [m]."""
LARGEST_TURN: Final = math.pi / 2
"""Largest rotation of a body [rad]."""
MUTATED_GRAVITY: Final = -9.8
"""Gravity that half of the mutated levels get, and the strongest of the others [m/s²]."""
OFF_CENTRE: Final = 1e-5
"""Largest distance of a frame's origin from the centre of mass that is left alone [m]."""
NUMBERS: Final = PER_SHAPE + PER_JOINT
"""Uniform numbers that any one mutation uses at most."""

Numbers = Float[Array, "22 n"]
Marks = Bool[Array, " n"]
Mutation = Callable[[Draft, Numbers, Marks, UEDParams, Capacity], Draft]


def _some(candidates: Bool[Array, "b n"], u: Float[Array, " n"]) -> Int[Array, " n"]:
    return choose(u, candidates.astype(jnp.float32))


def _any_row(candidates: Bool[Array, "b n"]) -> Marks:
    return jnp.any(candidates, axis=0)


def _one_body(
    draft: Draft, u: Float[Array, " n"], marked: Marks
) -> tuple[Int[Array, " n"], Bool[Array, "b n"]]:
    """A uniform active body besides the arena: its row, and the same as marks."""
    candidates = movable_rows(draft.figures)
    row = _some(candidates, u)
    return row, hit(draft.figures.active, row, marked & _any_row(candidates))


def _with_figures(draft: Draft, **changes: Array) -> Draft:
    return dataclasses.replace(draft, figures=dataclasses.replace(draft.figures, **changes))


def _ends(joints: Joints, body: Bool[Array, "b n"]) -> tuple[Array, Array]:
    """Of active joints: whether the marked body is their body a, and their body b."""
    return (
        joints.active & pick(body, joints.body_a),
        joints.active & pick(body, joints.body_b),
    )


def remove_shape(
    draft: Draft, numbers: Numbers, marked: Marks, ued: UEDParams, capacity: Capacity
) -> Draft:
    """Take away a body with its joints and thrusters."""
    del ued, capacity
    _, gone = _one_body(draft, numbers[0], marked)
    at_a, at_b = _ends(draft.joints, gone)
    thrusters, joints = draft.thrusters, draft.joints
    loose = pick(gone, thrusters.body)
    return dataclasses.replace(
        _with_figures(draft, active=draft.figures.active & ~gone),
        joints=dataclasses.replace(joints, active=joints.active & ~(at_a | at_b)),
        thrusters=dataclasses.replace(thrusters, active=thrusters.active & ~loose),
    )


def remove_joint(
    draft: Draft, numbers: Numbers, marked: Marks, ued: UEDParams, capacity: Capacity
) -> Draft:
    """Take away a joint."""
    del ued, capacity
    active = draft.joints.active
    gone = hit(active, _some(active, numbers[0]), marked)
    return dataclasses.replace(
        draft, joints=dataclasses.replace(draft.joints, active=active & ~gone)
    )


def remove_thruster(
    draft: Draft, numbers: Numbers, marked: Marks, ued: UEDParams, capacity: Capacity
) -> Draft:
    """Take away a thruster."""
    del ued, capacity
    active = draft.thrusters.active
    gone = hit(active, _some(active, numbers[0]), marked)
    return dataclasses.replace(
        draft, thrusters=dataclasses.replace(draft.thrusters, active=active & ~gone)
    )


def swap_role(
    draft: Draft, numbers: Numbers, marked: Marks, ued: UEDParams, capacity: Capacity
) -> Draft:
    """Exchange the roles of two bodies whose roles differ."""
    del ued, capacity
    bodies, role = movable_rows(draft.figures), draft.figures.role
    first = _some(bodies, numbers[0])
    first_role = pick(role, first)
    others = bodies & (role != first_role[None])
    second = _some(others, numbers[1])
    marked = marked & _any_row(bodies) & _any_row(others)
    role = jnp.where(hit(role, first, marked), pick(draft.figures.role, second)[None], role)
    return _with_figures(draft, role=jnp.where(hit(role, second, marked), first_role[None], role))


def toggle_fixture(
    draft: Draft, numbers: Numbers, marked: Marks, ued: UEDParams, capacity: Capacity
) -> Draft:
    """Fix a body, or free a fixed one, which then turns about its centre of mass."""
    del capacity
    _, body = _one_body(draft, numbers[0], marked)
    draft = _recentred(draft, body & draft.figures.fixed, ued)
    return _with_figures(draft, fixed=draft.figures.fixed ^ body)


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
    row, body = _one_body(draft, numbers[-1], marked)
    old = draft.figures
    circle = pick(old.circle, row)
    draws = shape_draws(numbers[:PER_SHAPE, None])
    new = jax.tree.map(
        lambda leaf: leaf[0], new_dimensions(draws, circle[None], size_limit(ued).limit, ued)
    )
    # The drawn rectangle says how large the bounding box's corner is to be, whatever the shape.
    was = jnp.abs(_leftmost(pick(old.vertices, row), pick(old.vertex_count, row)))
    drawn = jnp.abs(_leftmost(new.vertices, new.vertex_count))
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
    at_a, at_b = (end[:, None] for end in _ends(joints, body))
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


def _leftmost(vertices: Float[Array, "4 2 n"], count: Int[Array, " n"]) -> Float[Array, "2 n"]:
    """The corner with the least 100·x + y."""
    score = 100 * vertices[:, 0] + vertices[:, 1]
    real = jnp.arange(vertices.shape[0])[:, None] < count[None]
    return pick(vertices, jnp.argmin(jnp.where(real, score, jnp.inf), axis=0).astype(jnp.int32))


def change_location(
    draft: Draft, numbers: Numbers, marked: Marks, ued: UEDParams, capacity: Capacity
) -> Draft:
    """Move a body and everything jointed to it, but keep it inside the arena."""
    row, body = _one_body(draft, numbers[0], marked)
    label = components(draft.joints, capacity.bodies)
    bodies = movable_rows(draft.figures)
    moved = bodies & (label == pick(label, row)[None]) & _any_row(body)[None]
    step = between(numbers[1:3], -LARGEST_STEP, LARGEST_STEP)
    position = draft.figures.position + jnp.where(moved[:, None], step[None], 0.0)
    figures = dataclasses.replace(draft.figures, position=position)
    # Q10: kinetix-env measures all bodies, unturned, but moves the component only.
    low, high = _extents(figures, turned=not ued.kinetix_quirks)
    measured = (bodies if ued.kinetix_quirks else moved)[:, None]
    low = jnp.min(jnp.where(measured, low, jnp.inf), axis=0)
    high = jnp.max(jnp.where(measured, high, -jnp.inf), axis=0)
    least = jnp.array([0.0, FLOOR_TOP])[:, None]
    back = jnp.maximum(0.0, least - low) - jnp.maximum(0.0, high - ARENA_SIDE)
    position = position + jnp.where(moved[:, None], back[None], 0.0)
    return _with_figures(draft, position=position)


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
    _, body = _one_body(draft, numbers[0], marked)
    turn = numbers[1] * LARGEST_TURN
    joints = draft.joints
    at_a, at_b = _ends(joints, body)
    change = jnp.where(at_a, -turn[None], 0.0) + jnp.where(at_b, turn[None], 0.0)
    reference = joints.reference_angle + jnp.where(joints.fixed, change, 0.0)
    rotation = draft.figures.rotation + jnp.where(body, turn[None], 0.0)
    return dataclasses.replace(
        _with_figures(draft, rotation=rotation),
        joints=dataclasses.replace(joints, reference_angle=reference),
    )


def _around(draft: Draft, capacity: Capacity) -> Surroundings:
    free = ~draft.figures.active
    return look_around(
        draft.figures,
        polygon_room=_any_row(free[: capacity.polygons]),
        circle_room=_any_row(free[capacity.polygons :]),
        joint_room=_any_row(~draft.joints.active),
    )


def _insert(
    draft: Draft, proposals: Proposals, marked: Marks, ued: UEDParams, capacity: Capacity
) -> tuple[Draft, Int[Array, " n"], Proposals]:
    """The draft with the one proposed body in the lowest free slot of its kind."""
    chosen = jax.tree.map(lambda leaf: leaf[0], proposals)
    slot = free_slot(draft.figures, chosen.figure.circle, capacity)
    marked = marked & chosen.figure.active
    figure = chosen.figure
    if ued.kinetix_quirks:
        # Q2: a slot keeps the density of the body that was there before.
        figure = dataclasses.replace(figure, density=pick(draft.figures.density, slot))
    body = hit(draft.figures.active, slot, marked)
    return (
        dataclasses.replace(
            draft,
            figures=put(draft.figures, figure, slot, marked),
            velocity=jnp.where(body[:, None], 0.0, draft.velocity),
            angular_velocity=jnp.where(body, 0.0, draft.angular_velocity),
            friction=jnp.where(body, 1.0, draft.friction),
            restitution=jnp.where(body, 0.0, draft.restitution),
            collision_mode=jnp.where(body, 1, draft.collision_mode),
        ),
        slot,
        chosen,
    )


def add_shape(
    draft: Draft,
    numbers: Numbers,
    marked: Marks,
    ued: UEDParams,
    capacity: Capacity,
    *,
    size: SizeLimit | None = None,
) -> Draft:
    """Add a free body; `size` overrides the limits of the options."""
    draws = shape_draws(numbers[:PER_SHAPE, None])
    around = _around(draft, capacity)
    proposals = free_shape(draws, around, False, ued, size or size_limit(ued))
    return _insert(draft, proposals, marked, ued, capacity)[0]


def add_connected_shape(
    draft: Draft,
    numbers: Numbers,
    marked: Marks,
    ued: UEDParams,
    capacity: Capacity,
    *,
    force_rjoint: bool = False,
    size: SizeLimit | None = None,
) -> Draft:
    """Add a body that is jointed to one that is there; `size` overrides the options' limits."""
    joints = draft.joints
    proposals = connected_shape(
        shape_draws(numbers[:PER_SHAPE, None]),
        draft.figures,
        joint_counts(joints, capacity.bodies),
        _around(draft, capacity),
        ued,
        size or size_limit(ued),
        new_polygon_row=first_free(draft.figures.active[: capacity.polygons])[None],
        triangles=True,
    )
    grown, slot, chosen = _insert(draft, proposals, marked, ued, capacity)
    joint, binding = joint_of(
        chosen,
        slot,
        joint_draws(numbers[PER_SHAPE:]),
        force_rjoint=force_rjoint,
        revolute_count=jnp.sum((joints.active & ~joints.fixed).astype(jnp.int32), axis=0),
        ued=ued,
    )
    return with_joint(grown, joint, binding, marked)


def add_thruster(
    draft: Draft, numbers: Numbers, marked: Marks, ued: UEDParams, capacity: Capacity
) -> Draft:
    """Add a thruster to a body that can move."""
    del capacity
    figures, thrusters = draft.figures, draft.thrusters
    new, binding = thrusters_on(
        thruster_draws(numbers[:PER_THRUSTER, None]),
        figures,
        movable_rows(figures) & ~figures.fixed,
        ued,
        triangles=True,
    )
    new, binding = jax.tree.map(lambda leaf: leaf[0], (new, binding))
    marked = marked & _any_row(~thrusters.active) & new.active
    slot = first_free(thrusters.active)
    thrusters, bindings = put((thrusters, draft.thruster_binding), (new, binding), slot, marked)
    return dataclasses.replace(draft, thrusters=thrusters, thruster_binding=bindings)


MUTATORS: Final[dict[str, Mutation]] = {
    "add_shape": add_shape,
    "add_connected_shape": add_connected_shape,
    "remove_joint": remove_joint,
    "remove_shape": remove_shape,
    "swap_role": swap_role,
    "add_thruster": add_thruster,
    "remove_thruster": remove_thruster,
    "toggle_fixture": toggle_fixture,
    "change_size": change_size,
    "change_location": change_location,
    "change_rotation": change_rotation,
    "change_gravity": change_gravity,
}
"""All mutations by name."""

SETTLED: Final = frozenset({"change_size", "change_rotation"})
"""After these, jointed bodies are put together again."""
