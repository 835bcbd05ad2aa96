"""How much room for contacts a scene of a given size gets."""

import dataclasses
from typing import Any, ClassVar, Protocol, runtime_checkable

from kinetix.engine.collide import Slots
from kinetix.engine.pairs import pushing_candidates
from kinetix.engine.spec import ARENA_BODIES, SceneSpec


@runtime_checkable
class HasRoom(Protocol):
    """A solver, a frozen dataclass, whose contacts live in a fixed number of slots."""

    __dataclass_fields__: ClassVar[dict[str, Any]]

    @property
    def slots(self) -> Slots | None:
        """Room for contacts; None: by the capacity."""
        ...

    def slots_for(self, spec: SceneSpec) -> Slots:
        """Room for contacts in scenes of this capacity."""
        ...


def usual_room(spec: SceneSpec) -> Slots:
    """Room for the contacts that scenes of this capacity usually have.

    Measured on the published levels under random actions: at most 7, 9 and 17 points are near at
    once in sizes s, m and l (99.9 %). A stack needs two points a polygon. A scene whose pairs are
    known never needs more than those.
    """
    polygons = spec.capacity.polygons - ARENA_BODIES
    circles = spec.capacity.circles
    counts = [len(kind) for kind in pushing_candidates(spec.capacity, spec.features)]
    near = Slots(
        polygon_polygon=min(counts[0], polygons + 3 if polygons <= 8 else 2 * polygons),
        circle_polygon=min(counts[1], circles + 3),
        circle_circle=min(counts[2], max(1, circles - 1)),
        points=0,
    )
    most = 2 * near.polygon_polygon + near.circle_polygon + near.circle_circle
    points = max(polygons + circles + 5, 2 * polygons + circles)
    return dataclasses.replace(near, points=min(most, points))
