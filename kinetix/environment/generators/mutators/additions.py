"""Mutations that add something.

Q2 is a quirk of `UEDParams.kinetix_quirks`.
"""

import dataclasses

import jax
import jax.numpy as jnp
from jaxtyping import Array, Int

from kinetix.engine.spec import Capacity
from kinetix.environment.generators.blocks import (
    Proposals,
    SizeLimit,
    Surroundings,
    connected_shape,
    free_shape,
    joint_of,
    look_around,
    size_limit,
    thrusters_on,
)
from kinetix.environment.generators.draft import (
    Draft,
    first_free,
    free_slot,
    hit,
    joint_counts,
    put,
    with_joint,
)
from kinetix.environment.generators.draws import (
    PER_SHAPE,
    PER_THRUSTER,
    joint_draws,
    shape_draws,
    thruster_draws,
)
from kinetix.environment.generators.figures import movable_rows, pick
from kinetix.environment.generators.mutators.picking import Marks, Numbers, any_row
from kinetix.environment.generators.params import UEDParams


def _around(draft: Draft, capacity: Capacity) -> Surroundings:
    free = ~draft.figures.active
    return look_around(
        draft.figures,
        polygon_room=any_row(free[: capacity.polygons]),
        circle_room=any_row(free[capacity.polygons :]),
        joint_room=any_row(~draft.joints.active),
    )


def _insert(
    draft: Draft, proposals: Proposals, marked: Marks, ued: UEDParams, capacity: Capacity
) -> tuple[Draft, Int[Array, " n"], Proposals]:
    """Return the draft with the one proposed body in the lowest free slot of its kind."""
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
    force_no_fixate: bool = False,
    size: SizeLimit | None = None,
) -> Draft:
    """Add a free body; `size` overrides the limits of the options."""
    draws = shape_draws(numbers[:PER_SHAPE, None])
    around = _around(draft, capacity)
    proposals = free_shape(draws, around, force_no_fixate, ued, size or size_limit(ued))
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
    marked = marked & any_row(~thrusters.active) & new.active
    slot = first_free(thrusters.active)
    thrusters, bindings = put((thrusters, draft.thruster_binding), (new, binding), slot, marked)
    return dataclasses.replace(draft, thrusters=thrusters, thruster_binding=bindings)
