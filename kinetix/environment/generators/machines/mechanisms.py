"""Machines that pass a load on: drums and levers."""

import math

from kinetix.environment.generators.machines.surroundings import far_goal
from kinetix.environment.generators.machines.workshop import FLOOR, Workshop


def rolling(shop: Workshop) -> None:
    """A load on driven drums that stay where they are."""
    x, y, radius = shop.between(1.0, 2.5), shop.between(0.9, 2.5), shop.between(0.2, 0.35)
    count, apart = shop.dice.choice((1, 2, 2)), 2 * radius + shop.between(0.1, 0.4)
    one_key = shop.chance(0.6)
    motor = shop.motor(0, speed=(0.5, 2.0), power=(1.0, 3.0))
    for index in range(count):
        at = (x + index * apart, y)
        drum = shop.ball(*at, radius, friction=1.0)
        own = motor if one_key or not index else motor.replace(binding=shop.keys[1])
        shop.build.hinge(shop.build.floor, drum, at, motor=own)
    width = shop.between(0.3, 0.5) + (count - 1) * apart
    load = shop.between(0.1, 0.3)
    shop.box(x + (count - 1) * apart / 2, y + radius + load / 2 + 0.03, width, load, role=shop.tip)
    side = shop.dice.choice((-1, 1))
    goal = x + side * shop.between(1.0, 1.8) + (count - 1) * apart / 2
    goal = min(max(goal, 0.4), 4.6)
    shop.lump(goal, shop.between(FLOOR + 0.3, y + 0.3), 0.5, role=shop.goal, fixed=True)


def guiding(shop: Workshop) -> None:
    """A falling ball and a lever that sends it to one side."""
    x, y = shop.between(1.6, 3.4), shop.between(1.2, 2.6)
    hub = shop.ball(x, y, 0.1, fixed=True)
    length = shop.between(0.7, 1.6)
    lever = shop.box(x, y + 0.2, length, shop.between(0.08, 0.16))
    limits = (-shop.between(0.3, 1.0), shop.between(0.3, 1.0)) if shop.chance(0.6) else None
    motor = shop.motor(0, speed=(0.2, 1.2), power=(0.6, 2.5))
    shop.build.hinge(hub, lever, (x, y + 0.2), motor=motor, limits=limits)
    drop = x + shop.between(-0.4, 0.4) * length
    shop.ball(drop, min(y + shop.between(0.7, 2.0), 4.6), shop.between(0.14, 0.3), role=shop.tip)
    side = shop.dice.choice((-1, 1))
    goal = min(max(x + side * shop.between(1.0, 1.9), 0.4), 4.6)
    shop.lump(goal, FLOOR + shop.between(0.2, 0.6), 0.5, role=shop.goal, fixed=shop.chance(0.7))
    if shop.chance(0.5):
        other = min(max(x - side * shop.between(0.9, 1.6), 0.4), 4.6)
        shop.lump(other, FLOOR + 0.25, 0.45, role="red", fixed=True)
    shop.furniture = False


def tilting(shop: Workshop) -> None:
    """A ball on one or two trays that motors tilt; the goal is at one side below."""
    x, y = shop.between(1.6, 3.4), shop.between(1.4, 3.4)
    length, radius = shop.between(1.2, 1.9), shop.between(0.12, 0.25)
    levels = shop.dice.choice((1, 1, 2))
    side = shop.dice.choice((-1, 1))
    for index in range(levels):
        at = (min(max(x + index * side * length * 0.6, 0.9), 4.1), y - index * 1.0)
        tray = shop.box(*at, length, 0.12, friction=1.0)
        motor = shop.motor(index, speed=(0.1, 0.6), power=(1.0, 3.0))
        limits = (-0.6, 0.6) if shop.chance(0.5) else None
        hub = shop.ball(at[0], at[1] - 0.2, 0.08, fixed=True)
        shop.build.hinge(hub, tray, (at[0], at[1] - 0.2), motor=motor, limits=limits)
    shop.ball(x + shop.between(-0.3, 0.3) * length, y + 0.08 + radius, radius, role=shop.tip)
    goal = min(max(x + side * shop.between(0.9, 2.0), 0.4), 4.6)
    shop.lump(goal, FLOOR + shop.between(0.25, 0.5), 0.5, role=shop.goal, fixed=shop.chance(0.8))
    if shop.chance(0.6):
        other = min(max(x - side * shop.between(0.7, 1.8), 0.4), 4.6)
        shop.lump(other, FLOOR + 0.25, 0.45, role="red", fixed=True)
    shop.furniture = False


def seesaw(shop: Workshop) -> None:
    """A heavy ball that jets push onto one end of a plank; the other end throws a box."""
    x, length = shop.between(2.0, 3.0), shop.between(1.4, 1.9)
    y, side = FLOOR + shop.between(0.25, 0.5), shop.dice.choice((-1, 1))
    plank = shop.box(x, y, length, 0.12)
    shop.build.hinge(shop.build.floor, plank, (x, y), limits=(-0.35, 0.35))
    size = shop.between(0.2, 0.35)
    shop.box(x + side * length * 0.42, y + 0.08 + size / 2, size, size, role=shop.tip)
    tower = x - side * (length / 2 + shop.between(0.15, 0.4))
    height, radius = shop.between(0.6, 2.0), shop.between(0.18, 0.3)
    shop.box(tower, FLOOR + height / 2, 0.3, height, fixed=True)
    weight = shop.ball(tower, FLOOR + height + radius, radius, density=shop.between(1.5, 4.0))
    mass = 3.0 * radius * radius * shop.build.build().bodies[-1].density
    direction = 0.0 if side == 1 else math.pi
    shop.jet(weight, (tower, FLOOR + height + radius), direction, mass / 3, 0)
    shop.jet(weight, (tower, FLOOR + height + radius), math.pi - direction, mass / 3, 1)
    goal = x + side * length * shop.between(0.1, 0.8)
    shop.lump(min(max(goal, 0.4), 4.6), y + shop.between(0.8, 2.2), 0.5, role=shop.goal, fixed=True)
    shop.furniture = False


def wrecking(shop: Workshop) -> None:
    """A driven hammer and a slab on pillars that has to come down."""
    x, height = shop.between(2.4, 3.8), shop.between(0.5, 1.3)
    width = shop.between(0.6, 1.2)
    for side in (-1, 1)[: shop.dice.choice((1, 2, 2))]:
        at = x + side * width * 0.35
        shop.box(at, FLOOR + height / 2, shop.between(0.12, 0.3), height)
    shop.box(x, FLOOR + height + 0.1, width, 0.18, role=shop.tip)
    hub = (x - width / 2 - shop.between(0.5, 1.0), FLOOR + height + shop.between(0.6, 1.6))
    base = shop.ball(*hub, 0.08, fixed=True)
    direction = shop.between(-math.pi, -math.pi / 2)
    rod, end = shop.rod(hub, direction, min(hub[1] - FLOOR - 0.35, shop.between(0.8, 1.6)))
    motor = shop.motor(0, speed=(0.4, 1.8), power=(0.5, 2.5))
    shop.build.hinge(base, rod, hub, motor=motor)
    if shop.chance(0.7):
        head = shop.ball(*end, shop.between(0.15, 0.28), density=shop.between(1.0, 3.0))
        shop.build.weld(rod, head, end)
    if shop.chance(0.6):
        shop.arena["floor"] = shop.goal
    else:
        far_goal(shop, x)
    shop.furniture = False
