"""Bodies that have a place, and problems of those places."""

import dataclasses
from collections.abc import Iterator
from typing import Final

from kinetix.level.geometry import ARENA_WIDTH, arena_bodies, bounds, extent, outside_arena
from kinetix.level.model import ARENA_NAMES, Body, BodyReference, Level
from kinetix.level.validate.issue import Issue, capital, describe, issue
from kinetix.wording import plural

MAX_SHAPE_SIZE: Final = 2.0
"""Largest extent of a shape in random levels [m]."""
_ROUNDING: Final = 1e-3


@dataclasses.dataclass(frozen=True, kw_only=True)
class Placed:
    """A body with what all checks of pairs need."""

    reference: BodyReference
    body: Body
    box: tuple[float, float, float, float]
    path: str


def placed_bodies(level: Level, broken: set[BodyReference]) -> list[Placed]:
    """Return the bodies that have a place, the arena's first."""
    listed: list[tuple[BodyReference, Body, str]] = [
        (name, body, f"$.arena.{name}")
        for name, body in zip(ARENA_NAMES, arena_bodies(level.arena), strict=True)
    ]
    listed += [(body.id, body, f"$.bodies[{k}]") for k, body in enumerate(level.bodies)]
    return [
        Placed(reference=reference, body=body, box=bounds(body), path=path)
        for reference, body, path in listed
        if reference not in broken
    ]


def place_issues(level: Level, placed: list[Placed]) -> Iterator[Issue]:
    """Yield bodies outside of the arena, or larger than generators make them (W203, W206).

    If nothing has to stay inside, because the arena has no walls, one issue lists them all.
    """
    walled = any(getattr(level.arena, name).collision != "ghost" for name in ARENA_NAMES)
    away = [e for e in placed if not isinstance(e.reference, str) and outside_arena(e.box)]
    if walled:
        for each in away:
            message = f"{capital(describe(each.reference, each.body))} lies outside the arena."
            yield issue("W203", message, path=f"{each.path}.position", ids=(each.reference,))
    elif away:
        message = (
            f"{plural(len(away), 'shape')} outside the square of {ARENA_WIDTH:g} m that pictures, "
            "films and agents see."
        )
        yield issue("W203", message, path="$.bodies", ids=tuple(e.reference for e in away))
    for each in placed:
        if isinstance(each.reference, str):
            continue
        size = extent(each.body.shape)
        if size > MAX_SHAPE_SIZE + _ROUNDING:
            name = capital(describe(each.reference, each.body))
            message = (
                f"{name} is larger than {MAX_SHAPE_SIZE:g} m: training generators will "
                f"not produce it."
            )
            yield issue("W206", message, path=f"{each.path}.shape", ids=(each.reference,))
