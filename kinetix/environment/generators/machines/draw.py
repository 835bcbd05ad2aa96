"""Levels with random machines, drawn one by one."""

import inspect
import random
from collections.abc import Iterator, Sequence
from typing import Final

import msgspec

from kinetix.environment.generators.machines.families import FAMILIES, Family
from kinetix.environment.generators.machines.surroundings import furnish, stand
from kinetix.environment.generators.machines.workshop import Workshop
from kinetix.errors import KinetixError
from kinetix.level.builder import LevelBuilder
from kinetix.level.mirror import mirrored_level
from kinetix.level.model import Level
from kinetix.level.sizes import SIZES, needed_capacity
from kinetix.level.validate import has_errors, validate

FAMILIES_TRIED: Final = 100
"""The search gives up after this many families that did not fit."""
ATTEMPTS: Final = 10
"""Draws after which another family is tried."""
OVERLAP: Final = "W202"
"""Code of the warning about shapes that overlap and would be pushed apart."""


def random_machine(dice: random.Random, size: str, families: Sequence[Family] = ()) -> Level:
    """Return a level with a random machine.

    Args:
        dice: All that is random.
        size: `s`, `m` or `l`.
        families: Those to draw from; by default all, with the weights of `FAMILIES`.

    Raises:
        KinetixError: The size is none of these, or none of the families fits it.
    """
    if size not in ("s", "m", "l"):
        raise KinetixError(f"machines of size {size!r}: expected s, m or l")
    table = {family: FAMILIES[family] for family in families} if families else FAMILIES
    for _ in range(FAMILIES_TRIED):
        family = dice.choices(tuple(table), weights=tuple(table.values()))[0]
        for _ in range(ATTEMPTS):
            level = _drawn(dice, size, family)
            if level is not None:
                return level
    raise KinetixError(f"machines of size {size!r}: none of these families fits")


def _drawn(dice: random.Random, size: str, family: Family) -> Level | None:
    """Return a level, or nothing if it is too large or shapes are in each other's way."""
    shop = Workshop(dice, LevelBuilder(family.__name__))
    family(shop)
    stand(shop)
    if size == "l" and not shop.ledge and shop.chance(0.25):
        _neighbour(shop, dice.choice(tuple(FAMILIES)))
    if not SIZES[size].covers(needed_capacity(shop.build.build())):
        return None
    furnish(shop, SIZES[size])
    shop.deadly(0.2, "floor")
    shop.deadly(0.06, "ceiling", "left_wall", "right_wall")
    level = _in_its_arena(shop)
    if shop.chance(0.5):
        level = mirrored_level(level)
    level = level.replace(size=size, description=inspect.getdoc(family) or "")
    issues = validate(level)
    if has_errors(issues) or any(issue.code == OVERLAP for issue in issues):
        return None
    return level


def _neighbour(shop: Workshop, family: Family) -> None:
    """Another machine, whose parts nobody has to touch."""
    tip, goal, arena = shop.tip, shop.goal, dict(shop.arena)
    shop.tip = shop.goal = "none"
    family(shop)
    shop.tip, shop.goal, shop.arena = tip, goal, arena


def _in_its_arena(shop: Workshop) -> Level:
    """Return the level with what is deadly of the arena; one of ten has another gravity."""
    level = shop.build.build()
    parts = {
        name: msgspec.structs.replace(getattr(level.arena, name), role=role)
        for name, role in shop.arena.items()
    }
    share = 1.0
    if shop.chance(0.1):
        share = shop.dice.choice((0.0, shop.between(0.1, 0.9), shop.between(0.9, 1.3)))
    return level.replace(
        arena=msgspec.structs.replace(level.arena, **parts),
        gravity=(0.0, share * level.gravity[1]),
    )


def random_machines(seed: int, size: str, count: int) -> Iterator[Level]:
    """Levels with random machines: level k depends on the seed and on k alone.

    Args:
        seed: Any integer.
        size: `s`, `m` or `l`.
        count: How many.

    Raises:
        KinetixError: No machines have this size.
    """
    for index in range(count):
        yield numbered_machine(seed, size, index)


def numbered_machine(seed: int, size: str, index: int) -> Level:
    """Return level `index` of `random_machines`.

    Args:
        seed: Any integer.
        size: `s`, `m` or `l`.
        index: From 0.

    Raises:
        KinetixError: No machines have this size.
    """
    level = random_machine(random.Random(f"{seed} {index}"), size)
    return level.replace(name=f"Machine {size} {seed}-{index}")
