"""Slots of a level's entities when it is compiled: the one rule, free of JAX."""

from kinetix.engine.spec import ARENA_BODIES, Capacity
from kinetix.level.model import ARENA_NAMES, BodyReference, Level, Polygon


def body_slots(level: Level, capacity: Capacity) -> dict[BodyReference, int]:
    """The global index of every body: arena, then polygons, then circles, each in list order.

    Args:
        level: Any level; it need not fit.
        capacity: Where circles start: at `capacity.polygons`.
    """
    slots: dict[BodyReference, int] = {name: k for k, name in enumerate(ARENA_NAMES)}
    polygon, circle = ARENA_BODIES, capacity.polygons
    for body in level.bodies:
        if isinstance(body.shape, Polygon):
            slots[body.id] = polygon
            polygon += 1
        else:
            slots[body.id] = circle
            circle += 1
    return slots
