"""World geometry of the polygons, relative to their bodies' positions. Worlds on the last axis."""

import jax.numpy as jnp
import numpy as np
from jaxtyping import Array, Float, Int, Shaped

from kinetix.engine import maths
from kinetix.engine.maths import Vec, dot, length, nonzero, rotate
from kinetix.engine.types import Bodies
from kinetix.pytree import pytree

FAR = 1e6
"""Stands in for the offset of an edge that does not exist: nothing is ever outside of it [m]."""


@pytree
class Polygons:
    """Turned polygons.

    Corners are relative to the body's position, which keeps digits far from the origin; corners
    that do not exist repeat the first one.
    """

    corners: Vec
    """(p, v, n)."""
    normals: Vec
    """Outward normal of the edge from corner i to corner i + 1, (p, v, n); zero without one."""
    offsets: Float[Array, "p v n"]
    """normal · corner [m]; `FAR` where there is no edge."""
    radius: Float[Array, "p n"]
    """Distance of the farthest corner [m]."""


def turn_polygons(bodies: Bodies, rotation: Float[Array, "b n"]) -> Polygons:
    """Return the polygons at their bodies' angles."""
    polygons, corner_count = bodies.vertices.shape[:2]
    angle = rotation[:polygons, None]
    local = Vec(x=bodies.vertices[:, :, 0], y=bodies.vertices[:, :, 1])
    used = jnp.arange(corner_count)[None, :, None] < bodies.vertex_count[:, None]
    local = maths.where(used, local, local[:, :1])
    corners = rotate(jnp.cos(angle), jnp.sin(angle), local)
    edge = Vec(x=jnp.roll(corners.x, -1, axis=1), y=jnp.roll(corners.y, -1, axis=1)) - corners
    size = length(edge)
    exists = size > 0
    normals = Vec(x=-edge.y, y=edge.x) / nonzero(size)
    return Polygons(
        corners=corners,
        normals=normals,
        offsets=jnp.where(exists, dot(normals, corners), FAR),
        radius=jnp.sqrt(jnp.max(dot(local, local), axis=1)),
    )


def flat(v: Vec) -> Vec:
    """(p, v, n) to (p·v, n), so that one index names a corner of a polygon."""
    return Vec(x=v.x.reshape(-1, v.x.shape[-1]), y=v.y.reshape(-1, v.y.shape[-1]))


def rows(
    values: Shaped[Array, "rows *rest n"], index: Int[np.ndarray, " k"]
) -> Shaped[Array, "k *rest n"]:
    """values[index] for rows that are the same in every world and known when compiling."""
    return values.at[index].get(mode="promise_in_bounds", wrap_negative_indices=False)
