"""Room for contacts in a scene of a given size."""

import dataclasses
import functools
from typing import Final

from kinetix.engine.batch import TILE
from kinetix.engine.collision import Slots
from kinetix.engine.fitting import fitted
from kinetix.engine.pairs import pushing_candidates, touching_points
from kinetix.engine.spec import ARENA_BODIES, SceneSpec

MOST_NEAR = 64
"""Most pairs of a kind that a world keeps in sight, if there are more bodies than touch each other
at once."""

CACHED: Final = 5 * 2**18
"""Bytes of a tile's largest array that a processor's cache keeps at hand."""
LEAST_TILE: Final = 16
"""One vector of numbers."""


def worlds_at_once(spec: SceneSpec) -> int:
    """Return how many worlds to advance together: a power of 2.

    The largest array is what each row of a contact does to all bodies (`Responses`).
    """
    spec = fitted(spec)
    moving = spec.capacity.polygons - ARENA_BODIES + spec.capacity.circles
    rows = 2 * usual_room(spec).points + spec.capacity.joints
    fit = CACHED // (4 * 3 * max(1, rows * moving))
    return max(LEAST_TILE, min(TILE, 2 ** (max(1, fit).bit_length() - 1)))


@functools.lru_cache(maxsize=64)
def usual_room(spec: SceneSpec) -> Slots:
    """Return room for all contacts that bodies can have at once.

    What only comes near may be more than `touching_points`; it is left out first.
    """
    polygons = spec.capacity.polygons - ARENA_BODIES
    circles = spec.capacity.circles
    counts = [len(kind) for kind in pushing_candidates(spec.capacity, spec.features)]
    bodies = polygons + circles
    near = Slots(
        polygon_polygon=min(counts[0], max(MOST_NEAR, 3 * polygons)),
        circle_polygon=min(counts[1], max(MOST_NEAR, 3 * bodies)),
        circle_circle=min(counts[2], max(MOST_NEAR, 3 * circles)),
        points=0,
    )
    most = 2 * near.polygon_polygon + near.circle_polygon + near.circle_circle
    return dataclasses.replace(near, points=min(most, touching_points(polygons, circles)))
