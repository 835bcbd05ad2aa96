"""All classes, and the scenes that a seed draws from them."""

import dataclasses
import random
from collections.abc import Sequence
from typing import Final

from kinetix.scenes.everyday.bridges import BRIDGES
from kinetix.scenes.everyday.buckets import BUCKETS
from kinetix.scenes.everyday.cars import CARS
from kinetix.scenes.everyday.catapults import CATAPULTS
from kinetix.scenes.everyday.chains import CHAINS
from kinetix.scenes.everyday.dominoes import DOMINOES
from kinetix.scenes.everyday.doors import DOORS
from kinetix.scenes.everyday.frames import FRAMES
from kinetix.scenes.everyday.heaps import HEAPS
from kinetix.scenes.everyday.model import ROOMS, EverydayClass, EverydayScene
from kinetix.scenes.everyday.pyramids import PYRAMIDS
from kinetix.scenes.everyday.rings import RINGS
from kinetix.scenes.everyday.see_saws import SEE_SAWS
from kinetix.scenes.everyday.tiles import TILES
from kinetix.scenes.everyday.towers import TOWERS
from kinetix.scenes.everyday.valleys import VALLEYS
from kinetix.scenes.everyday.walls import WALLS

CLASSES: Final[dict[str, EverydayClass]] = {
    each.name: each
    for each in (
        WALLS,
        PYRAMIDS,
        TOWERS,
        FRAMES,
        HEAPS,
        TILES,
        VALLEYS,
        BUCKETS,
        CARS,
        CATAPULTS,
        CHAINS,
        BRIDGES,
        SEE_SAWS,
        DOORS,
        DOMINOES,
        RINGS,
    )
}
"""By name, in the order of reports."""


def draw(name: str, number: int, seed: int) -> EverydayScene:
    """Return one scene of a class; the same words give the same scene.

    Args:
        name: Of the class.
        number: Which of its scenes; they take the class's rooms in turn.
        seed: Of all scenes.
    """
    kind = CLASSES[name]
    room = ROOMS[kind.rooms[number % len(kind.rooms)]]
    made = kind.make(random.Random(f"{seed} {name} {number}"), room)
    return dataclasses.replace(made, room=room.name)


def draw_all(
    count: int, seed: int, names: Sequence[str] = tuple(CLASSES)
) -> dict[str, list[EverydayScene]]:
    """Return so many scenes by class, as evenly as can be."""
    numbers = {name: count // len(names) + (k < count % len(names)) for k, name in enumerate(names)}
    return {name: [draw(name, k, seed) for k in range(many)] for name, many in numbers.items()}
