"""Doors on hinges: hit by a ball, or driven against what stands in the way."""

import math
import random

from kinetix.level.builder import LevelBuilder
from kinetix.level.model import Motor
from kinetix.scenes.everyday.model import FLOOR, EverydayClass, EverydayScene, Room, scene


def _make(rng: random.Random, room: Room) -> EverydayScene:
    b = LevelBuilder("Door", gravity=(0.0, rng.choice((0.0, -9.81))))
    height, width = rng.uniform(0.8, 1.6), rng.uniform(0.05, 0.12)
    hanging = rng.random() < 0.6
    top = 2.5
    y = top - height / 2 if hanging else FLOOR + height / 2 + 0.01
    door = b.rectangle(2.5, y, width, height)
    pivot = (2.5, top) if hanging else (2.5, FLOOR + 0.01)
    driven = rng.random() < 0.3
    motor = Motor(speed=rng.uniform(0.2, 1.0), power=rng.uniform(0.2, 2.0)) if driven else None
    limit = rng.uniform(0.4, 1.4)
    frame = b.ceiling if hanging else b.floor
    b.hinge(frame, door, pivot, motor=motor, limits=(-limit, limit))
    ball = rng.uniform(0.05, 0.15)
    speed = math.exp(rng.uniform(math.log(1.0), math.log(20.0)))
    x = 1.5 if not driven else 2.5 + 0.4 * height
    velocity = (speed, 0.0) if not driven else (0.0, 0.0)
    b.circle(x, y, ball, velocity=velocity, restitution=rng.choice((0.0, 0.5)))
    if room.polygons > 1:
        size = rng.uniform(0.1, 0.3)
        b.rectangle(3.4, FLOOR + size / 2, size, size)
    return scene(b.build(), 0.8, motor=rng.choice((-1.0, 1.0)) if driven else 0.0)


DOORS = EverydayClass(
    name="doors",
    note="a door on a hinge with limits, hit or driven",
    make=_make,
    rooms=("s", "m", "l", "custom"),
)
