"""Machines with jets."""

import math

from kinetix.environment.generators.machines.surroundings import goal_anywhere
from kinetix.environment.generators.machines.workshop import FLOOR, Workshop


def flying(shop: Workshop) -> None:
    """A body with one or two jets; the goal is anywhere."""
    width, height = shop.between(0.25, 0.8), shop.between(0.2, 0.6)
    x = shop.between(0.5, 4.5)
    y = FLOOR + height / 2 + (shop.between(0.3, 3.0) if shop.chance(0.4) else 0.02)
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
