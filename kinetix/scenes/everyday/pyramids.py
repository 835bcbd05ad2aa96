"""Pyramids of boxes that rest exactly on each other, flush or with gaps."""

import random

from kinetix.level.builder import LevelBuilder
from kinetix.scenes.everyday.model import FLOOR, WIDTH, EverydayClass, EverydayScene, Room, scene


def _make(rng: random.Random, room: Room) -> EverydayScene:
    most = max(n for n in range(1, 7) if n * (n + 1) // 2 <= room.polygons)
    base = rng.randint(2, most)
    size = rng.uniform(0.2, min(0.6, 4.0 / base))
    pitch = size * rng.choice((1.0, 1.0, 1.05, 1.2))
    b = LevelBuilder("Pyramid")
    middle = rng.uniform(base * pitch / 2, WIDTH - base * pitch / 2)
    boxes = [
        b.rectangle(
            middle + pitch * (column - (base - 1 - row) / 2), FLOOR + (row + 0.5) * size, size, size
        )
        for row in range(base)
        for column in range(base - row)
    ]
    return scene(b.build(), 5.0, rests=tuple(boxes), compared=False)


PYRAMIDS = EverydayClass(
    name="pyramids",
    note="each box on two of the row below",
    make=_make,
    rooms=("l", "custom"),
)
