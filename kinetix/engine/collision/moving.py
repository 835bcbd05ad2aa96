"""The two shapes as the collision kernels see them, and the moment at which moving ones meet.

A contact that is prepared ahead must know where the bodies will be when they touch: the normal of
the moment of the impact, not of the start of the step. Otherwise bodies stop at corners that they
pass, and at the sides of flush neighbours.
Source: time of impact by separating axes after Ericson (2005), "Real-Time Collision Detection",
5.5; speculative contacts after Catto (2013), "Continuous Collision".
"""

from collections.abc import Sequence

import jax.numpy as jnp
from jaxtyping import Array, Bool, Float, Int

from kinetix.engine import constants, maths
from kinetix.engine.maths import Vec, dot, length, nonzero
from kinetix.pytree import pytree


@pytree
class MovingCircle:
    """`k` circles."""

    centre: Vec
    velocity: Vec
    radius: Float[Array, "k n"]


@pytree
class MovingPolygon:
    """`k` convex polygons, corners relative to the centre."""

    centre: Vec
    velocity: Vec
    corners: Vec
    """(k, v, n)."""
    normals: Vec
    """Outward normal of the edge from corner i to corner i + 1, (k, v, n); zero without one."""
    offsets: Float[Array, "k v n"]
    """normal · corner [m]; `FAR` where there is no edge."""
    spin: Float[Array, "k n"]
    """Angular velocity [rad/s]."""


def meeting(
    gaps: Sequence[Float[Array, "q n"]],
    closings: Sequence[Float[Array, "q n"]],
    dt: Float[Array, " n"],
) -> tuple[Float[Array, "q n"], Int[Array, "q n"], Bool[Array, "q n"]]:
    """Find the face along which two bodies meet that go straight on.

    At the moment when the last gap has closed, the face of that gap is hit. If another face is
    overlapped by less than `GRAZE` then, and bodies close more slowly along it, they only graze
    the first one: a box that slides over flush tiles meets their tops, not their sides.

    Args:
        gaps: Along each face's normal [m]; negative: overlap.
        closings: How fast each gap closes [m/s].
        dt: The time step [s].

    Returns:
        When they meet, or are nearest if they do not within the step [s]; the number of the face;
        and whether they meet.
    """
    time = jnp.zeros_like(gaps[0])
    for gap, closing in zip(gaps, closings, strict=True):
        ahead = (gap > 0) & (closing > 0)
        time = jnp.maximum(time, jnp.where(ahead, gap / jnp.where(ahead, closing, 1), 0))
    time = jnp.minimum(time, dt)
    then = [gap - closing * time for gap, closing in zip(gaps, closings, strict=True)]
    face, widest, slowest = jnp.zeros(time.shape, jnp.int32), then[0], closings[0]
    for number, (gap, closing) in enumerate(zip(then[1:], closings[1:], strict=True), start=1):
        wider = gap > widest + constants.LINEAR_SLOP
        face = jnp.where(wider, number, face)
        slowest = jnp.where(wider, closing, slowest)
        widest = jnp.where(wider, gap, widest)
    for number, (gap, closing) in enumerate(zip(then, closings, strict=True)):
        gentler = (gap > widest - constants.GRAZE) & (closing < slowest - constants.GRAZE_SPEED)
        face = jnp.where(gentler, number, face)
        slowest = jnp.where(gentler, closing, slowest)
    return time, face, widest <= constants.TOUCH_SLOP


def round_meeting(
    apart: Vec, motion: Vec, radius: Float[Array, "k n"], dt: Float[Array, " n"]
) -> tuple[Vec, Float[Array, "k n"]]:
    """Find the normal along which a point meets a circle around the origin.

    Args:
        apart: From the circle's centre to the point [m].
        motion: How the point moves against the circle [m/s].
        radius: Of the circle [m].
        dt: The time step [s].

    Returns:
        The direction of the point at the impact, or at the nearest approach if there is no impact
        in the step, or in the middle of the step if it moves along the circle; and the gap along it
        now. gap + time·closing speed is zero at an impact, so an
        oblique hit found a step early gets the right normal, and a path that passes is not stopped.
    """
    squared = dot(motion, motion)
    half = dot(apart, motion)
    outside = dot(apart, apart) - radius**2
    root = half**2 - squared * outside
    nearest = -half / nonzero(squared)
    impact = nearest - jnp.sqrt(jnp.maximum(root, 0)) / nonzero(squared)
    # Less than this is rounding: a path that goes by a point does not hit it head on.
    hits = (root > 1e-6 * half**2) & (half < 0)
    time = jnp.where(hits, impact, nearest)
    time = jnp.where(outside > 0, jnp.clip(time, 0, dt), 0)
    now, speed = length(apart), jnp.sqrt(squared)
    along = (jnp.abs(half) <= constants.SKIM * now * speed) & (now - radius <= constants.SLOP)
    skims = along & (0.5 * dt * speed <= constants.SKIM * now)
    then = apart + motion * jnp.where(skims, 0.5 * dt, time)
    distance = length(then)
    fallback = Vec(x=jnp.zeros_like(distance), y=jnp.ones_like(distance))
    normal = maths.where(distance > 1e-9, then / nonzero(distance), fallback)
    return normal, jnp.where(skims, now, dot(normal, apart)) - radius


def carried(way: Vec, spin: Float[Array, "k n"], time: Float[Array, "k n"]) -> Vec:
    """Return a direction or an arm of a body as it will be at a time [s] when the body has turned.

    A corner that touches moves on an arc; the direction in the middle of the step is that from
    where it is to where it will be. With the direction of the start a block that tips loses a
    percent of its energy, and a plank that swings gives some to what rolls on it.
    """
    half = 0.5 * spin * time * calm(spin, 2 * time)
    towards = Vec(x=-way.y - half * way.x, y=way.x - half * way.y)
    return way + towards * (2 * half / (1 + half**2))


def turned(normal: Vec, spin: Float[Array, "k n"], time: Float[Array, "k n"]) -> Vec:
    """Return a face's normal at a time [s]; a face that hardly turns keeps its own."""
    turns = jnp.abs(spin * time) > constants.LEAST_TURN
    return maths.where(turns, carried(normal, spin, time), normal)


def calm(spin: Float[Array, "k n"], time: Float[Array, "*k n"]) -> Float[Array, "k n"]:
    """Return 1 for bodies that turn by less than a radian in a time [s], and 0 beyond two."""
    return jnp.clip(2 - jnp.abs(spin) * time, 0, 1)


def steady(arm: Vec, normal: Vec, spin: Float[Array, "k n"], dt: Float[Array, " n"]) -> Vec:
    """Return the arm of a body to a contact, without its sideways part if the body whirls.

    The corner that will hit is not known for a body that turns by more than two radians in the
    step; pushed at the corner of now it would answer by another spin, and go through.
    """
    along = normal * dot(normal, arm)
    return along + (arm - along) * calm(spin, dt)
