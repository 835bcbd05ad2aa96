"""Contacts between two convex polygons. Worlds on the last axis."""

import functools
import itertools

import jax.numpy as jnp
from jaxtyping import Array, Bool, Float, Int

from kinetix.engine import constants, maths
from kinetix.engine.collision.edges import columns, edge_ends, most_opposed
from kinetix.engine.collision.moving import (
    MovingPolygon,
    carried,
    meeting,
    round_meeting,
    steady,
    turned,
)
from kinetix.engine.collision.points import Approach, Spot
from kinetix.engine.maths import Vec, cross, dot, length, nonzero
from kinetix.engine.shapes import FAR
from kinetix.engine.store import Store


def approach(a: MovingPolygon, b: MovingPolygon, dt: Float[Array, " n"]) -> Approach:
    """Return the signed distance of the surfaces, and the face along which they meet."""
    apart, motion = b.centre - a.centre, b.velocity - a.velocity
    gaps = [*_gaps(a, b, apart), *_gaps(b, a, -apart)]
    normals = [*columns(a.normals), *columns(-b.normals)]
    closings = [-dot(normal[:, 0], motion) for normal in normals]
    time, face, meets = meeting(gaps, closings, dt)
    corners = a.offsets.shape[1]
    widest = functools.reduce(jnp.maximum, gaps)
    return Approach(
        separation=jnp.where(widest > 0, jnp.maximum(widest, _corner_gap(a, b, apart)), widest),
        face=jnp.where(face >= corners, face + 4 - corners, face),
        time=time,
        meets=meets,
    )


def _gaps(a: MovingPolygon, b: MovingPolygon, apart: Vec) -> list[Float[Array, "q n"]]:
    """Return the distance of b beyond each face of a."""
    nearest = functools.reduce(
        jnp.minimum, [dot(a.normals, corner) for corner in columns(b.corners)]
    )
    gaps = dot(a.normals, apart[:, None]) + nearest - a.offsets
    return [column[:, 0] for column in jnp.split(gaps, gaps.shape[1], axis=1)]


def _corner_gap(a: MovingPolygon, b: MovingPolygon, apart: Vec) -> Float[Array, "q n"]:
    """Return the gap along the line of the two nearest corners.

    No gap along a line is more than the distance. Where no face has as much, two corners are what
    is nearest, and this is it.
    """
    own, other = columns(a.corners), [apart[:, None] + corner for corner in columns(b.corners)]
    between = [there - here for here, there in itertools.product(own, other)]
    nearest, least = between[0], dot(between[0], between[0])
    for offset in between[1:]:
        squared = dot(offset, offset)
        nearest = maths.where(squared < least, offset, nearest)
        least = jnp.minimum(least, squared)
    line = nearest / nonzero(length(nearest))
    first = functools.reduce(jnp.minimum, [dot(line, corner) for corner in other])
    last = functools.reduce(jnp.maximum, [dot(line, corner) for corner in own])
    return (first - last)[:, 0]


def points(
    a: MovingPolygon,
    b: MovingPolygon,
    coming: Approach,
    margin: Float[Array, "k n"],
    dt: Float[Array, " n"],
    store: Store,
) -> list[Spot]:
    """Return two clipped points on the face that is met, or one where two corners are nearest."""
    swap = coming.face >= 4
    edge = coming.face % 4

    def chosen(of_a: Vec, of_b: Vec) -> tuple[Vec, Vec]:
        here = swap[:, None] if of_a.x.ndim > swap.ndim else swap
        return maths.where(here, of_b, of_a), maths.where(here, of_a, of_b)

    own_corners, other_corners = chosen(a.corners, b.corners)
    own_normals, other_normals = chosen(a.normals, b.normals)
    own_centre, other_centre = chosen(a.centre, b.centre)
    own_velocity, other_velocity = chosen(a.velocity, b.velocity)
    start, end, normal = store(edge_ends(own_corners, own_normals, edge))
    other = store(most_opposed(other_normals, normal))
    first, last, _ = edge_ends(other_corners, other_normals, other)
    now = other_centre - own_centre
    motion = other_velocity - own_velocity
    height = dot(normal, now - start) + jnp.minimum(dot(normal, first), dot(normal, last))
    touches = (height <= constants.LINEAR_SLOP) & _over(start, end, normal, first + now, last + now)
    shift = motion * jnp.where(touches, 0, coming.time)
    apart = now + shift
    first, last, apart, shift = store((first + apart, last + apart, apart, shift))
    came = dot(normal, shift)
    # A face that becomes separating only later in the step is passed around its corner.
    later = (coming.separation > 0) & (height < -constants.GRAZE)
    (low, high), (gap_low, gap_high), survives = store(_clip(start, end, normal, first, last))
    survives &= ~later
    mine, theirs, which, nearest = store(
        _corner_pair(start, end, first, last, survives, gap_low, gap_high)
    )
    corner_normal, corner_gap = store(
        round_meeting(theirs - shift - mine, motion, jnp.zeros_like(height), dt)
    )
    corner_point = mine + (theirs - mine) * 0.5
    # Where two corners meet on their way along a face there is no direction between them.
    flush = (jnp.abs(height) <= constants.GRAZE) & (length(theirs - mine) <= constants.LINEAR_SLOP)
    beside = jnp.abs(cross(motion, theirs - shift - mine))
    flush |= later & (beside <= constants.SAME_LINE * length(motion))
    use_corner = (nearest | later) & (coming.separation > 0) & ~flush

    # From here on in terms of a and b; the gaps are those of now, the directions those at the
    # impact; of what touches, those in the middle of the step.
    when = jnp.where(touches, 0.5 * dt, coming.time)
    own_spin = jnp.where(swap, b.spin, a.spin)
    facing = maths.where(touches, turned(normal, own_spin, when), normal)
    sign = jnp.where(swap, -1.0, 1.0).astype(apart.x.dtype)
    overlap = jnp.where(coming.separation > 0, 0, -jnp.inf)
    own_corner, other_corner = (edge, (edge + 1) % 4), (other, (other + 1) % 4)

    def feature(ref: Int[Array, "k n"], inc: Int[Array, "k n"]) -> Int[Array, "k n"]:
        return jnp.where(swap, 4 * inc + ref, 4 * ref + inc)

    def arms(place: Vec, normal: Vec) -> tuple[Vec, Vec]:
        """Of a and b, to a place that is relative to the centre of the face's polygon."""
        of_a = maths.where(swap, place - apart, place)
        of_b = maths.where(swap, place, place - apart)
        return (
            steady(carried(of_a, a.spin, when), normal, a.spin, dt),
            steady(carried(of_b, b.spin, when), normal, b.spin, dt),
        )

    corner_feature = feature(
        jnp.where(which % 2 == 1, own_corner[1], own_corner[0]),
        jnp.where(which >= 2, other_corner[1], other_corner[0]),
    )
    gap_first = jnp.where(
        use_corner,
        corner_gap,
        jnp.maximum(gap_low - came, overlap),
    )
    gap_second = jnp.maximum(gap_high - came, overlap)
    first_normal = maths.where(use_corner, corner_normal, facing)
    first_arms = arms(
        maths.where(use_corner, corner_point, low - normal * (0.5 * gap_low)), first_normal
    )
    second_arms = arms(high - normal * (0.5 * gap_high), facing)
    return [
        Spot(
            normal=first_normal * sign,
            arm_a=first_arms[0],
            arm_b=first_arms[1],
            separation=gap_first,
            feature=jnp.where(use_corner, corner_feature, feature(own_corner[0], other_corner[1])),
            exists=(survives | use_corner) & (gap_first <= margin),
        ),
        Spot(
            normal=facing * sign,
            arm_a=second_arms[0],
            arm_b=second_arms[1],
            separation=gap_second,
            feature=feature(own_corner[1], other_corner[0]),
            exists=survives & ~use_corner & (gap_second <= margin),
        ),
    ]


def _over(start: Vec, end: Vec, normal: Vec, first: Vec, last: Vec) -> Bool[Array, "k n"]:
    """Return whether part of an edge lies within the width of the face."""
    along = Vec(x=normal.y, y=-normal.x)
    width = dot(along, end - start)
    t_first, t_last = dot(along, first - start), dot(along, last - start)
    return (jnp.maximum(t_first, t_last) >= 0) & (jnp.minimum(t_first, t_last) <= width)


def _clip(
    start: Vec, end: Vec, normal: Vec, first: Vec, last: Vec
) -> tuple[tuple[Vec, Vec], tuple[Array, Array], Bool[Array, "k n"]]:
    """Cut the incident edge (first → last) to the width of the reference edge (start → end).

    Returns:
        The points near the start and near the end of the reference edge, their gaps, and whether
        anything of the incident edge lies within that width.
    """
    along = Vec(x=normal.y, y=-normal.x)
    width = dot(along, end - start)
    t_first, t_last = dot(along, first - start), dot(along, last - start)
    span = t_first - t_last
    steep = jnp.abs(span) < 1e-9
    inverse = 1 / jnp.where(steep, 1.0, span)
    low_share = jnp.where(steep, 0.0, jnp.clip(-t_last * inverse, 0, 1))
    high_share = jnp.where(steep, 1.0, jnp.clip((width - t_last) * inverse, 0, 1))
    edge = first - last
    low, high = last + edge * low_share, last + edge * high_share
    survives = (jnp.maximum(t_first, t_last) >= 0) & (jnp.minimum(t_first, t_last) <= width)
    return (low, high), (dot(normal, low - start), dot(normal, high - start)), survives


def _corner_pair(
    start: Vec,
    end: Vec,
    first: Vec,
    last: Vec,
    survives: Bool[Array, "k n"],
    gap_low: Float[Array, "k n"],
    gap_high: Float[Array, "k n"],
) -> tuple[Vec, Vec, Int[Array, "k n"], Bool[Array, "k n"]]:
    """Return the nearest pair of corners of two edges, and whether it rules the contact.

    Without it a contact prepared ahead of time would catch on corners that pass each other.

    Returns:
        The corner of the face and that of the incident edge, which they are (bit 0: end of the
        face, bit 1: last of the incident edge), the verdict.
    """
    best = jnp.full(start.x.shape, FAR, start.x.dtype)
    which = jnp.zeros(start.x.shape, jnp.int32)
    mine, theirs = start, first
    for number, (own, other) in enumerate(
        ((start, first), (end, first), (start, last), (end, last))
    ):
        offset = other - own
        squared = dot(offset, offset)
        nearer = squared < best
        best = jnp.minimum(best, squared)
        which = jnp.where(nearer, number, which)
        mine, theirs = maths.where(nearer, own, mine), maths.where(nearer, other, theirs)
    distance = jnp.sqrt(best)
    # Both corners are the nearest points of their edges when each edge leads away from the other.
    own_edge = maths.where(which % 2 == 1, start - end, end - start)
    other_edge = maths.where(which >= 2, first - last, last - first)
    outside = (dot(own_edge, theirs - mine) <= 0) & (dot(other_edge, mine - theirs) <= 0)
    smallest = jnp.where(survives, jnp.minimum(gap_low, gap_high), FAR)
    apart = jnp.where(survives, smallest > constants.LINEAR_SLOP, True)
    closer = (distance + constants.LINEAR_SLOP < smallest) | ~survives
    return mine, theirs, which, outside & apart & closer & (distance > 1e-9)
