"""The families of machines: each function makes one, of random measures, and its goal."""

import math
from collections.abc import Callable
from typing import Final

from kinetix.environment.generators.machines.surroundings import (
    far_goal,
    goal_anywhere,
    goal_around,
)
from kinetix.environment.generators.machines.workshop import FLOOR, Workshop
from kinetix.level.model import Point


def car(shop: Workshop) -> tuple[int, Point]:
    """A board on driven wheels.

    Returns:
        The board, and the middle of its top.
    """
    length, radius = shop.between(0.5, 1.3), shop.between(0.12, 0.3)
    thick = shop.between(0.1, 0.4)
    x = shop.between(0.7, 2.0)
    axle = FLOOR + radius
    wheel_tip = shop.chance(0.15)
    board = shop.box(x, axle + thick / 2, length, thick, role="none" if wheel_tip else shop.tip)
    one_key, driven = shop.chance(0.7), shop.dice.choice(("both", "both", "one"))
    motor = shop.motor(0, speed=(0.6, 3.0), power=(0.5, 2.5))
    reach = length / 2 - shop.between(-0.1, 0.6) * radius
    for index, side in enumerate((-1, 1)):
        role = shop.tip if wheel_tip and side == 1 else "none"
        wheel = shop.ball(x + side * reach, axle, radius, role=role, friction=1.0)
        own = motor if one_key or index == 0 else motor.replace(binding=shop.keys[1])
        off = driven == "one" and side == 1
        shop.build.hinge(board, wheel, (x + side * reach, axle), motor=None if off else own)
    return board, (x, axle + thick)


def driving(shop: Workshop) -> None:
    """A car that has to get somewhere."""
    _, (x, _) = car(shop)
    far_goal(shop, x)


def pushing(shop: Workshop) -> None:
    """A car or a crate with a jet that pushes a ball to the goal."""
    tip, shop.tip = shop.tip, "none"
    if shop.chance(0.5):
        _, (x, _) = car(shop)
    else:
        x, size = shop.between(0.5, 1.5), shop.between(0.3, 0.6)
        crate = shop.box(x, FLOOR + size / 2, size, size, friction=shop.between(0, 0.5))
        shop.jet(crate, (x - size / 2, FLOOR + size / 2), 0.0, size * size, 0)
    shop.tip = tip
    shop.lump(x + shop.between(0.9, 1.5), FLOOR + 0.3, shop.between(0.25, 0.5), role=tip)
    far_goal(shop, x + 1.0)


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


def balancing(shop: Workshop) -> None:
    """A pole on a driven wheel."""
    x, radius, length = shop.between(0.8, 3.0), shop.between(0.15, 0.35), shop.between(0.4, 1.4)
    axle = (x, FLOOR + radius)
    wheel = shop.ball(*axle, radius, friction=1.0)
    lean = math.pi / 2 + shop.between(-0.1, 0.1)
    pole, end = shop.rod(axle, lean, length, role=shop.tip)
    shop.build.hinge(pole, wheel, axle, motor=shop.motor(0, speed=(0.8, 3.0), power=(0.8, 3.0)))
    if shop.chance(0.3):
        shop.jet(pole, end, 0.0 if shop.chance(0.5) else math.pi, length * 0.2, 0)
    if shop.chance(0.5):
        shop.lump(x + shop.between(0.9, 2.0), end[1] - 0.15, 0.5, role=shop.goal, fixed=True)
    else:
        far_goal(shop, x)


def crawling(shop: Workshop, links: int = 2) -> None:
    """A chain of links with motors on the floor."""
    x, thick = shop.between(0.4, 1.2), shop.between(0.14, 0.26)
    at, last = (x, FLOOR + thick / 2 + 0.02), None
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
    far_goal(shop, max(at[0], x + 0.5))


def stepping(shop: Workshop) -> None:
    """A trunk on two legs of one or two links."""
    x, trunk = shop.between(0.9, 1.8), (shop.between(0.4, 1.1), shop.between(0.15, 0.4))
    joints = shop.dice.choice((1, 1, 2))
    length = shop.between(0.35, 0.7) / (1 if joints == 1 else 1.4)
    hip = FLOOR + joints * length + 0.06
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
    far_goal(shop, x)


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


def arm_on_wheels(shop: Workshop) -> None:
    """A car with an arm; the arm's end has to touch."""
    tip, shop.tip = shop.tip, "none"
    board, (x, y) = car(shop)
    shop.tip = tip
    links = shop.dice.choice((1, 2))
    last, at, direction = board, (x, y), math.pi / 2
    for index in range(links):
        direction += shop.between(-0.7, 0.7)
        role = tip if index == links - 1 else "none"
        bar, end = shop.rod(at, direction, shop.between(0.4, 0.9), role=role, density=0.4)
        motor = shop.motor(2 + index, speed=(0.2, 0.8), power=(0.5, 2.0))
        shop.build.hinge(last, bar, at, motor=motor)
        last, at = bar, end
    goal = min(x + shop.between(0.8, 3.0), 4.6)
    shop.lump(goal, shop.between(0.9, 2.6), 0.4, role=shop.goal, fixed=True)


def long_arm(shop: Workshop) -> None:
    """An arm of three or four links."""
    reaching(shop, links=shop.dice.choice((3, 4)))


def caterpillar(shop: Workshop) -> None:
    """A crawler of three to five links."""
    crawling(shop, links=shop.dice.choice((3, 4, 5)))


Family = Callable[[Workshop], None]

FAMILIES: Final[dict[Family, int]] = {
    driving: 3,
    pushing: 2,
    reaching: 3,
    flying: 3,
    batting: 3,
    balancing: 2,
    crawling: 2,
    stepping: 3,
    rolling: 2,
    guiding: 2,
    towing: 1,
    swinging: 1,
    arm_on_wheels: 2,
    long_arm: 1,
    caterpillar: 2,
}
"""Families of machines, and how often each is tried."""
