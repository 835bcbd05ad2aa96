"""Floors and ramps of flush tiles, with something that slides or rolls over them."""

import math
import random

from kinetix.level.builder import LevelBuilder
from kinetix.level.model import Level
from kinetix.scenes.everyday.model import EverydayClass, EverydayScene, Room, scene

THICKNESS = 0.2
"""Thickness of the tiles [m]."""


def _make(rng: random.Random, room: Room) -> EverydayScene:
    kind = rng.choice(("box", "disc", "triangle"))
    count = room.polygons - (kind != "disc")
    count = rng.randint(min(2, count), min(count, 16))
    tile = rng.uniform(0.2, 1.0)
    slope = rng.choice((0.0, 0.0, 0.1, 0.3))
    speed = math.exp(rng.uniform(math.log(1.0), math.log(20.0)))
    friction = rng.choice((0.0, 0.0, 1.0)) if kind == "disc" else 0.0
    size = rng.uniform(0.08, 0.3)

    def build(pieces: int) -> tuple[Level, int]:
        """Tiles along a slope that falls to the right, and what moves over them, last."""
        b = LevelBuilder("Tiles", arena=False)
        length = tile * count
        across = (math.sin(slope), math.cos(slope))

        def place(along: float, above: float) -> tuple[float, float]:
            return (
                along * across[1] + above * across[0],
                -along * across[0] + above * across[1],
            )

        piece = length / pieces
        for k in range(pieces):
            x, y = place((k + 0.5) * piece, -THICKNESS / 2)
            b.rectangle(x, y, piece, THICKNESS, angle=-slope, fixed=True, friction=friction)
        velocity = (speed * across[1], -speed * across[0])
        start = min(tile, 0.5) / 2
        if kind == "disc":
            x, y = place(start, size)
            spin = -speed / size if friction else 0.0
            body = b.circle(x, y, size, velocity=velocity, angular_velocity=spin, friction=friction)
        elif kind == "box":
            x, y = place(start, size / 2)
            body = b.rectangle(x, y, size, size, angle=-slope, velocity=velocity, friction=0.0)
        else:
            corners = [place(start + dx, dy) for dx, dy in ((-size, 0), (size, 0), (0, size))]
            body = b.polygon(corners, velocity=velocity, friction=0.0)
        return b.build(), body

    level, body = build(count)
    slab, _ = build(1)
    # It stays on the floor: the last tenth of it is left.
    way = 0.85 * tile * count - min(tile, 0.5)
    pull = 9.81 * math.sin(slope)
    seconds = (
        (math.sqrt(speed**2 + 2 * pull * max(way, 0.05)) - speed) / pull
        if pull
        else max(way, 0.05) / speed
    )
    return scene(level, min(seconds, 3.0), twin=slab, watched=(body,), compared=False)


TILES = EverydayClass(
    name="tiles",
    note="sliding and rolling over flush tiles, against one slab",
    make=_make,
    rooms=("m", "l", "custom"),
)
