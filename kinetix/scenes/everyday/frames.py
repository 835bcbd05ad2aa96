"""Tables and shelves of welded boards, with a load on top."""

import random

from kinetix.level.builder import LevelBuilder
from kinetix.scenes.everyday.model import FLOOR, EverydayClass, EverydayScene, Room, scene


def _make(rng: random.Random, room: Room) -> EverydayScene:
    storeys = rng.randint(1, max(1, min(4, (room.polygons - 1) // 3, room.joints // 2)))
    width, height, board = rng.uniform(0.6, 1.6), rng.uniform(0.3, 0.7), rng.uniform(0.05, 0.12)
    b = LevelBuilder("Shelf")
    x, floor = rng.uniform(1.0, 4.0), FLOOR
    bodies = []
    for _ in range(storeys):
        top = b.rectangle(x, floor + height + board / 2, width, board)
        for side in (-1, 1):
            leg_x = x + side * (width - board) / 2
            leg = b.rectangle(leg_x, floor + height / 2, board, height)
            b.weld(leg, top, (leg_x, floor + height))
            bodies.append(leg)
        bodies.append(top)
        floor += height + board
    load = rng.uniform(0.15, 0.4)
    density = rng.choice((1.0, 10.0, 50.0))
    bodies.append(b.rectangle(x, floor + load / 2, load, load, density=density))
    return scene(b.build(), 5.0, rests=tuple(bodies), compared=False)


FRAMES = EverydayClass(
    name="frames",
    note="welded tables and shelves under a load",
    make=_make,
    rooms=("l", "custom"),
)
