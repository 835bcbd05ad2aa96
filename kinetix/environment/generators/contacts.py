"""Count the contacts that a new body would have: proposals are compared by them.

The contacts are those of kinetix-env's physics, the preset `jax2d`: one or two between polygons,
one otherwise.
"""

import jax.numpy as jnp
import numpy as np
from jaxtyping import Array, Int

from kinetix.engine.collision.jax2d import (
    Shapes,
    circle_circle,
    circle_polygon,
    moved_polygons,
    polygon_polygon,
)
from kinetix.engine.maths import Vec, vec
from kinetix.environment.generators.figures import Figures


def count_contacts(new: Figures, others: Figures) -> Int[Array, "q n"]:
    """Count active contacts between each proposal and all active others."""
    count, rows = new.radius.shape[0], others.radius.shape[0]
    total = jnp.zeros(new.radius.shape, jnp.int32)
    both = [jnp.concatenate([getattr(new, name), getattr(others, name)]) for name in _SHAPE]
    vertices, vertex_count, position, rotation, radius = both
    shapes: Shapes = moved_polygons(vertices, vertex_count, position, rotation)
    centre: Vec = vec(position)
    proposals = np.arange(count)
    for row in range(rows):
        other = np.full(count, count + row)
        deeper, second = polygon_polygon(other, proposals, shapes)
        polygons = deeper.active.astype(jnp.int32) + second.active
        discs = circle_circle(proposals, other, centre, radius).active.astype(jnp.int32)
        on_other = circle_polygon(proposals, other, centre, radius, shapes).active.astype(jnp.int32)
        on_new = circle_polygon(other, proposals, centre, radius, shapes).active.astype(jnp.int32)
        circle = others.circle[row]
        pair = jnp.where(
            new.circle, jnp.where(circle, discs, on_other), jnp.where(circle, on_new, polygons)
        )
        total = total + jnp.where(new.active & others.active[row], pair, 0)
    return total


_SHAPE = ("vertices", "vertex_count", "position", "rotation", "radius")
