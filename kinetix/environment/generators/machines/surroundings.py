"""The goal of a machine, then hazards and obstacles."""

import math

from kinetix.engine.spec import Capacity
from kinetix.environment.generators.machines.workshop import FLOOR, Workshop
from kinetix.level.model import Point, Role
from kinetix.level.sizes import needed_capacity


def far_goal(shop: Workshop, x: float) -> None:
    """The goal on the floor, at the wall or a little up, to the right of x (or to the left)."""
    if x > 2.2 and shop.chance(0.3):
        low, high = 0.35, x - 0.9
    else:
        low, high = x + 0.9, 4.65
    place = shop.between(low, high) if low < high else 4.5
    size = shop.between(0.3, 0.8)
    kind = shop.dice.choice(("floor", "floor", "fixed", "wall", "high"))
    if kind == "wall":
        height = shop.between(0.6, 2.0)
        side = 4.8 if place > x else 0.2
        shop.box(side, FLOOR + height / 2, 0.3, height, role=shop.goal, fixed=True)
    elif kind == "high":
        y = FLOOR + shop.between(0.5, 1.3)
        shop.lump(place, y, size, role=shop.goal, fixed=True)
    else:
        y = FLOOR + size * 0.68
        shop.lump(place, y, size, role=shop.goal, fixed=kind == "fixed")


def goal_around(shop: Workshop, hub: Point, reach: float) -> None:
    """The goal in some direction, at this distance from the hub [m]."""
    angle = shop.between(-math.pi, math.pi)
    x = min(max(hub[0] + reach * math.cos(angle), 0.3), 4.7)
    y = min(max(hub[1] + reach * math.sin(angle), 0.65), 4.7)
    shop.lump(x, y, shop.between(0.25, 0.6), role=shop.goal, fixed=True)


def goal_anywhere(shop: Workshop, x: float) -> None:
    """The goal on the floor or in the air, not where the machine begins."""
    place = shop.between(0.4, 4.6)
    if abs(place - x) < 0.6:
        place = 5.0 - x
    size = shop.between(0.3, 0.7)
    if shop.chance(0.3):
        shop.lump(place, FLOOR + size * 0.68, size, role=shop.goal)
    else:
        y = shop.between(1.0, 4.4)
        shop.lump(place, y, size, role=shop.goal, fixed=True)


def furnish(shop: Workshop, capacity: Capacity) -> None:
    """Put hazards and obstacles where there is room.

    Args:
        shop: Has the machine.
        capacity: Room of the level's size.
    """
    for _ in range(shop.dice.choice((0, 0, 1, 1, 2, 3))):
        have = needed_capacity(shop.build.build())
        balls, boxes = have.circles < capacity.circles, have.polygons < capacity.polygons
        if not (balls or boxes):
            return
        role: Role = "red" if shop.chance(0.45) else "none"
        x, extent = shop.between(0.4, 4.6), shop.between(0.15, 0.6)
        fixed = shop.chance(0.7)
        if shop.furniture and shop.chance(0.6):
            y = FLOOR + extent * (shop.between(0.0, 0.3) if fixed and role == "none" else 0.52)
        else:
            y, fixed = shop.between(0.9, 4.4), True
        if boxes and (not balls or shop.chance(0.6)):
            angle = shop.between(-0.6, 0.6) if fixed and shop.chance(0.3) else 0.0
            wide = extent * shop.between(0.6, 2.5)
            shop.box(x, y, wide, extent, role=role, fixed=fixed, angle=angle)
        else:
            shop.ball(x, y, extent / 2, role=role, fixed=fixed)
