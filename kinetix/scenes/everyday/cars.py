"""Cars: a chassis on driven wheels, alone, under a load, or over bumps."""

import random

from kinetix.level.builder import LevelBuilder
from kinetix.level.model import Motor
from kinetix.scenes.everyday.model import FLOOR, EverydayClass, EverydayScene, Room, scene


def _make(rng: random.Random, room: Room) -> EverydayScene:
    radius = rng.uniform(0.12, 0.25)
    length, height = rng.uniform(0.7, 1.2), rng.uniform(0.12, 0.3)
    x, y = 0.9, FLOOR + radius + height / 2
    floor = 0.0
    b = LevelBuilder("Car")
    tiles = min(room.polygons - 2, rng.choice((0, 0, 5, 6)))
    if tiles >= 5:
        floor = 0.1
        for k in range(tiles):
            b.rectangle((k + 0.5) * 5 / tiles, FLOOR + floor / 2, 5 / tiles, floor, fixed=True)
    y += floor
    motor = Motor(speed=rng.uniform(0.5, 2.0), power=rng.uniform(0.3, 3.0))
    chassis = b.rectangle(x, y, length, height)
    for side in (-1, 1):
        place = (x + side * length * 0.35, FLOOR + floor + radius)
        driven = side == -1 or rng.random() < 0.5
        b.hinge(chassis, b.circle(*place, radius), place, motor=motor if driven else None)
    if room.polygons - tiles >= 2 and rng.random() < 0.5:
        load = rng.uniform(0.1, 0.3)
        b.rectangle(x, y + (height + load) / 2, load, load, density=rng.choice((1.0, 5.0)))
    # Until it is near the right wall.
    seconds = min(3.0, 2.5 / (6 * motor.speed * radius))
    return scene(b.build(), seconds, motor=-1.0)


CARS = EverydayClass(
    name="cars",
    note="driven wheels under a chassis, over the floor or tiles",
    make=_make,
    rooms=("m", "l", "custom"),
)
