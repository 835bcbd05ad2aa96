"""Machines on driven wheels."""

import math

from kinetix.environment.generators.machines.surroundings import far_goal
from kinetix.environment.generators.machines.workshop import Workshop
from kinetix.level.model import Point


def car(shop: Workshop) -> tuple[int, Point]:
    """A board on driven wheels.

    Returns:
        The board, and the middle of its top.
    """
    length = shop.between(0.5, 1.3)
    radius = min(shop.between(0.12, 0.3), length * 0.2)
    thick = shop.between(0.1, 0.4)
    x = shop.between(0.7, 2.0)
    axle = shop.ground + radius
    wheel_tip = shop.chance(0.15)
    board = shop.box(x, axle + thick / 2, length, thick, role="none" if wheel_tip else shop.tip)
    one_key, driven = shop.chance(0.7), shop.dice.choice(("both", "both", "one"))
    motor = shop.motor(0, speed=(0.6, 3.0), power=(0.5, 2.5))
    # With wheels further out these would meet the goal first, not the board.
    reach = length / 2 - shop.between(0.0 if wheel_tip else 0.9, 1.4) * radius
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
        crate = shop.box(x, shop.ground + size / 2, size, size, friction=shop.between(0, 0.5))
        shop.jet(crate, (x - size / 2, shop.ground + size / 2), 0.0, size * size, 0)
    shop.tip = tip
    shop.lump(x + shop.between(0.9, 1.5), shop.ground + 0.3, shop.between(0.25, 0.5), role=tip)
    far_goal(shop, x + 1.0, ahead=True)


def balancing(shop: Workshop) -> None:
    """A pole on a driven wheel."""
    x, radius, length = shop.between(0.8, 3.0), shop.between(0.15, 0.35), shop.between(0.4, 1.4)
    axle = (x, shop.ground + radius)
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


def balancing_act(shop: Workshop) -> None:
    """A car with a pole that nothing holds up; the pole has to touch, higher up."""
    tip, shop.tip = shop.tip, "none"
    board, (x, y) = car(shop)
    shop.tip = tip
    length = shop.between(0.5, 1.3)
    pole, end = shop.rod((x, y), math.pi / 2 + shop.between(-0.1, 0.1), length, role=tip)
    shop.build.hinge(board, pole, (x, y))
    goal = min(x + shop.between(0.6, 1.6), 4.6)
    shop.lump(goal, end[1] - shop.between(0.0, 0.5), 0.45, role=shop.goal, fixed=True)
    shop.deadly(0.5, "floor")


def hauling(shop: Workshop) -> None:
    """A car with a loose load that has to touch."""
    tip, shop.tip = shop.tip, "none"
    _, (x, y) = car(shop)
    shop.tip = tip
    size = shop.between(0.15, 0.4)
    shop.lump(x + shop.between(-0.1, 0.1), y + size * 0.7, size, role=tip, friction=1.0)
    far_goal(shop, x)
    shop.deadly(0.4, "floor")


def reversing(shop: Workshop) -> None:
    """A car with a trailer; the trailer has to touch, in front or behind."""
    tip, shop.tip = shop.tip, "none"
    board, (x, y) = car(shop)
    shop.tip = tip
    length, radius = shop.between(0.4, 0.7), shop.between(0.12, 0.2)
    x += 0.6 + length / 2
    hitch = (x - length / 2, y - 0.05)
    trailer = shop.box(x, y - 0.05, length, shop.between(0.1, 0.25), role=tip)
    shop.build.hinge(board, trailer, hitch)
    wheel = shop.ball(x + length / 3, shop.ground + radius, radius)
    shop.build.hinge(trailer, wheel, (x + length / 3, shop.ground + radius))
    far_goal(shop, x)


def trundling(shop: Workshop) -> None:
    """A body on one driven wheel, its other end on the floor."""
    x, radius, length = shop.between(0.8, 2.2), shop.between(0.15, 0.4), shop.between(0.6, 1.4)
    axle = (x, shop.ground + radius)
    on_wheel = shop.chance(0.3)
    wheel = shop.ball(*axle, radius, friction=1.0, role=shop.tip if on_wheel else "none")
    lean = math.pi - math.asin(min(radius * 0.8 / length, 0.9)) * -1
    bar, _ = shop.rod(axle, lean, length, role="none" if on_wheel else shop.tip)
    shop.build.hinge(bar, wheel, axle, motor=shop.motor(0, speed=(0.6, 2.5), power=(0.6, 2.5)))
    far_goal(shop, x)
