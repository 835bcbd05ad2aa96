"""Rows of dominoes, the first of which is pushed."""

import random

from kinetix.level.builder import LevelBuilder
from kinetix.scenes.everyday.model import FLOOR, EverydayClass, EverydayScene, Room, scene


def _make(rng: random.Random, room: Room) -> EverydayScene:
    height = rng.uniform(0.25, 0.5)
    thickness = height * rng.uniform(0.1, 0.25)
    pitch = thickness + height * rng.uniform(0.25, 0.6)
    count = min(room.polygons, rng.randint(4, 20), int(4.2 / pitch))
    friction = rng.choice((0.3, 1.0))
    b = LevelBuilder("Dominoes")
    for k in range(count):
        spin = rng.uniform(-4.0, -2.5) if k == 0 else 0.0
        b.rectangle(
            0.4 + k * pitch,
            FLOOR + height / 2,
            thickness,
            height,
            friction=friction,
            # It turns about its lower right edge.
            angular_velocity=spin,
            velocity=(-spin * height / 2, -spin * thickness / 2),
        )
    return scene(b.build(), 0.3 + 0.15 * count)


DOMINOES = EverydayClass(
    name="dominoes",
    note="a row of dominoes that falls",
    make=_make,
    rooms=("l", "custom"),
)
