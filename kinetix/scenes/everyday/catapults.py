"""Catapults: a weight or a motor throws a ball from an arm."""

import random

from kinetix.level.builder import LevelBuilder
from kinetix.level.model import Motor
from kinetix.scenes.everyday.model import FLOOR, EverydayClass, EverydayScene, Room, scene


def _make(rng: random.Random, room: Room) -> EverydayScene:
    b = LevelBuilder("Catapult")
    length, width = rng.uniform(1.0, 2.0), rng.uniform(0.06, 0.12)
    share = rng.uniform(0.5, 0.75)
    pivot = (2.0, FLOOR + rng.uniform(0.5, 0.9))
    # The long end is on the left.
    x = pivot[0] + length * (0.5 - share)
    arm = b.rectangle(x, pivot[1], length, width)
    driven = rng.random() < 0.4
    motor = Motor(speed=rng.uniform(0.5, 2.0), power=rng.uniform(0.1, 1.0)) if driven else None
    b.hinge(b.floor, arm, pivot, motor=motor, limits=(-rng.uniform(0.3, 0.9), 0.3))
    top = pivot[1] + width / 2
    ball = rng.uniform(0.05, 0.12)
    b.circle(x - length / 2 + ball, top + ball, ball)
    if not driven and (room.polygons > 1 or room.circles > 1):
        weight = rng.uniform(0.1, 0.2)
        right = x + length / 2 - weight
        drop = rng.uniform(0.0, 1.0)
        density = rng.choice((2.0, 10.0))
        if room.polygons > 1:
            b.rectangle(right, top + weight + drop, 2 * weight, 2 * weight, density=density)
        else:
            b.circle(right, top + weight + drop, weight, density=density)
    return scene(b.build(), 1.0, motor=-1.0 if driven else 0.0)


CATAPULTS = EverydayClass(
    name="catapults",
    note="an arm that throws a ball",
    make=_make,
    rooms=("s", "m", "l", "custom"),
)
