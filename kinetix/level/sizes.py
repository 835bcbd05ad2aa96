"""Sizes: the named capacities, and which one a level compiles to. Free of JAX."""

import dataclasses
from typing import Final, get_args

from kinetix.engine.spec import ARENA_BODIES, Capacity
from kinetix.errors import LevelError
from kinetix.level.model import MAX_ENTITIES, Level, Polygon, SizeHint, SizeName

SIZES: Final[dict[str, Capacity]] = {
    "s": Capacity(polygons=5, circles=2, joints=1, thrusters=1),
    "m": Capacity(polygons=6, circles=3, joints=2, thrusters=2),
    "l": Capacity(polygons=12, circles=4, joints=6, thrusters=2),
    "locomotion": Capacity(polygons=10, circles=2, joints=6, thrusters=1),
}
"""The named sizes; polygons count the four arena bodies."""

AUTOMATIC: Final[tuple[SizeName, ...]] = ("s", "m", "l")
"""The sizes that a level without a hint may get, smallest first."""


def needed_capacity(level: Level) -> Capacity:
    """Return exactly what the level's entities fill, the arena included."""
    polygons = sum(isinstance(body.shape, Polygon) for body in level.bodies)
    return Capacity(
        polygons=ARENA_BODIES + polygons,
        circles=len(level.bodies) - polygons,
        joints=len(level.joints),
        thrusters=len(level.thrusters),
    )


def smallest_capacity(needed: Capacity) -> Capacity:
    """Return the smallest of s, m and l that covers `needed`, otherwise `needed` itself."""
    return next((SIZES[name] for name in AUTOMATIC if SIZES[name].covers(needed)), needed)


def hinted_capacity(level: Level) -> Capacity | None:
    """Return the capacity of the level's own `size`; None where it has none that exists."""
    if level.size is None:
        return None
    if isinstance(level.size, SizeHint):
        hint = level.size
        return Capacity(
            polygons=hint.polygons,
            circles=hint.circles,
            joints=hint.joints,
            thrusters=hint.thrusters,
        )
    return SIZES.get(level.size)


def outgrown_capacity(level: Level) -> Capacity | None:
    """Return the capacity of the level's own `size` where the level does not fit it, else None."""
    hint = hinted_capacity(level)
    return None if hint is None or hint.covers(needed_capacity(level)) else hint


def without_outgrown_size(level: Level) -> Level:
    """Return the level, its size chosen automatically where it does not fit the one it names."""
    return level if outgrown_capacity(level) is None else level.replace(size=None)


def capacity_of(level: Level) -> Capacity:
    """Return the capacity to compile the level to: its hint, else the smallest size that fits."""
    return hinted_capacity(level) or smallest_capacity(needed_capacity(level))


def size_name(capacity: Capacity) -> SizeName | None:
    """Return the name of a capacity, when it is a named one."""
    return next((name for name in get_args(SizeName) if SIZES[name] == capacity), None)


def describe_capacity(capacity: Capacity) -> str:
    """Return a capacity as commands write it: its name, or four numbers such as `12,4,6,2`."""
    numbers = (capacity.polygons, capacity.circles, capacity.joints, capacity.thrusters)
    return size_name(capacity) or ",".join(map(str, numbers))


def shortages(needed: Capacity, capacity: Capacity) -> list[str]:
    """Return a sentence for each kind of which there are more than have room.

    Args:
        needed: What a level needs.
        capacity: What there is room for.
    """
    size = describe_capacity(capacity)
    counts = {
        field.name: (getattr(needed, field.name), getattr(capacity, field.name))
        for field in dataclasses.fields(Capacity)
    }
    return [
        f"Uses {used} of {most} {kind}: does not fit size {size}."
        for kind, (used, most) in counts.items()
        if used > most
    ]


def parse_capacity(text: str) -> Capacity:
    """Return a capacity from a size's name or four numbers such as `12,4,6,2`.

    Raises:
        LevelError: The text is neither.
    """
    if isinstance(text, str) and text in SIZES:
        return SIZES[text]
    parts = str(text).split(",")
    limits = (ARENA_BODIES, 0, 0, 0)
    if len(parts) == len(limits) and all(part.strip().isdecimal() for part in parts):
        numbers = [int(part) for part in parts]
        if all(low <= n <= MAX_ENTITIES for low, n in zip(limits, numbers, strict=True)):
            polygons, circles, joints, thrusters = numbers
            return Capacity(polygons=polygons, circles=circles, joints=joints, thrusters=thrusters)
    raise LevelError(
        f"size {text!r}: expected {', '.join(SIZES)}, or four numbers such as 12,4,6,2: polygons "
        f"(from {ARENA_BODIES}, those of the arena), circles, joints, thrusters"
    )


def size_hint(capacity: Capacity) -> SizeHint:
    """Return a capacity in the form that a level file can carry."""
    return SizeHint(
        polygons=capacity.polygons,
        circles=capacity.circles,
        joints=capacity.joints,
        thrusters=capacity.thrusters,
    )
