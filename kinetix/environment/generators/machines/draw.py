"""Levels with random machines, drawn one by one."""

import inspect
import random
from collections.abc import Iterator, Sequence
from typing import Final

from kinetix.environment.generators.machines.families import FAMILIES, Family
from kinetix.environment.generators.machines.surroundings import furnish
from kinetix.environment.generators.machines.workshop import Workshop
from kinetix.errors import KinetixError
from kinetix.level.builder import LevelBuilder
from kinetix.level.mirror import mirrored_level
from kinetix.level.model import Level
from kinetix.level.sizes import SIZES, needed_capacity
from kinetix.level.validate import has_errors, validate

ATTEMPTS: Final = 200
"""Draws after which no level of a family is expected to fit any more."""
OVERLAP: Final = "W202"
"""Code of the warning about shapes that overlap and would be pushed apart."""


def random_machine(dice: random.Random, size: str, families: Sequence[Family] = ()) -> Level:
    """A level with a random machine.

    Args:
        dice: All that is random.
        size: `s`, `m` or `l`.
        families: Those to draw from; by default all, as often as `FAMILIES` says.

    Raises:
        KinetixError: The size is none of these, or none of the families fits it.
    """
    if size not in ("s", "m", "l"):
        raise KinetixError(f"machines of size {size!r}: expected s, m or l")
    table = {family: FAMILIES[family] for family in families} if families else FAMILIES
    for _ in range(ATTEMPTS):
        family = dice.choices(tuple(table), weights=tuple(table.values()))[0]
        shop = Workshop(dice, LevelBuilder(family.__name__))
        family(shop)
        if not SIZES[size].covers(needed_capacity(shop.build.build())):
            continue
        furnish(shop, SIZES[size])
        level = shop.build.build()
        if shop.chance(0.5):
            level = mirrored_level(level)
        level = level.replace(size=size, description=inspect.getdoc(family) or "")
        issues = validate(level)
        if not has_errors(issues) and all(issue.code != OVERLAP for issue in issues):
            return level
    raise KinetixError(f"machines of size {size!r}: none of these families fits")


def random_machines(seed: int, size: str, count: int) -> Iterator[Level]:
    """Levels with random machines: level k depends on the seed and on k alone.

    Args:
        seed: Any integer.
        size: `s`, `m` or `l`.
        count: How many.

    Raises:
        KinetixError: There are no machines of this size.
    """
    for index in range(count):
        level = random_machine(random.Random(f"{seed} {index}"), size)
        yield level.replace(name=f"Machine {size} {seed}-{index}")
