"""Machines that stand: arms, bats, pendulums."""

import math

from kinetix.environment.generators.machines.surroundings import far_goal, goal_around
from kinetix.environment.generators.machines.workshop import FLOOR, Workshop


def reaching(shop: Workshop, links: int | None = None) -> None:
    """An arm on a fixed hub; its last link has to touch."""
    hub = (shop.between(1.2, 3.8), shop.between(0.9, 3.6))
    links = shop.dice.choice((1, 2, 2)) if links is None else links
    base = shop.ball(*hub, shop.between(0.08, 0.2), fixed=True)
    last, at, reach = base, hub, 0.0
    direction = shop.between(-math.pi, math.pi)
    for index in range(links):
        length = shop.between(0.5, 1.1) * (1.0 if links < 3 else 0.7)
        direction += shop.between(-1.0, 1.0)
        role = shop.tip if index == links - 1 else "none"
        bar, end = shop.rod(at, direction, length, role=role)
        limits = (-shop.between(0.5, 2.5), shop.between(0.5, 2.5)) if shop.chance(0.15) else None
        motor = shop.motor(index, speed=(0.2, 1.2), power=(0.6, 2.5))
        shop.build.hinge(last, bar, at, motor=motor, limits=limits)
        last, at, reach = bar, end, reach + length
    goal_around(shop, hub, reach * shop.between(0.5, 1.15))
    shop.furniture = False


def long_arm(shop: Workshop) -> None:
    """An arm of three or four links."""
    reaching(shop, links=shop.dice.choice((3, 4)))


def batting(shop: Workshop) -> None:
    """A lever with a motor that hits or throws a ball at the goal."""
    x, y = shop.between(0.8, 2.2), shop.between(0.7, 2.4)
    hub = shop.ball(x, y, 0.1, fixed=True)
    direction = shop.between(-math.pi, math.pi)
    club, end = shop.rod((x, y), direction, shop.between(0.5, 1.2))
    motor = shop.motor(0, speed=(0.8, 3.0), power=(0.6, 3.0))
    shop.build.hinge(hub, club, (x, y), motor=motor)
    where = shop.dice.choice(("tee", "floor", "falling", "on"))
    radius = shop.between(0.12, 0.28)
    ball_x = x + shop.between(0.0, 1.2)
    if where == "on":
        shop.ball((x + 2 * end[0]) / 3, max(y, end[1]) + 0.15 + radius, radius, role=shop.tip)
    elif where == "falling":
        shop.ball(ball_x, y + shop.between(1.0, 2.2), radius, role=shop.tip)
    elif where == "floor":
        shop.ball(ball_x, FLOOR + radius, radius, role=shop.tip)
    else:
        top = shop.between(0.2, 1.2)
        shop.box(ball_x, FLOOR + top / 2, 0.35, top, fixed=True)
        shop.ball(ball_x, FLOOR + top + radius, radius, role=shop.tip)
    far_goal(shop, ball_x)


def swinging(shop: Workshop) -> None:
    """A pendulum with a jet or a weak motor, the goal higher up."""
    hub = (shop.between(1.5, 3.5), shop.between(2.0, 3.6))
    length = shop.between(0.8, min(1.5, hub[1] - 0.5))
    base = shop.ball(*hub, 0.1, fixed=True)
    bar, end = shop.rod(hub, -math.pi / 2 + shop.between(-0.5, 0.5), length, role=shop.tip)
    if shop.chance(0.5):
        shop.build.hinge(base, bar, hub)
        shop.jet(bar, end, 0.0 if shop.chance(0.5) else math.pi, length * 0.12, 0)
    else:
        motor = shop.motor(0, speed=(0.3, 1.5), power=(0.05, 0.6))
        shop.build.hinge(base, bar, hub, motor=motor)
    angle = shop.between(-0.2, math.pi + 0.2)
    reach = length + shop.between(-0.1, 0.2)
    x, y = hub[0] + reach * math.cos(angle), hub[1] + reach * math.sin(angle)
    shop.lump(min(max(x, 0.3), 4.7), min(max(y, 0.7), 4.7), 0.4, role=shop.goal, fixed=True)
    shop.furniture = False
