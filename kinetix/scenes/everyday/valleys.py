"""Valleys and hills of straight segments, with a ball."""

import itertools
import math
import random

from kinetix.level.builder import LevelBuilder
from kinetix.scenes.everyday.model import EverydayClass, EverydayScene, Room, scene

THICKNESS = 0.2
"""Thickness of the segments [m]."""


def _make(rng: random.Random, room: Room) -> EverydayScene:
    count = rng.randint(min(4, room.polygons), min(room.polygons, 16))
    radius = rng.uniform(1.0, 3.0)
    half = rng.uniform(0.3, 0.8)
    hill = rng.random() < 0.3
    ball = rng.uniform(0.05, 0.2)
    friction = rng.choice((0.0, 1.0))
    b = LevelBuilder("Hill" if hill else "Valley", arena=False)
    sign = 1 if hill else -1

    def on_curve(angle: float, distance: float) -> tuple[float, float]:
        return distance * math.sin(angle), sign * distance * math.cos(angle)

    angles = [half * (2 * k / count - 1) for k in range(count + 1)]
    for start, end in itertools.pairwise(angles):
        inner, outer = radius - sign * THICKNESS, radius
        # Of a valley the segments lie outside the circle, of a hill inside.
        corners = [
            on_curve(start, inner),
            on_curve(end, inner),
            on_curve(end, outer),
            on_curve(start, outer),
        ]
        b.polygon(corners, fixed=True, friction=friction)
    # The centre of a ball on the flat of a segment is nearer than the corners are.
    flat = radius * math.cos(half / count)
    first = angles[0] + half / count
    x, y = on_curve(first, flat + sign * ball)
    speed = rng.uniform(2.0, 5.0) if hill else 0.0
    c, s = math.cos(first), math.sin(first)
    velocity = (speed * c, -sign * speed * s)
    spin = -speed / ball if friction else 0.0
    b.circle(x, y, ball, velocity=velocity, angular_velocity=spin, friction=friction)
    seconds = 0.8 * radius * half / speed if hill else 2.0
    return scene(b.build(), max(seconds, 0.3))


VALLEYS = EverydayClass(
    name="valleys",
    note="a ball in a valley or over a hill of straight segments",
    make=_make,
    rooms=("l", "custom"),
)
