"""Edges of convex polygons: the kernels' common ground. Worlds on the last axis."""

import functools

import jax.numpy as jnp
from jaxtyping import Array, Float, Int

from kinetix.engine import maths
from kinetix.engine.maths import Vec, dot
from kinetix.engine.shapes import FAR


def edge_ends(corners: Vec, normals: Vec, edge: Int[Array, "k n"]) -> tuple[Vec, Vec, Vec]:
    """Start, end and normal of an edge of each of `k` polygons."""
    ends = columns(corners)
    following = [*ends[1:], ends[0]]
    start, end, normal = (
        functools.reduce(
            lambda found, option: maths.where(edge == option[0], option[1], found),
            enumerate((corner[:, 0] for corner in options[1:]), start=1),
            options[0][:, 0],
        )
        for options in (ends, following, columns(normals))
    )
    return start, end, normal


def most_opposed(normals: Vec, normal: Vec) -> Int[Array, "k n"]:
    """The edge of each of `k` polygons whose outward normal points most against the given one."""
    best = jnp.full(normal.x.shape, FAR, normal.x.dtype)
    edge = jnp.zeros(normal.x.shape, jnp.int32)
    for i, column in enumerate(columns(normals)):
        candidate = column[:, 0]
        exists = (candidate.x != 0) | (candidate.y != 0)
        against = jnp.where(exists, dot(candidate, normal), FAR)
        edge = jnp.where(against < best, i, edge)
        best = jnp.minimum(best, against)
    return edge


def columns(corners: Vec) -> list[Vec]:
    """Return one after the other, each with an axis of length 1 in place of the corners'."""
    count = corners.x.shape[1]
    columns = [jnp.split(values, count, axis=1) for values in (corners.x, corners.y)]
    return [Vec(x=x, y=y) for x, y in zip(*columns, strict=True)]


def largest(gaps: Float[Array, "q v n"]) -> tuple[Float[Array, "q n"], Int[Array, "q n"]]:
    """Return the largest along the middle axis, and where it is first."""
    count = gaps.shape[1]
    best, *others = (part[:, 0] for part in jnp.split(gaps, count, axis=1))
    edge = jnp.zeros(best.shape, jnp.int32)
    for i, gap in enumerate(others, start=1):
        edge = jnp.where(gap > best, i, edge)
        best = jnp.maximum(best, gap)
    return best, edge
