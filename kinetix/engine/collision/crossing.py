"""Nothing crosses what is fixed: the last word on where bodies end. Worlds on the last axis.

Contacts are prepared for a step along straight paths. A body that is thrown off course within the
step, by a corner or in a crowd, can meet a wall that nothing was prepared for. It is left before
the wall, overlapping it a little, and keeps its velocity: the next step sees a plain contact.
Source: the safety net of continuous collision in Catto (2013), "Continuous Collision", for the
centres of bodies alone; segment against convex polygon after Ericson (2005), "Real-Time Collision
Detection", 5.3.8.
"""

import jax
import jax.numpy as jnp
from jaxtyping import Array, Float, Int

from kinetix.engine import constants
from kinetix.engine.collision.compact import compact
from kinetix.engine.in_use import InUse
from kinetix.engine.lookup import accumulate, row, take
from kinetix.engine.maths import Vec, dot, length, nonzero, vec
from kinetix.engine.pairs import may_push
from kinetix.engine.shapes import FAR, Polygons
from kinetix.engine.spec import ARENA_BODIES
from kinetix.engine.types import State, World


def share_of_way(world: World, state: State, polygons: Polygons, end: Vec) -> Float[Array, "b n"]:
    """Return how much of its way each body can go before its centre enters a fixed polygon.

    Args:
        world: The worlds.
        state: At the start of the step.
        polygons: At the start of the step.
        end: Where the bodies' centres would be at its end [m].

    Returns:
        1 where nothing is in the way. What is jointed together gets the least share of its parts.
    """
    move = end - vec(state.position)
    within = jnp.concatenate([jnp.min(polygons.offsets, axis=1), world.bodies.radius], axis=0)
    way = length(move)
    moves = world.bodies.active & (world.bodies.inverse_mass > 0)
    fast = (moves & (way > within))[ARENA_BODIES:]
    whole = jnp.ones_like(way)
    numbers = jnp.arange(len(way), dtype=jnp.int32)[:, None]

    def stopped() -> Float[Array, "b n"]:
        bodies, valid = compact(fast, len(fast))

        def visit(k: Int[Array, ""], share: Float[Array, "b n"]) -> Float[Array, "b n"]:
            body = row(bodies, k) + ARENA_BODIES
            found = _way_of_one(world, state, polygons, move, within, body)
            return jnp.where((numbers == body) & row(valid, k), found, share)

        return _shared(world, InUse.of((valid, 1)).each(visit, whole))

    return jax.lax.cond(jnp.any(fast), stopped, lambda: whole)


def _way_of_one(
    world: World,
    state: State,
    polygons: Polygons,
    move: Vec,
    within: Float[Array, "b n"],
    body: Int[Array, "1 n"],
) -> Float[Array, "1 n"]:
    """The share for one body; it ends where half of the body touches the polygon at the latest.

    What it touches there is its inner circle of half the size: a contact for the next step to see.
    """
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
    crosses = (jnp.max(heights, axis=1) > 0) & (enter <= 1) & (enter <= leave) & stops
    share = jnp.maximum(enter - 0.5 * own_within / nonzero(length(motion)), 0)
    return jnp.min(jnp.where(crosses, share, 1), axis=0, keepdims=True)


def _shared(world: World, share: Float[Array, "b n"]) -> Float[Array, "b n"]:
    """The least share of all that a body is jointed to; itself included."""
    if world.joints.active.shape[0] == 0:
        return share

    def least(k: Int[Array, ""], found: Float[Array, "b n"]) -> Float[Array, "b n"]:
        together = ~row(world.collides, k)[0]
        return jnp.where(together, jnp.minimum(found, row(share, k)), found)

    return accumulate(len(share), least, share)
