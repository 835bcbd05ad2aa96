"""Angles that were meant in degrees."""

import math
from collections.abc import Iterator
from typing import Final

from kinetix.level.integrity import entity_paths
from kinetix.level.model import Body, Entity, Joint, Level, Thruster
from kinetix.level.validate.issue import Issue, capital, describe, issue

_MOST: Final = 2 * math.tau
"""Nobody turns a shape further by hand [rad]."""


def angle_issues(level: Level) -> Iterator[Issue]:
    """Yield whole numbers beyond two turns where an angle in radians is expected (W212)."""
    for path, entity in entity_paths(level):
        for field, angle in _angles(entity):
            if not -_MOST < angle < _MOST and float(angle).is_integer():
                message = (
                    f"{capital(describe(entity.id, entity))}: {field} {angle:g} rad is "
                    f"{angle / math.tau:.3g} turns; {angle:g}° are {math.radians(angle):.4g} rad."
                )
                yield issue("W212", message, path=f"{path}.{field}", ids=(entity.id,))


def _angles(entity: Entity) -> Iterator[tuple[str, float]]:
    if isinstance(entity, (Body, Thruster)):
        yield "angle", entity.angle
    if isinstance(entity, Joint):
        yield "reference_angle", entity.reference_angle
        if entity.limits is not None:
            yield "limits.min", entity.limits.min
            yield "limits.max", entity.limits.max
