"""Machines that several levels share."""

import dataclasses
from typing import Any

from kinetix.level.model import Point, Role
from scripts.library.draft import LEFT_RIGHT, Draft


@dataclasses.dataclass(frozen=True, kw_only=True)
class Car:
    """Ids of a car's bodies, and where its wheels stand."""

    chassis: int
    front: int
    """The right wheel."""


def car(
    draft: Draft,
    x: float,
    ground: float,
    *,
    length: float = 0.9,
    height: float = 0.18,
    radius: float = 0.17,
    role: Role = "green",
    wheel_roles: tuple[Role, Role] = ("none", "none"),
    speed: float = 2.0,
    power: float = 1.5,
    **more: Any,
) -> Car:
    """A board on two driven wheels that stand on the ground; Left drives left."""
    axle = ground + radius
    # The wheels stay just behind the board's ends, so that the board is what arrives first.
    reach = length / 2 - radius - 0.02
    chassis = draft.box((x, axle + height / 2), length, height, role, **more)
    rear, front = (
        draft.ball((x + side * reach, axle), radius, wheel_role)
        for side, wheel_role in zip((-1, 1), wheel_roles, strict=True)
    )
    for side, wheel in ((-1, rear), (1, front)):
        draft.hinge(
            chassis,
            wheel,
            (x + side * reach, axle),
            control=LEFT_RIGHT,
            speed=speed,
            power=power,
        )
    return Car(chassis=chassis, front=front)


def arm(
    draft: Draft,
    hub: Point,
    links: tuple[tuple[float, float, Role], ...],
    *,
    speed: float = 0.5,
    power: float = 1.0,
    hub_radius: float = 0.14,
) -> tuple[list[int], Point]:
    """A motor arm on a fixed hub; each link is (direction [°], length [m], role).

    Returns:
        Ids of the links and where the last one ends. Link k turns with control k.
    """
    last = draft.ball(hub, hub_radius, fixed=True)
    at, made = hub, []
    for control, (degrees, length, role) in enumerate(links):
        bar, end = draft.rod(at, degrees, length, role, width=0.14)
        draft.hinge(last, bar, at, control=control, speed=speed, power=power)
        last, at = bar, end
        made.append(bar)
    return made, at
