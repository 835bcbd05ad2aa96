"""Candidate pairs and the collision filter: numpy, done once at trace or load time."""

import functools
from typing import Any

import numpy as np
from jaxtyping import Bool, Int

from kinetix.engine.spec import ARENA_BODIES, Capacity, Features


@functools.cache
def candidate_pairs(capacity: Capacity) -> Int[np.ndarray, "q 2"]:
    """Return all pairs of slots that can touch, as global indices.

    The order is kinetix-env's: polygon–polygon (i < j, without the pairs inside the arena), then
    circle–polygon (for each circle, each polygon; listed circle first), then circle–circle (i < j).
    """
    polygons, circles = capacity.polygons, capacity.circles
    polygon_polygon = [
        (i, j) for i in range(polygons) for j in range(i + 1, polygons) if j >= ARENA_BODIES
    ]
    circle_polygon = [(polygons + c, p) for c in range(circles) for p in range(polygons)]
    circle_circle = [
        (polygons + i, polygons + j) for i in range(circles) for j in range(i + 1, circles)
    ]
    pairs = np.array(polygon_polygon + circle_polygon + circle_circle, dtype=np.int32).reshape(
        -1, 2
    )
    pairs.setflags(write=False)
    return pairs


def pair_counts(capacity: Capacity) -> tuple[int, int, int]:
    """Count the candidate pairs: polygon–polygon, circle–polygon, circle–circle."""
    polygons, circles = capacity.polygons, capacity.circles
    arena = ARENA_BODIES * (ARENA_BODIES - 1) // 2
    return polygons * (polygons - 1) // 2 - arena, circles * polygons, circles * (circles - 1) // 2


def pushing_candidates(capacity: Capacity, features: Features) -> tuple[Int[np.ndarray, " k"], ...]:
    """Return the candidate pairs between which a scene with these features can have contacts.

    Returns:
        One array for each kind in the order of `pair_counts`, counted within the kind.
    """
    pairs = candidate_pairs(capacity)
    kept = np.ones(len(pairs), bool)
    if features.pairs is not None:
        listed = {tuple(sorted(pair)) for pair in features.pairs}
        kept = np.array([tuple(sorted(pair)) in listed for pair in pairs.tolist()], bool)
    edges = np.cumsum(pair_counts(capacity))[:-1]
    return tuple(np.flatnonzero(part) for part in np.split(kept, edges))


def touching_points(polygons: int, circles: int) -> int:
    """Return how many contact points so many bodies can have at once if they do not overlap.

    Convex bodies in the plane touch along the edges of a planar graph: each adds at most three
    pairs (Euler). Two polygons have two contact points, other pairs one.

    Args:
        polygons: Without the arena's.
        circles: How many.
    """
    return 6 * polygons + 3 * circles


def may_push(mode_a: Any, mode_b: Any) -> Any:
    """Return whether bodies of these collision modes (0, 1, 2) may touch: 2 all, 0 only 2.

    Args:
        mode_a: Of one body; numbers or arrays.
        mode_b: Of the other.
    """
    return (mode_a == 2) | (mode_b == 2) | (mode_a * mode_b > 0)


def collision_matrix(
    body_count: int,
    body_a: Int[np.ndarray, " j"],
    body_b: Int[np.ndarray, " j"],
    active: Bool[np.ndarray, " j"],
) -> Bool[np.ndarray, "b b"]:
    """Mark the pairs that may push: false inside a jointed component and on the diagonal.

    A component may run through fixed and arena bodies, so that everything pinned to one of them
    ignores it and each other.
    """
    component = np.arange(body_count)
    for a, b in zip(body_a[active], body_b[active], strict=True):
        component[component == component[b]] = component[a]
    return component[:, None] != component[None, :]
