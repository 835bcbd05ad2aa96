"""Machines with jets."""

import math

from kinetix.environment.generators.machines.surroundings import goal_anywhere
from kinetix.environment.generators.machines.workshop import FLOOR, Workshop


def flying(shop: Workshop) -> None:
    """A body with one or two jets; the goal is anywhere."""
    width, height = shop.between(0.25, 0.8), shop.between(0.2, 0.6)
    x = shop.between(0.5, 4.5)
    y = shop.ground + height / 2 + (shop.between(0.3, 3.0) if shop.chance(0.4) else 0.02)
    round_body = shop.chance(0.2)
    body = (
        shop.ball(x, y + 0.05, width / 2, role=shop.tip)
        if round_body
        else shop.box(x, y, width, height, role=shop.tip, angle=0.0)
    )
    mass = width * height * shop.build.build().bodies[-1].density
    kind = shop.dice.choice(("pair", "cross", "one"))
    if kind == "pair":
        for index, side in enumerate((-1, 1)):
            at = (x + side * width * 0.4, y - height * 0.4)
            shop.jet(body, at, math.pi / 2, mass / 1.3, index)
    else:
        shop.jet(body, (x, y - height * 0.4), math.pi / 2, mass, 0)
        if kind == "cross":
            shop.jet(body, (x - width * 0.4, y), 0.0, mass / 2, 1)
    goal_anywhere(shop, x)
    shop.furniture = shop.chance(0.5)


def towing(shop: Workshop) -> None:
    """A flyer with a load on a rod; the load has to touch."""
    x, y, size = shop.between(1.0, 4.0), shop.between(2.0, 3.5), shop.between(0.3, 0.6)
    tug = shop.box(x, y, size, size * 0.6)
    mass = 1.6 * size * size
    shop.jet(tug, (x - size * 0.4, y - size * 0.2), math.pi / 2, mass, 0)
    shop.jet(tug, (x + size * 0.4, y - size * 0.2), math.pi / 2, mass, 1)
    if shop.chance(0.5):
        load, _ = shop.rod((x, y), -math.pi / 2, shop.between(0.5, 1.0), role=shop.tip)
    else:
        drop = shop.between(0.4, 0.9)
        load = shop.ball(x, y - drop, shop.between(0.1, 0.22), role=shop.tip)
    motor = shop.motor(0, speed=(0.3, 1.0), power=(0.5, 1.5)) if shop.chance(0.3) else None
    shop.build.hinge(tug, load, (x, y), motor=motor)
    goal_anywhere(shop, x)


def meeting(shop: Workshop) -> None:
    """A body with one or two jets; the goal moves."""
    x, size = shop.between(0.6, 4.4), shop.between(0.25, 0.6)
    y = shop.ground + size / 2 + (shop.between(0.3, 2.5) if shop.chance(0.5) else 0.02)
    body = shop.box(x, y, size, size * shop.between(0.6, 1.2), role=shop.tip)
    mass = size * size * shop.build.build().bodies[-1].density
    shop.jet(body, (x, y - size * 0.3), math.pi / 2, mass, 0)
    if shop.chance(0.7):
        side = shop.dice.choice((-1, 1))
        shop.jet(body, (x - side * size * 0.4, y), 0.0 if side == 1 else math.pi, mass / 2, 1)
    goal = 5.0 - x if abs(x - 2.5) > 0.5 else shop.dice.choice((0.6, 4.4))
    velocity = ((x - goal) * shop.between(0.0, 0.8), shop.between(-0.5, 2.5))
    shop.lump(goal, shop.between(1.0, 4.4), 0.4, role=shop.goal, velocity=velocity)
    shop.deadly(0.5, "floor")


def steering(shop: Workshop) -> None:
    """A body whose jet a motor turns."""
    x, size = shop.between(0.8, 4.2), shop.between(0.3, 0.6)
    y = shop.ground + size + 0.3 + (shop.between(0.3, 2.0) if shop.chance(0.3) else 0.0)
    hull = shop.box(x, y, size, size * 0.7, role=shop.tip)
    nozzle, end = shop.rod((x, y - size * 0.3), -math.pi / 2, size * 0.6, density=1.0)
    motor = shop.motor(0, speed=(0.2, 0.8), power=(0.5, 2.0))
    shop.build.hinge(hull, nozzle, (x, y - size * 0.3), motor=motor, limits=(-1.3, 1.3))
    shop.jet(nozzle, end, math.pi / 2, size * size * 1.3, 0)
    goal_anywhere(shop, x)


def nudging(shop: Workshop) -> None:
    """A falling body with jets to both sides among pegs; the goal is at the bottom."""
    x, size = shop.between(1.2, 3.8), shop.between(0.2, 0.4)
    body = shop.lump(x, shop.between(3.8, 4.5), size, role=shop.tip)
    mass = size * size * shop.build.build().bodies[-1].density
    y = shop.build.build().bodies[-1].position[1]
    shop.jet(body, (x - size * 0.3, y), 0.0, mass / 2, 0)
    shop.jet(body, (x + size * 0.3, y), math.pi, mass / 2, 1)
    for _ in range(shop.dice.choice((0, 1, 2, 3, 4))):
        at = (shop.between(0.5, 4.5), shop.between(1.3, 3.2))
        if shop.chance(0.5):
            shop.ball(*at, shop.between(0.08, 0.2), fixed=True)
        else:
            lean = shop.between(-0.6, 0.6)
            shop.box(*at, shop.between(0.6, 1.8), 0.12, fixed=True, angle=lean)
    goal = shop.between(0.4, 4.6)
    shop.box(goal, FLOOR + 0.1, shop.between(0.5, 1.2), 0.2, role=shop.goal, fixed=True)
    shop.deadly(0.6, "floor")
    shop.furniture = False


def sledding(shop: Workshop) -> None:
    """A sled with jets to both sides and a pole on it that nothing holds up."""
    x, width = shop.between(1.0, 4.0), shop.between(0.5, 1.0)
    y = shop.ground + 0.12
    sled = shop.box(x, y, width, 0.2, friction=shop.between(0.0, 0.3))
    shop.jet(sled, (x - width * 0.4, y), 0.0, width * 0.4, 0)
    shop.jet(sled, (x + width * 0.4, y), math.pi, width * 0.4, 1)
    top = y + 0.1
    if shop.chance(0.6):
        lean = math.pi / 2 + shop.between(-0.08, 0.08)
        pole, end = shop.rod((x, top), lean, shop.between(0.5, 1.2), role=shop.tip)
        shop.build.hinge(sled, pole, (x, top))
        height = end[1] - shop.between(0.0, 0.4)
    else:
        shop.ball(x, top + 0.2, 0.18, role=shop.tip)
        height = top + 0.2
    side = 1 if x < 2.5 else -1
    goal = min(max(x + side * shop.between(0.7, 2.5), 0.3), 4.7)
    shop.lump(goal, height, 0.4, role=shop.goal, fixed=True)
    shop.deadly(0.6, "floor")
