"""Walls of bricks: in columns or in bond, at the arena's wall or standing free."""

import random

from kinetix.level.builder import LevelBuilder
from kinetix.scenes.everyday.model import FLOOR, WIDTH, EverydayClass, EverydayScene, Room, scene


def _make(rng: random.Random, room: Room) -> EverydayScene:
    height = rng.uniform(0.2, 0.6)
    length = height * rng.choice((1.0, 1.0, 1.5, 2.0))
    columns = rng.randint(1, max(1, min(6, room.polygons, int(4 / length))))
    rows = rng.randint(1, max(1, min(6, room.polygons // columns, int(4 / height))))
    bond = columns > 1 and rng.random() < 0.4
    b = LevelBuilder("Wall")
    left = 0.0 if rng.random() < 0.4 else rng.uniform(0.3, WIDTH - columns * length)
    bricks = []
    for row in range(rows):
        # In bond each second row is one brick shorter, so that every brick has two below it.
        shift = row % 2 if bond else 0
        for column in range(columns - shift):
            x = left + (column + 0.5 + shift / 2) * length
            bricks.append(b.rectangle(x, FLOOR + (row + 0.5) * height, length, height))
    return scene(b.build(), 5.0, rests=tuple(bricks), compared=False)


WALLS = EverydayClass(
    name="walls",
    note="bricks in columns or in bond",
    make=_make,
    rooms=("s", "m", "l", "custom"),
)
