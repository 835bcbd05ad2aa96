"""Fast balls and boxes in closed rings: nothing may leave."""

import math
import random

from kinetix.level.builder import LevelBuilder
from kinetix.scenes.everyday.model import (
    FLOOR,
    WIDTH,
    EverydayClass,
    EverydayScene,
    Room,
    scene,
)

WALL = 0.05
"""Thickness of the ring [m]."""


def _make(rng: random.Random, room: Room) -> EverydayScene:
    gravity = (0.0, rng.choice((0.0, -9.81)))
    restitution = rng.choice((0.0, 0.5, 1.0))
    ring = room.polygons >= 6 and rng.random() < 0.7
    b = LevelBuilder("Ring", gravity=gravity, arena=not ring)
    sides = rng.randint(4, min(room.polygons, 12)) if ring else 0
    radius = rng.uniform(0.5, 1.5)
    for k in range(sides):
        angle = 2 * math.pi * k / sides
        length = 2 * (radius + WALL) * math.tan(math.pi / sides)
        centre = radius + WALL / 2
        b.rectangle(
            centre * math.cos(angle),
            centre * math.sin(angle),
            WALL,
            length,
            angle=angle,
            fixed=True,
            restitution=restitution,
        )
    boxes = rng.randint(0, min(4, room.polygons - sides))
    discs = rng.randint(1, min(8, room.circles))
    middle = (0.0, 0.0) if ring else (2.5, 2.5)
    total = boxes + discs
    inside = []
    for k in range(total):
        speed = math.exp(rng.uniform(math.log(5.0), math.log(90.0)))
        heading = rng.uniform(0, 2 * math.pi)
        place = 2 * math.pi * k / total
        away = 0.0 if total == 1 else 0.3 * (radius if ring else 1.0)
        x, y = middle[0] + away * math.cos(place), middle[1] + away * math.sin(place)
        velocity = (speed * math.cos(heading), speed * math.sin(heading))
        size = rng.uniform(0.02, 0.08) * (radius if ring else 1.0)
        more = {"velocity": velocity, "restitution": restitution}
        if k < discs:
            inside.append(b.circle(x, y, max(size, 0.02), **more))
        else:
            inside.append(b.rectangle(x, y, 2 * size, 2 * size, angle=heading, **more))
    reach = radius / math.cos(math.pi / sides) if ring else 0.0
    box = (-reach, -reach, reach, reach) if ring else (0.0, FLOOR, WIDTH, WIDTH)
    return scene(b.build(), 2.0, inside=tuple(inside), box=box, compared=False)


RINGS = EverydayClass(
    name="rings",
    note="fast balls and boxes in a closed ring",
    make=_make,
    rooms=("s", "m", "l", "custom"),
)
