"""Contacts and joint limits of a step as one system, the joints eliminated. Worlds last.

Only rows that a world of the tile uses are computed: a scene of size l has room for 20 points and
mostly meets four.
"""

import dataclasses
from typing import Any

import jax.numpy as jnp
import numpy as np
from jaxtyping import Array, Bool, Float, Int

from kinetix.engine import constants
from kinetix.engine.collide import Found
from kinetix.engine.joints import nearer_limit
from kinetix.engine.lookup import put, row
from kinetix.engine.maths import Vec, nonzero
from kinetix.engine.solvers.blocks import AbstractBlock
from kinetix.engine.solvers.in_use import InUse
from kinetix.engine.solvers.joint_system import JointSystem, Step
from kinetix.engine.solvers.rows import (
    Directions,
    Links,
    Rows,
    coupling,
    diagonal,
    first_of_links,
    make_rows,
    one_row,
    put_coupling,
    through_points,
    turning,
)
from kinetix.engine.store import Store
from kinetix.engine.types import State
from kinetix.pytree import pytree


@pytree
class ContactSystem:
    """The rows of a step that push one way: contacts and joint limits. Fixed for the whole step."""

    rows: Rows
    live: Bool[Array, "m n"]
    in_use: InUse
    matrix: Float[Array, "m m n"]
    """Their coupling with the joints eliminated; that of the identity in rows that are not used."""
    prepared: Any
    gaps: Rows
    """Those of the rows that have a gap: the contacts' normals and the limits."""
    friction: Float[Array, "c n"]
    restitution: Float[Array, "c n"]


def contact_system(
    step: Step, state: State, found: Found, joints: JointSystem, block: AbstractBlock
) -> tuple[ContactSystem, Float[Array, "g n"]]:
    """The contacts and limits at the start of a step.

    Args:
        step: The worlds, what drives them, and the masses.
        state: At the start.
        found: The contacts.
        joints: The joints at the same pose.
        block: Who will solve the system.

    Returns:
        The system, and the gaps of the contacts [m] and limits [rad].
    """
    store = step.store
    points, bodies = found.points, step.world.bodies
    normal = points.normal
    tangent = Vec(x=normal.y, y=-normal.x)
    used = points.key >= 0
    touching = Links(body_a=points.body_a, body_b=points.body_b, in_use=InUse.of((used, 2)))
    limited, limits, limit_live, limit_gap = _limit_directions(step, state)
    links = Links.joined(touching, limited)
    in_use = links.in_use
    rows = make_rows(
        links,
        links.look_up(step.masses),
        [
            *(through_points(way, points.arm_a, points.arm_b) for way in (normal, tangent)),
            limits,
        ],
        store,
    )
    live = jnp.concatenate([used, used, limit_live], axis=0)
    mobility = store(diagonal(rows))
    across, answer, answered = _through_joints(rows, joints, store)
    own = mobility + answered
    live = store(live & (own > constants.LEAST_PIVOT * mobility))
    # Bodies that joints hold may overlap beyond remedy; yielding bounds what pushes them apart.
    deep = jnp.concatenate(
        [points.separation < -constants.DEEP, jnp.zeros_like(used), jnp.zeros_like(limit_live)]
    )
    yields = deep & (own < constants.HELD * mobility)
    own += jnp.where(yields, constants.DEEP_COMPLIANCE * mobility, 0)
    own = store(jnp.where(live, own, 1))

    def fill(k: Int[Array, ""], matrix: Float[Array, "m m n"]) -> Float[Array, "m m n"]:
        line = coupling(one_row(rows, k), rows)
        line += _answered(joints, row(answer, k)[0], across)
        return put_coupling(matrix, k, line, live, own, store)

    eye = np.eye(live.shape[0], dtype=np.float32)[:, :, None]
    matrix = jnp.broadcast_to(eye, (*eye.shape[:2], own.shape[-1])).astype(own.dtype)
    matrix = in_use.each(fill, matrix)
    (friction_a, restitution_a), (friction_b, restitution_b) = touching.look_up(
        (bodies.friction, bodies.restitution)
    )
    friction = jnp.sqrt(friction_a**2 + friction_b**2)
    system = ContactSystem(
        rows=rows,
        gaps=first_of_links(rows),
        live=live,
        in_use=in_use,
        matrix=matrix,
        prepared=block.prepare(matrix, _contrast(rows, used)),
        friction=store(step.parameters.base_friction * friction),
        restitution=store(jnp.minimum(restitution_a, restitution_b)),
    )
    return system, jnp.concatenate([points.separation, limit_gap], axis=0)


def _through_joints(
    rows: Rows, joints: JointSystem, store: Store
) -> tuple[Float[Array, "k m n"], Float[Array, "m k n"], Float[Array, "m n"]]:
    """What the rows do to the joints, what the joints answer, and what that does to each row."""
    count, joint_rows = rows.turn_a.shape[0], joints.live.shape[0]
    worlds = rows.turn_a.shape[-1]
    nothing = jnp.zeros((joint_rows, count, worlds), rows.turn_a.dtype)
    carry = nothing, jnp.swapaxes(nothing, 0, 1), jnp.zeros_like(rows.turn_a)
    if joint_rows == 0:
        return carry
    answering = joints.rows.links.in_use

    def visit(k: Int[Array, ""], carry: tuple[Array, Array, Array]) -> tuple[Array, Array, Array]:
        across, answer, answered = carry
        pull = store(jnp.where(joints.live, coupling(joints.rows, one_row(rows, k))[:, 0], 0))
        given = store(jnp.where(joints.live, answering.product(joints.answers, pull), 0))
        return (
            put(across, pull[:, None], k, 1),
            put(answer, given[None], k, 0),
            put(answered, answering.inner(pull, given)[None], k, 0),
        )

    return rows.links.in_use.each(visit, carry)


def _answered(
    joints: JointSystem, answer: Float[Array, "k n"], across: Float[Array, "k m n"]
) -> Float[Array, "m n"]:
    """What the joints' answer to one row does to all rows."""

    def add(j: Int[Array, ""], total: Float[Array, "m n"]) -> Float[Array, "m n"]:
        return total + row(answer, j) * row(across, j)[0]

    return joints.rows.links.in_use.each(add, jnp.zeros(across.shape[1:], across.dtype))


def _contrast(rows: Rows, used: Bool[Array, "c n"]) -> Float[Array, " n"]:
    """The greatest ratio of the masses of two bodies that touch; 1 beside what is fixed."""
    count = used.shape[0]
    a, b = rows.mass_a[:count], rows.mass_b[:count]
    ratio = jnp.maximum(a, b) / nonzero(jnp.minimum(a, b))
    return jnp.max(jnp.where(used & (a > 0) & (b > 0), ratio, 1), axis=0, initial=1)


def _limit_directions(
    step: Step, state: State
) -> tuple[Links, Directions, Bool[Array, "j n"], Float[Array, "j n"]]:
    """One row a joint with limits: the nearer of its two; its gap is the angle left [rad].

    No row at all in a scene without limits.
    """
    world, held = step.world, step.held
    joints, of_rows = world.joints, held.rows
    nothing = jnp.zeros_like(joints.reference_angle[:0])
    if not step.features.limits:
        nobody = nothing.astype(jnp.int32)
        none = nothing.astype(bool)
        links = Links(body_a=nobody, body_b=nobody, in_use=InUse.of((none, 1)))
        return links, turning(nothing), none, nothing
    angle_a, angle_b = held.links.look_up(state.rotation)
    side, left = nearer_limit(world, angle_b - angle_a - joints.reference_angle)
    count = side.shape[0]
    acts = held.acts & joints.limited & ~joints.fixed
    acts &= of_rows.inertia_a[:count] + of_rows.inertia_b[:count] > 0
    links = dataclasses.replace(held.links, in_use=InUse.of((acts, 1)))
    return links, turning(side), acts, left
