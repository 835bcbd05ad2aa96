"""The goal of a machine, what it stands on, then hazards and obstacles."""

import math

from kinetix.engine.spec import Capacity
from kinetix.environment.generators.machines.workshop import FLOOR, Workshop
from kinetix.level.geometry import bounds
from kinetix.level.model import Point, Role
from kinetix.level.sizes import needed_capacity
from kinetix.level.validate import MAX_SHAPE_SIZE


def far_goal(shop: Workshop, x: float, *, reach: float = 5.0, ahead: bool = False) -> None:
    """The goal on the floor, at the wall or higher up, to the right of x (or to the left).

    Args:
        shop: Has the machine.
        x: Where the machine is [m].
        reach: How far off the goal may be [m].
        ahead: True if it is never to the left.
    """
    if x > 2.2 and not ahead and shop.chance(0.3):
        low, high = max(0.35, x - reach), x - 0.9
    else:
        low, high = x + 0.9, min(4.65, x + reach)
    place = shop.between(low, high) if low < high else 4.5
    size = shop.between(0.3, 0.8)
    kind = shop.dice.choice(("floor", "floor", "fixed", "wall", "high", "ledge", "arena"))
    if kind == "arena":
        shop.arena["right_wall" if place > x else "left_wall"] = shop.goal
    elif kind == "ledge":
        height, width = shop.between(0.1, 0.8), shop.between(0.5, 1.4)
        shop.box(place, FLOOR + height / 2, width, height, fixed=True)
        shop.lump(place, FLOOR + height + size * 0.68, size, role=shop.goal)
    elif kind == "wall":
        height = shop.between(0.6, 2.0)
        side = 4.8 if place > x else 0.2
        shop.box(side, FLOOR + height / 2, 0.3, height, role=shop.goal, fixed=True)
    elif kind == "high":
        y = FLOOR + shop.between(0.35, 0.9)
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


def stand(shop: Workshop) -> None:
    """Put a ledge under a machine that begins on one."""
    bodies = [body for body in shop.build.build().bodies if body.role != shop.goal]
    boxes = [bounds(body) for body in bodies if not body.fixed]
    low = [box for box in boxes if box[1] < shop.ground + 0.15]
    if not (shop.ledge and low):
        return
    left = max(min(box[0] for box in low) - shop.between(0.05, 0.4), 0.0)
    right = min(max(box[2] for box in low) + shop.between(0.05, 0.6), 5.0)
    thick = shop.ground - FLOOR if shop.chance(0.5) else 0.15
    parts = math.ceil((right - left) / MAX_SHAPE_SIZE)
    for index in range(parts):
        x = left + (index + 0.5) * (right - left) / parts
        shop.box(x, shop.ground - thick / 2, (right - left) / parts, thick, fixed=True)


def gate(shop: Workshop) -> None:
    """A slot between two bars, wherever it fits."""
    x, slot = shop.between(1.4, 3.6), shop.between(0.6, 1.4)
    middle = shop.between(1.2, 4.0)
    role: Role = "red" if shop.chance(0.6) else "none"
    for side in shop.dice.choice(((-1, 1), (-1,), (1,))):
        height = shop.between(0.4, 1.6)
        shop.box(x, middle + side * (slot + height) / 2, 0.15, height, role=role, fixed=True)


def furnish(shop: Workshop, capacity: Capacity) -> None:
    """Put hazards and obstacles where there is room.

    Args:
        shop: Has the machine.
        capacity: Room of the level's size.
    """
    if shop.chance(0.15) and needed_capacity(shop.build.build()).polygons + 2 <= capacity.polygons:
        gate(shop)
    for _ in range(shop.dice.choice((0, 0, 1, 1, 2, 3, capacity.polygons // 2))):
        have = needed_capacity(shop.build.build())
        balls, boxes = have.circles < capacity.circles, have.polygons < capacity.polygons
        if not (balls or boxes):
            return
        x, extent = shop.between(0.4, 4.6), shop.between(0.15, 0.6)
        if shop.furniture and shop.chance(0.5):
            role: Role = "red" if shop.chance(0.2) else "none"
            fixed = shop.chance(0.5)
            extent *= 0.6
            y = FLOOR + extent * (shop.between(-0.3, 0.1) if fixed and role == "none" else 0.52)
        else:
            role, fixed = "red" if shop.chance(0.45) else "none", True
            y = shop.between(0.9, 4.4)
        if boxes and (not balls or shop.chance(0.6)):
            angle = shop.between(-0.6, 0.6) if fixed and shop.chance(0.3) else 0.0
            wide = extent * shop.between(0.6, 2.5)
            shop.box(x, y, wide, extent, role=role, fixed=fixed, angle=angle)
        else:
            shop.ball(x, y, extent / 2, role=role, fixed=fixed)
