"""Contact points, and how many a step has room for. Worlds on the last axis."""

import dataclasses
from typing import Final

import jax
import jax.numpy as jnp
import numpy as np
from jaxtyping import Array, Bool, Float, Int

from kinetix.engine.maths import Vec
from kinetix.engine.shapes import FAR, Polygons
from kinetix.pytree import pytree

FEATURES: Final = 16
"""Feature ids per pair: 4·(corner of a) + (corner of b)."""


@pytree
class Points:
    """Contact points, `c` slots in every world."""

    body_a: Int[Array, "c n"]
    body_b: Int[Array, "c n"]
    normal: Vec
    """From body a to body b."""
    arm_a: Vec
    """From the centre of body a to the contact point [m]."""
    arm_b: Vec
    separation: Float[Array, "c n"]
    """Gap along the normal [m]; negative when overlapping; `FAR` in an empty slot."""
    key: Int[Array, "c n"]
    """Names the pair and the features; the same point keeps its key in the next step; −1: empty."""


@pytree
class Spot:
    """One contact point of each of `k` pairs, as a kernel finds it."""

    normal: Vec
    """From body a to body b."""
    arm_a: Vec
    arm_b: Vec
    separation: Float[Array, "k n"]
    feature: Int[Array, "k n"]
    exists: Bool[Array, "k n"]


@pytree
class Approach:
    """Relative motion of two bodies within the step, if they go straight on."""

    separation: Float[Array, "q n"]
    """Signed distance of the surfaces now [m]."""
    face: Int[Array, "q n"]
    """The face that will be hit or that keeps them apart: 0–3 of body a, 4–7 of body b."""
    time: Float[Array, "q n"]
    """Time [s] of the impact if there is one in the step, else of the nearest approach."""
    meets: Bool[Array, "q n"]
    """True where there is an impact within the step; true where they touch now."""


@pytree
class PointList:
    """Contact points of every world, one behind the other."""

    points: Points
    count: Int[Array, " n"]
    """Number of points added; beyond the number of slots the last ones are missing."""

    @staticmethod
    def empty(room: int, like: Float[Array, "b n"]) -> "PointList":
        """Return a list with this many slots."""
        nothing = jnp.zeros((room, like.shape[-1]), like.dtype)
        none = nothing.astype(jnp.int32)
        nowhere = Vec(x=nothing, y=nothing)
        points = Points(
            body_a=none,
            body_b=none,
            normal=nowhere,
            arm_a=nowhere,
            arm_b=nowhere,
            separation=nothing + FAR,
            key=none - 1,
        )
        return PointList(points=points, count=jnp.zeros(like.shape[-1], jnp.int32))

    def with_spot(
        self,
        spot: Spot,
        bodies: tuple[Int[Array, "1 n"], Int[Array, "1 n"]],
        pair: Int[Array, "1 n"],
        counts: Bool[Array, "1 n"],
    ) -> "PointList":
        """Return the list with one point more in the worlds where it exists."""
        exists = spot.exists & counts
        here = (np.arange(self.points.key.shape[0])[:, None] == self.count) & exists
        new = Points(
            body_a=bodies[0],
            body_b=bodies[1],
            normal=spot.normal,
            arm_a=spot.arm_a,
            arm_b=spot.arm_b,
            separation=spot.separation,
            key=pair * FEATURES + spot.feature,
        )
        points = jax.tree.map(lambda x, old: jnp.where(here, x, old), new, self.points)
        return PointList(points=points, count=self.count + exists[0])


@pytree
class Found:
    """Result of collision detection."""

    points: Points
    touching: Bool[Array, "q n"]
    overflow: Bool[Array, " n"]
    polygons: Polygons
    """At the start of the step."""


@dataclasses.dataclass(frozen=True, kw_only=True)
class Slots:
    """Room of a world for near pairs of each kind, and for points in all."""

    polygon_polygon: int
    circle_polygon: int
    circle_circle: int
    points: int
