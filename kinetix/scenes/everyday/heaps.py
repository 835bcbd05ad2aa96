"""Boxes, triangles and discs that fall on a heap."""

import math
import random

from kinetix.level.builder import LevelBuilder
from kinetix.scenes.everyday.model import FLOOR, EverydayClass, EverydayScene, Room, scene


def _make(rng: random.Random, room: Room) -> EverydayScene:
    b = LevelBuilder("Heap")
    boxes, discs = min(room.polygons, 12), min(room.circles, 6)
    total = boxes + discs
    kinds = ["box"] * boxes + ["disc"] * discs
    rng.shuffle(kinds)
    columns = max(1, min(5, math.ceil(math.sqrt(total))))
    pitch = 4.4 / max(columns, 3)
    for k, kind in enumerate(kinds):
        size = rng.uniform(0.15, 0.6) * pitch
        x = 0.4 + pitch * (k % columns + 0.5) + rng.uniform(-0.1, 0.1) * pitch
        y = FLOOR + pitch * (k // columns * 0.75 + 0.5)
        if kind == "disc":
            b.circle(x, y, size / 2)
        elif rng.random() < 0.25:
            b.polygon(((x - size / 2, y), (x + size / 2, y), (x, y + size * 0.6)))
        else:
            b.rectangle(x, y, size, size * rng.uniform(0.4, 1.0), angle=rng.uniform(-0.6, 0.6))
    return scene(b.build(), 3.0)


HEAPS = EverydayClass(
    name="heaps",
    note="things that fall on each other",
    make=_make,
    rooms=("s", "m", "l", "custom"),
)
