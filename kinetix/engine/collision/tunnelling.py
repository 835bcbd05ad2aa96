"""Prevent tunnelling through fixed bodies: limit how far a body moves. Worlds are on the last axis.

Contacts are prepared for a step along straight paths. A body that is thrown off course within the
step, by a corner or in a crowd, can meet a wall that nothing was prepared for. It is stopped before
the wall, overlapping it a little, and keeps its velocity: the next step finds an ordinary contact.
A contact that would push a body out on the far side, as with long bodies and thin walls, is
overruled: the body is moved to the side of its centre, step by step, and stands still meanwhile.
Source: the safety net of continuous collision in Catto (2013), "Continuous Collision", for the
centres of bodies alone; segment against convex polygon after Ericson (2005), "Real-Time Collision
Detection", 5.3.8.
"""

import jax
import jax.numpy as jnp
from jaxtyping import Array, Bool, Float, Int

from kinetix.engine import constants, maths
from kinetix.engine.active_rows import InUse
from kinetix.engine.collision.compact import compact
from kinetix.engine.collision.edges import edge_ends, largest
from kinetix.engine.collision.points import Points
from kinetix.engine.lookup import accumulate, row, take
from kinetix.engine.maths import Vec, dot, length, nonzero, vec
from kinetix.engine.pairs import may_push
from kinetix.engine.shapes import FAR, Polygons
from kinetix.engine.spec import ARENA_BODIES
from kinetix.engine.types import State, World
from kinetix.pytree import pytree


@pytree
class WayLeft:
    """Share of its way in a step that walls leave to each body; jointed bodies have the same."""

    share: Float[Array, "b n"]
    """Of the way; 1 where nothing is in it."""
    back: Vec
    """Shift of bodies that a contact would push through a wall, (b, n) [m]; their share is 0."""


def held_by_walls(
    world: World,
    state: State,
    polygons: Polygons,
    points: Points,
    end: Vec,
    dt: Float[Array, " n"],
) -> WayLeft:
    """Find who would enter a fixed polygon with its centre, and where it ends instead.

    Args:
        world: The worlds.
        state: At the start of the step.
        polygons: At the start of the step.
        points: The contacts of the step.
        end: Where the bodies' centres would be at its end [m].
        dt: The time step [s].
    """
    move = end - vec(state.position)
    within = jnp.concatenate([jnp.min(polygons.offsets, axis=1), world.bodies.radius], axis=0)
    way = length(move)
    moves = world.bodies.active & (world.bodies.inverse_mass > 0)
    fast = (moves & (way > within))[ARENA_BODIES:]
    nothing = jnp.zeros_like(way)
    free = WayLeft(share=jnp.ones_like(way), back=Vec(x=nothing, y=nothing))
    numbers = jnp.arange(len(way), dtype=jnp.int32)[:, None]

    def stopped() -> WayLeft:
        bodies, valid = compact(fast, len(fast))

        def visit(k: Int[Array, ""], held: WayLeft) -> WayLeft:
            body = row(bodies, k) + ARENA_BODIES
            found = _held_one(world, state, polygons, points, (move, within), body)
            here = (numbers == body) & row(valid, k)
            return jax.tree.map(lambda new, old: jnp.where(here, new, old), found, held)

        return _together(world, InUse.of((valid, 1)).each(visit, free))

    held = jax.lax.cond(jnp.any(fast), stopped, lambda: free)
    return WayLeft(share=held.share, back=held.back * (constants.PUSH_SPEED * dt))


def _held_one(
    world: World,
    state: State,
    polygons: Polygons,
    points: Points,
    ways: tuple[Vec, Float[Array, "b n"]],
    body: Int[Array, "1 n"],
) -> WayLeft:
    """Find how far one body may go, and where it is pushed back to.

    Its inner circle may overlap a polygon by half: the next step finds a contact there.

    Args:
        world: The worlds.
        state: At the start of the step.
        polygons: At the start of the step.
        points: The contacts of the step.
        ways: How the bodies move in the step, and their inner radii [m].
        body: Which one, in each world.

    Returns:
        Its share and the direction in which it is moved back, (1, n).
    """
    move, within = ways
    count = polygons.offsets.shape[0]
    centre = vec(state.position)
    mode, push = world.bodies.collision_mode, world.collides
    own_centre, own_move, own_within, own_mode, own_push = take(
        (centre, move, within, mode, push), body
    )
    apart, motion = own_centre - centre[:count], own_move - move[:count]
    heights = dot(polygons.normals, apart[:, None]) - polygons.offsets - constants.LINEAR_SLOP
    closings = -dot(polygons.normals, motion[:, None])
    enters = jnp.where(closings > 0, heights / nonzero(closings), jnp.where(heights > 0, FAR, -FAR))
    leaves = jnp.where(closings < 0, heights / nonzero(closings), FAR)
    enter, leave = jnp.max(enters, axis=1), jnp.min(leaves, axis=1)
    fixed = world.bodies.active[:count] & (world.bodies.inverse_mass[:count] == 0)
    stops = fixed & own_push[0, :count] & may_push(own_mode, mode[:count])
    height = jnp.max(heights, axis=1)
    crosses = (height > 0) & (enter <= 1) & (enter <= leave) & stops
    share = jnp.maximum(enter - 0.5 * own_within / nonzero(length(motion)), 0)
    _, face = largest(heights)
    _, _, side = edge_ends(polygons.corners, polygons.normals, face)
    beyond = _pushed_beyond(points, body, motion, side) & crosses
    share = jnp.where(beyond, 0, jnp.where(crosses, share, 1))
    back = maths.where(beyond, side, Vec(x=jnp.zeros_like(height), y=jnp.zeros_like(height)))
    return WayLeft(
        share=jnp.min(share, axis=0, keepdims=True),
        back=Vec(x=back.x.sum(axis=0, keepdims=True), y=back.y.sum(axis=0, keepdims=True)),
    )


def _pushed_beyond(
    points: Points, body: Int[Array, "1 n"], motion: Vec, side: Vec
) -> Bool[Array, "p n"]:
    """Return the polygons that a body overlaps and leaves by a contact away from its centre.

    Args:
        points: The contacts of the step.
        body: Which one, in each world.
        motion: Of the body against each polygon, (p, n) [m].
        side: The normal of each polygon's face on the side of the body's centre, (p, n).
    """
    is_a, is_b = points.body_a == body, points.body_b == body
    other = jnp.where(is_a, points.body_b, points.body_a)
    deep = (points.key >= 0) & (is_a | is_b) & (points.separation < 0)
    outwards = points.normal * jnp.where(is_a, -1, 1).astype(motion.x.dtype)
    numbers = jnp.arange(len(motion.x), dtype=jnp.int32)[:, None]

    def visit(k: Int[Array, ""], found: Bool[Array, "p n"]) -> Bool[Array, "p n"]:
        way_out = Vec(x=row(outwards.x, k), y=row(outwards.y, k))
        here = (numbers == row(other, k)) & row(deep, k)
        return found | (here & (dot(way_out, motion) > 0) & (dot(way_out, side) < 0))

    return InUse.of((deep, 1)).each(visit, jnp.zeros(motion.x.shape, bool))


def _together(world: World, held: WayLeft) -> WayLeft:
    """Hold what is jointed together: the least share of all, and the way back of any of them."""
    if world.joints.active.shape[0] == 0:
        return held

    def join(k: Int[Array, ""], found: WayLeft) -> WayLeft:
        together = ~row(world.collides, k)[0]
        back = Vec(x=row(held.back.x, k), y=row(held.back.y, k))
        moved = together & ((back.x != 0) | (back.y != 0))
        share = jnp.minimum(found.share, row(held.share, k))
        return WayLeft(
            share=jnp.where(together, share, found.share),
            back=maths.where(moved, back, found.back),
        )

    return accumulate(len(held.share), join, held)
