"""Towers: one box on the other, of one kind, tapering, or light and heavy in turn."""

import random

from kinetix.level.builder import LevelBuilder
from kinetix.scenes.everyday.model import FLOOR, EverydayClass, EverydayScene, Room, scene


def _make(rng: random.Random, room: Room) -> EverydayScene:
    count = rng.randint(min(2, room.polygons), min(10, room.polygons))
    height = rng.uniform(0.1, min(0.5, 4.0 / count))
    width = height * rng.uniform(0.8, 2.0)
    taper = rng.choice((0.0, 0.0, 0.05))
    ratio = rng.choice((1.0, 1.0, 5.0, 20.0))
    b = LevelBuilder("Tower")
    x = rng.uniform(0.8, 4.2)
    boxes = [
        b.rectangle(
            x,
            FLOOR + (k + 0.5) * height,
            width * (1 - taper * k),
            height,
            density=ratio if k % 2 else 1.0,
        )
        for k in range(count)
    ]
    return scene(b.build(), 5.0, rests=tuple(boxes), compared=False)


TOWERS = EverydayClass(
    name="towers",
    note="one box on the other, up to 20 times heavier in turn",
    make=_make,
    rooms=("m", "l", "custom"),
)
