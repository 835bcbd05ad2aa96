"""Machines on legs, and chains that crawl."""

import math

from kinetix.environment.generators.machines.surroundings import far_goal
from kinetix.environment.generators.machines.workshop import Workshop


def crawling(shop: Workshop, links: int = 2) -> None:
    """A chain of links with motors on the floor."""
    x, thick = shop.between(0.4, 1.2), shop.between(0.14, 0.26)
    at, last = (x, shop.ground + thick / 2 + 0.02), None
    tip = shop.dice.choice((0, links - 1))
    one_key = shop.chance(0.2)
    for index in range(links):
        length = shop.between(0.35, 0.9)
        up = shop.between(-0.05, 0.9) if index else 0.0
        bar, end = shop.rod(at, up, length, role=shop.tip if index == tip else "none")
        if last is not None:
            motor = shop.motor(0 if one_key else index, speed=(0.3, 1.5), power=(0.8, 3.0))
            shop.build.hinge(last, bar, at, motor=motor)
        at, last = end, bar
    far_goal(shop, max(at[0], x + 0.5), reach=shop.between(1.0, 3.0))


def caterpillar(shop: Workshop) -> None:
    """A crawler of three to five links."""
    crawling(shop, links=shop.dice.choice((3, 4, 5)))


def stepping(shop: Workshop) -> None:
    """A trunk on two legs of one or two links."""
    x, trunk = shop.between(0.9, 1.8), (shop.between(0.4, 1.1), shop.between(0.15, 0.4))
    joints = shop.dice.choice((1, 1, 2))
    length = shop.between(0.35, 0.7) / (1 if joints == 1 else 1.4)
    hip = shop.ground + joints * length + 0.06
    body = shop.box(x, hip + trunk[1] / 3, *trunk, role=shop.tip)
    spread = shop.dice.choice((0.0, trunk[0] / 2 - 0.05))
    for leg, side in enumerate((-1, 1)):
        last, at = body, (x + side * spread, hip)
        for joint in range(joints):
            lean = -math.pi / 2 + side * shop.between(0.0, 0.4) * (1 if joint == 0 else -1)
            bar, end = shop.rod(at, lean, length, friction=1.0)
            limits = (-1.2, 1.2) if shop.chance(0.5) else None
            motor = shop.motor(2 * joint + leg, speed=(0.3, 1.5), power=(0.8, 3.0))
            shop.build.hinge(last, bar, at, motor=motor, limits=limits)
            last, at = bar, end
    far_goal(shop, x, reach=shop.between(1.0, 3.0))


def hopping(shop: Workshop) -> None:
    """A trunk on one leg of two or three links."""
    x, trunk = shop.between(0.9, 2.0), (shop.between(0.3, 0.8), shop.between(0.15, 0.4))
    links, length = shop.dice.choice((2, 2, 3)), shop.between(0.3, 0.55)
    lean = shop.between(0.2, 0.7)
    rise = links * length * math.cos(lean)
    hip = shop.ground + rise + 0.12
    last, at = shop.box(x, hip + trunk[1] / 3, *trunk, role=shop.tip), (x, hip)
    for joint in range(links):
        side = 1 if joint % 2 else -1
        link, end = shop.rod(at, -math.pi / 2 + side * lean, length, friction=1.0)
        motor = shop.motor(joint, speed=(0.4, 1.8), power=(1.0, 3.0))
        limits = (-1.2, 1.2) if shop.chance(0.5) else None
        shop.build.hinge(last, link, at, motor=motor, limits=limits)
        last, at = link, end
    far_goal(shop, x, reach=shop.between(1.0, 3.0))
    shop.deadly(0.3, "floor")
