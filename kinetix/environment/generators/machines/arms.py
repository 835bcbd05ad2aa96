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


def catching(shop: Workshop) -> None:
    """A bat that has to meet a ball in flight."""
    x, y = shop.between(1.2, 3.8), shop.between(0.9, 2.6)
    hub = shop.ball(x, y, 0.1, fixed=True)
    bat, _ = shop.rod(
        (x, y), shop.between(-math.pi, math.pi), shop.between(0.6, 1.3), role=shop.goal
    )
    motor = shop.motor(0, speed=(0.4, 2.5), power=(0.6, 3.0))
    shop.build.hinge(hub, bat, (x, y), motor=motor)
    side, radius = shop.dice.choice((-1, 1)), shop.between(0.1, 0.25)
    start = (min(max(x + side * shop.between(0.4, 2.0), 0.3), 4.7), shop.between(y + 0.5, 4.6))
    velocity = (-side * shop.between(0.0, 2.5), shop.between(-1.0, 2.0))
    shop.ball(*start, radius, role=shop.tip, velocity=velocity)
    shop.deadly(0.8, "floor")
    shop.furniture = False


def flipping(shop: Workshop) -> None:
    """One or two flippers under a falling ball; the goal is above them."""
    y, middle = shop.between(0.8, 1.4), shop.between(1.8, 3.2)
    radius, apart = shop.between(0.1, 0.2), shop.between(0.7, 1.2)
    sides = shop.dice.choice(((-1, 1), (-1, 1), (-1,), (1,)))
    for index, side in enumerate(sides):
        hub = (middle + side * apart, y)
        base = shop.ball(*hub, 0.08, fixed=True)
        slope = math.pi / 2 + side * (math.pi / 2 + shop.between(0.1, 0.4))
        lever, _ = shop.rod(hub, slope, apart - 0.1, friction=0.5)
        reach = shop.between(0.6, 1.2)
        limits = (-reach, 0.05) if side == 1 else (-0.05, reach)
        motor = shop.motor(index, speed=(1.0, 3.0), power=(1.0, 3.0))
        shop.build.hinge(base, lever, hub, motor=motor, limits=limits)
    drop = middle + shop.between(-0.8, 0.8) * apart
    shop.ball(drop, y + shop.between(0.8, 1.8), radius, role=shop.tip, restitution=0.3)
    goal = min(max(middle + shop.between(-1.2, 1.2), 0.4), 4.6)
    shop.lump(goal, y + shop.between(0.4, 1.5), 0.5, role=shop.goal, fixed=True)
    shop.deadly(0.6, "floor")
    shop.furniture = False
