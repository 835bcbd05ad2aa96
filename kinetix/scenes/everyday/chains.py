"""Chains over a post, with a load at each end."""

import math
import random

from kinetix.level.builder import LevelBuilder
from kinetix.scenes.everyday.model import EverydayClass, EverydayScene, Room, scene

WIDTH = 0.05
"""Width of the links [m]."""


def draped(
    b: LevelBuilder, links: int, length: float, radius: float, loads: tuple[float, float]
) -> list[int]:
    """Hang a chain over a fixed disc at the origin, its first and last link loaded.

    Args:
        b: Where to.
        links: How many.
        length: Of a link [m].
        radius: Of the disc [m].
        loads: Density of the first and of the last link beside that of the others.

    Returns:
        The ids of the links.
    """
    b.circle(0.0, 0.0, radius, fixed=True)
    # The corners of the path lie so far out that the middle of a link just touches.
    half = math.atan(length / 2 / (radius + WIDTH / 2))
    turn = 2 * half
    path = (radius + WIDTH / 2) / math.cos(half)
    over = max(1, math.floor(math.pi / turn))
    down = max(1, (links - over + 1) // 2)
    first = math.pi / 2 + over * turn / 2
    corners = [
        (path * math.cos(first - k * turn), path * math.sin(first - k * turn))
        for k in range(over + 1)
    ]
    (lx, ly), (rx, ry) = corners[0], corners[-1]
    corners = [(lx, ly - length * k) for k in range(down, 0, -1)] + corners
    corners += [(rx, ry - length * k) for k in range(1, links + 2 - len(corners))]
    made: list[int] = []
    for k in range(links):
        (ax, ay), (bx, by) = corners[k], corners[k + 1]
        density = loads[0] if k == 0 else loads[1] if k == links - 1 else 1.0
        link = b.rectangle(
            (ax + bx) / 2,
            (ay + by) / 2,
            length,
            WIDTH,
            angle=math.atan2(by - ay, bx - ax),
            density=density,
        )
        if made:
            b.hinge(made[-1], link, (ax, ay))
        made.append(link)
    return made


def _make(rng: random.Random, room: Room) -> EverydayScene:
    links = min(room.polygons, room.joints + 1, rng.randint(6, 17))
    radius = rng.uniform(0.1, 0.3)
    length = rng.uniform(0.6, 1.0) * math.pi * radius / 3
    load = rng.choice((1.0, 5.0, 20.0, 100.0))
    b = LevelBuilder("Chain over a post", arena=False)
    draped(b, links, length, radius, (load, load * rng.choice((1.0, 1.0, 1.5))))
    return scene(b.build(), 2.0)


CHAINS = EverydayClass(
    name="chains",
    note="a loaded chain over a post",
    make=_make,
    rooms=("l", "custom"),
)
