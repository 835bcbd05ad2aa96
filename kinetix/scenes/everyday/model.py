"""Everyday scenes: a trial, and what must be true of it."""

import dataclasses
import random
from collections.abc import Callable
from typing import Any, Final

from kinetix.level.geometry import ARENA_WIDTH, FLOOR_TOP
from kinetix.level.model import Level
from kinetix.level.sizes import SIZES
from kinetix.scenes.model import Trial

FLOOR: Final = FLOOR_TOP
"""Height of the arena's floor [m]."""
WIDTH: Final = ARENA_WIDTH
"""Of the arena [m]."""


@dataclasses.dataclass(frozen=True, kw_only=True)
class Room:
    """Numbers of bodies and joints that a scene may hold; the arena is not counted."""

    name: str
    """A named size, or `custom`."""
    polygons: int
    circles: int
    joints: int


def _room(name: str) -> Room:
    size = SIZES[name]
    return Room(name=name, polygons=size.polygons - 4, circles=size.circles, joints=size.joints)


CUSTOM: Final = Room(name="custom", polygons=24, circles=12, joints=16)
ROOMS: Final[dict[str, Room]] = {name: _room(name) for name in ("s", "m", "l")} | {"custom": CUSTOM}
"""Scenes are run with the step of their size."""


@dataclasses.dataclass(frozen=True, kw_only=True)
class EverydayScene:
    """A trial and what is expected of it, beyond what holds for every scene."""

    trial: Trial
    room: str = ""
    """Filled in by the table of classes."""
    rests: tuple[int, ...] = ()
    """Bodies that must not move from the time `rests_from` on."""
    rests_from: float = 0.0
    """Time from which the bodies of `rests` must not move [s]."""
    inside: tuple[int, ...] = ()
    """Bodies whose centres must stay in `box`."""
    box: tuple[float, float, float, float] = (0.0, 0.0, WIDTH, WIDTH)
    """Left, bottom, right, top [m]."""
    twin: Level | None = None
    """The same scene in one piece, such as a slab instead of tiles: `watched` must move alike."""
    watched: tuple[int, ...] = ()
    """Ids in the scene; the twin has the same bodies last, in the same order."""
    compared: bool = True
    """True if the end is compared with that of a run with a finer step."""


@dataclasses.dataclass(frozen=True, kw_only=True)
class EverydayClass:
    """A kind of thing that people build."""

    name: str
    note: str
    """For people."""
    make: Callable[[random.Random, Room], EverydayScene]
    """Builds a scene that fits the room."""
    rooms: tuple[str, ...]
    """In which there is enough room for it."""


def scene(level: Level, seconds: float, *, motor: float = 0.0, **more: Any) -> EverydayScene:
    """Return a level as a scene.

    Args:
        level: What is built.
        seconds: For how long it runs.
        motor: Action of every motor, −1 … 1.
        more: Fields of `EverydayScene`.
    """
    return EverydayScene(trial=Trial(level=level, duration=seconds, motor=motor), **more)
