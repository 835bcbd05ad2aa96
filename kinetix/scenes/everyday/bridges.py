"""Bridges of pinned planks between the walls or posts, with a load."""

import random

from kinetix.level.builder import LevelBuilder
from kinetix.level.model import BodyReference
from kinetix.scenes.everyday.model import EverydayClass, EverydayScene, Room, scene


def _make(rng: random.Random, room: Room) -> EverydayScene:
    planks = min(room.polygons - 1, room.joints - 1, rng.randint(3, 12))
    b = LevelBuilder("Bridge")
    left, right, y = rng.uniform(0.0, 1.0), rng.uniform(4.0, 5.0), rng.uniform(1.5, 3.0)
    length, width = (right - left) / planks, rng.uniform(0.06, 0.15)
    before: BodyReference = b.left_wall
    for k in range(planks):
        plank = b.rectangle(left + (k + 0.5) * length, y, length, width)
        b.hinge(before, plank, (left + k * length, y))
        before = plank
    b.hinge(before, b.right_wall, (right, y))
    size = rng.uniform(0.2, 0.5)
    density = rng.choice((1.0, 5.0, 20.0))
    x = rng.uniform(2.0, 3.0)
    if room.circles and rng.random() < 0.4:
        b.circle(x, y + (width + size) / 2, size / 2, density=density)
    else:
        b.rectangle(x, y + (width + size) / 2, size, size, density=density)
    return scene(b.build(), 2.0)


BRIDGES = EverydayClass(
    name="bridges",
    note="pinned planks under a load",
    make=_make,
    rooms=("l", "custom"),
)
