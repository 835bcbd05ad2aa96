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
import numpy as np
from jaxtyping import Array, Bool, Float, Int

from kinetix.engine import constants
from kinetix.engine.lookup import accumulate, put, row
from kinetix.engine.maths import Vec, dot, length, nonzero, vec
from kinetix.engine.pairs import may_push
from kinetix.engine.shapes import FAR, Polygons, turn_polygons
from kinetix.engine.spec import ARENA_BODIES
from kinetix.engine.types import Bodies, State, World


def share_of_way(world: World, state: State, end: Vec) -> Float[Array, "b n"]:
    """Return how much of its way each body can go before its centre enters a fixed polygon.

    Args:
        world: The worlds.
        state: At the start of the step.
        end: Where the bodies' centres would be at its end [m].

    Returns:
        1 where nothing is in the way. What is jointed together gets the least share of its parts.
    """
    move = end - vec(state.position)
    core = _cores(world.bodies)
    moves = world.bodies.active & (world.bodies.inverse_mass > 0)
    fast = moves & (length(move) > core)
    whole = jnp.ones_like(core)

    def stopped() -> Float[Array, "b n"]:
        polygons = turn_polygons(world.bodies, state.rotation)

        def visit(k: Int[Array, ""], share: Float[Array, "b n"]) -> Float[Array, "b n"]:
            body = k + ARENA_BODIES
            found = _way_of_one(world, state, polygons, move, core, body)
            return put(share, jnp.where(row(fast, body), found, 1), body, 0)

        return _shared(world, accumulate(len(core) - ARENA_BODIES, visit, whole))

    return jax.lax.cond(jnp.any(fast), stopped, lambda: whole)


def _cores(bodies: Bodies) -> Float[Array, "b n"]:
    """Half the radius of a circle around the centre that lies within the body [m]."""
    corners = bodies.vertices.shape[1]
    used = np.arange(corners)[None, :, None] < bodies.vertex_count[:, None]
    x, y = bodies.vertices[:, :, 0], bodies.vertices[:, :, 1]
    x, y = jnp.where(used, x, x[:, :1]), jnp.where(used, y, y[:, :1])
    along = Vec(x=jnp.roll(x, -1, axis=1) - x, y=jnp.roll(y, -1, axis=1) - y)
    size = length(along)
    height = jnp.where(size > 0, (along.x * y - along.y * x) / nonzero(size), FAR)
    return 0.5 * jnp.concatenate([jnp.min(height, axis=1), bodies.radius], axis=0)


def _way_of_one(
    world: World,
    state: State,
    polygons: Polygons,
    move: Vec,
    core: Float[Array, "b n"],
    body: Int[Array, ""],
) -> Float[Array, "1 n"]:
    """The share for one body; it ends where the body's core touches the polygon at the latest."""
    count = polygons.offsets.shape[0]
    centre = vec(state.position)
    apart = _row(centre, body) - centre[:count]
    motion = _row(move, body) - move[:count]
    heights = dot(polygons.normals, apart[:, None]) - polygons.offsets - constants.LINEAR_SLOP
    closings = -dot(polygons.normals, motion[:, None])
    enters = jnp.where(closings > 0, heights / nonzero(closings), jnp.where(heights > 0, FAR, -FAR))
    leaves = jnp.where(closings < 0, heights / nonzero(closings), FAR)
    enter, leave = jnp.max(enters, axis=1), jnp.min(leaves, axis=1)
    outside = jnp.max(heights, axis=1) > 0
    crosses = outside & (enter <= 1) & (enter <= leave) & _stops(world, count, body)
    share = jnp.maximum(enter - row(core, body) / nonzero(length(motion)), 0)
    return jnp.min(jnp.where(crosses, share, 1), axis=0, keepdims=True)


def _stops(world: World, count: int, body: Int[Array, ""]) -> Bool[Array, "p n"]:
    """Which polygons are fixed and push a body."""
    bodies = world.bodies
    mode = bodies.collision_mode
    fixed = bodies.active[:count] & (bodies.inverse_mass[:count] == 0)
    return fixed & row(world.collides, body)[0, :count] & may_push(row(mode, body), mode[:count])


def _shared(world: World, share: Float[Array, "b n"]) -> Float[Array, "b n"]:
    """The least share of all that a body is jointed to; itself included."""
    if world.joints.active.shape[0] == 0:
        return share

    def least(k: Int[Array, ""], found: Float[Array, "b n"]) -> Float[Array, "b n"]:
        together = ~row(world.collides, k)[0]
        return jnp.where(together, jnp.minimum(found, row(share, k)), found)

    return accumulate(len(share), least, share)


def _row(v: Vec, index: Int[Array, ""]) -> Vec:
    return Vec(x=row(v.x, index), y=row(v.y, index))
