"""See-saws: a plank on a pivot, with things on both ends."""

import random

from kinetix.level.builder import LevelBuilder
from kinetix.scenes.everyday.model import FLOOR, EverydayClass, EverydayScene, Room, scene


def _make(rng: random.Random, room: Room) -> EverydayScene:
    b = LevelBuilder("See-saw")
    length, width = rng.uniform(1.5, 3.0), 0.1
    pivot = (2.5, FLOOR + 0.6)
    limit = rng.uniform(0.1, 0.3)
    plank = b.rectangle(*pivot, length, width)
    b.hinge(b.floor, plank, pivot, limits=(-limit, limit))
    top = pivot[1] + width / 2
    size = rng.uniform(0.15, 0.35)
    arm = length / 2 - size
    for side in (-1, 1):
        if room.polygons <= 2:
            b.circle(pivot[0] + side * arm, top + size / 2, size / 2, density=1.5 + 0.5 * side)
            continue
        part = size * rng.uniform(0.6, 1.0)
        place = (pivot[0] + side * arm, top + part / 2)
        b.rectangle(*place, part, part, density=2.0)
    return scene(b.build(), 1.0)


SEE_SAWS = EverydayClass(
    name="see-saws",
    note="a plank on a pivot, loaded at both ends",
    make=_make,
    rooms=("s", "m", "l", "custom"),
)
