"""Machines that pass a load on: drums and levers."""

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
