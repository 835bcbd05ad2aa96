"""Buckets and funnels: fixed boards that hold what is poured into them."""

import math
import random

from kinetix.level.builder import LevelBuilder
from kinetix.scenes.everyday.model import FLOOR, EverydayClass, EverydayScene, Room, scene

BOARD = 0.08
"""Thickness of the boards [m]."""


def _make(rng: random.Random, room: Room) -> EverydayScene:
    discs = rng.randint(1, min(room.circles, 10))
    boxes = rng.randint(0, max(0, min(room.polygons - 3, 8)))
    b = LevelBuilder("Bucket")
    width = rng.uniform(0.5, 1.2)
    x, floor = 2.5, FLOOR
    kind = rng.choice(("bucket", "funnel", "floor"))
    lean = 0.0
    if kind != "floor" and room.polygons >= 3:
        lean = rng.uniform(0.3, 0.8) if kind == "funnel" else rng.uniform(0.0, 0.25)
        b.rectangle(x, FLOOR + 0.5, width, BOARD, fixed=True)
        floor = FLOOR + 0.5 + BOARD / 2
        for side in (-1, 1):
            # The lower inner corner of the wall stands on the edge of the bottom.
            c, s = math.cos(lean), math.sin(lean)
            foot = x + side * width / 2
            centre = (foot + side * (c * BOARD / 2 + s * 0.6), floor + c * 0.6 - s * BOARD / 2)
            b.rectangle(*centre, BOARD, 1.2, angle=-side * lean, fixed=True)
    size = min(0.3, width / 3)
    contents = ["disc"] * discs + ["box"] * boxes
    rng.shuffle(contents)
    held = []
    for k, content in enumerate(contents):
        part = size * rng.uniform(0.6, 1.0)
        place = (
            x + (k % 2 - 0.5) * size * rng.uniform(1.0, 1.2),
            floor + (0.7 + k // 2) * size * 1.2,
        )
        if content == "disc":
            held.append(b.circle(*place, part / 2))
        else:
            held.append(b.rectangle(*place, part, part * rng.uniform(0.6, 1.0)))
    # Nothing leaves a bucket through its bottom or its walls.
    inside = tuple(held) if kind == "bucket" and room.polygons >= 3 else ()
    reach = width / 2 + BOARD + 1.2 * math.sin(lean) + 0.05
    box = (x - reach, floor, x + reach, 5.0)
    return scene(b.build(), 4.0, inside=inside, box=box)


BUCKETS = EverydayClass(
    name="buckets",
    note="buckets and funnels with what is poured into them",
    make=_make,
    rooms=("s", "m", "l", "custom"),
)
