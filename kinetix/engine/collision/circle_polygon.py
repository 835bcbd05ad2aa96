"""Contacts between a circle and a convex polygon. Worlds on the last axis."""

import jax.numpy as jnp
from jaxtyping import Array, Float

from kinetix.engine import constants, maths
from kinetix.engine.collision.edges import columns, edge_ends, largest
from kinetix.engine.collision.moving import (
    MovingCircle,
    MovingPolygon,
    carried,
    meeting,
    round_meeting,
    steady,
    turned,
)
from kinetix.engine.collision.points import Approach, Spot
from kinetix.engine.maths import Vec, dot, length
from kinetix.engine.store import Store


def approach(a: MovingCircle, b: MovingPolygon, dt: Float[Array, " n"]) -> Approach:
    """Return the signed distance of the surfaces, and the polygon's face that is met."""
    offset, motion = a.centre - b.centre, a.velocity - b.velocity
    heights = dot(b.normals, offset[:, None]) - b.offsets
    face, edge = largest(heights)
    start, end, normal = edge_ends(b.corners, b.normals, edge)
    along = Vec(x=normal.y, y=-normal.x)
    before, after = dot(along, offset - start) < 0, dot(along, offset - end) > 0
    corner = maths.where(after, end, start)
    at_corner = (before | after) & (face > 0)
    distance = jnp.where(at_corner, length(offset - corner), face) - a.radius
    gaps = [column[:, 0] - a.radius for column in jnp.split(heights, heights.shape[1], axis=1)]
    closings = [-dot(column[:, 0], motion) for column in columns(b.normals)]
    time, face, meets = meeting(gaps, closings, dt)
    return Approach(separation=distance, face=face, time=time, meets=meets)


def points(
    a: MovingCircle,
    b: MovingPolygon,
    coming: Approach,
    margin: Float[Array, "k n"],
    dt: Float[Array, " n"],
    store: Store,
) -> list[Spot]:
    """Return one point: on the face that is met, or at the corner beyond which the circle passes.

    A corner that the circle only grazes while it comes over the face is left out: it would trip
    over the seam of two flush neighbours.
    """
    del margin
    start, end, outward = store(edge_ends(b.corners, b.normals, coming.face))
    along = Vec(x=outward.y, y=-outward.x)
    width = dot(along, end - start)
    offset, motion = a.centre - b.centre, a.velocity - b.velocity
    height = dot(outward, offset - start) - a.radius
    place = dot(along, offset - start)
    touches = (height <= constants.LINEAR_SLOP) & (place >= 0) & (place <= width)
    then = offset + motion * jnp.where(touches, 0, coming.time)
    place = dot(along, then - start)
    at_end = place > 0.5 * width
    corner = maths.where(at_end, end, start)
    round_normal, round_gap = store(round_meeting(corner - offset, -motion, a.radius, dt))
    round_closing, closing = dot(round_normal, motion), -dot(outward, motion)
    impact = round_gap / jnp.where(round_closing > 0, round_closing, jnp.inf)
    depth = height - closing * jnp.clip(impact, 0, dt)
    grazes = (depth > -constants.GRAZE) & (closing < round_closing - constants.GRAZE_SPEED)
    beyond = (place < 0) | (place > width)
    # A face that becomes separating only later in the step is passed around its corner.
    later = (coming.separation > 0) & (height < -constants.GRAZE)
    at_corner = (beyond & ~grazes & (height > -a.radius)) | later
    # Before it comes over the face it may lie below the face's line: over the crest of a hill.
    overlap = jnp.where((coming.separation > 0) & beyond, 0, -jnp.inf)
    gap = jnp.where(at_corner, round_gap, jnp.maximum(height, overlap))
    # The contact as it will be at the impact; of what touches, in the middle of the step.
    when = jnp.where(touches, 0.5 * dt, coming.time)
    facing = maths.where(touches, turned(outward, b.spin, when), outward)
    normal = maths.where(at_corner, round_normal, -facing)
    ahead = then - outward * dot(outward, then - start)
    arm = carried(maths.where(at_corner, corner, ahead), b.spin, when)
    below = offset + motion * when - facing * a.radius
    arm = maths.where(touches & ~at_corner, below, arm)
    corner_count = b.offsets.shape[1]
    feature = jnp.where(at_corner, (coming.face + at_end) % corner_count, coming.face)
    return [
        Spot(
            normal=normal,
            arm_a=normal * a.radius,
            arm_b=steady(arm, normal, b.spin, dt),
            separation=gap,
            feature=feature,
            exists=jnp.ones(gap.shape, bool),
        )
    ]
