"""Edits of sizes by numbers: width and height of polygons, their corners, a joint's place."""

import dataclasses
import itertools
import math
from collections.abc import Hashable
from typing import Final, Literal

from editor.base.arithmetic import Change
from editor.documents.commands.base import Selection, count_label
from editor.documents.commands.group import SetVertices, Stretch
from editor.documents.commands.rigid import freed, reshaped
from kinetix.errors import CommandError
from kinetix.level.geometry import to_world, world_vertices
from kinetix.level.model import Body, Circle, Level, Point, Polygon

Axis = Literal[0, 1]
SIDE_MIN: Final = 0.02
SIDE_MAX: Final = 10.0
"""Limits of widths and heights [m]."""
_SAME_PLACE: Final = 1e-4
"""Distance of two corners that counts as none [m]."""


def extent(shape: Polygon, axis: Axis) -> float:
    """Return the width (axis 0) or height (axis 1) of a polygon in its own frame [m]."""
    values = [vertex[axis] for vertex in shape.vertices]
    return max(values) - min(values)


@dataclasses.dataclass(frozen=True, kw_only=True)
class SetExtent:
    """Changes width or height of polygons, each from its own; the middle stays."""

    ids: Selection
    axis: Axis
    change: Change
    """In metres."""

    @property
    def label(self) -> str:
        """Label with the number of items."""
        verb = "Change width of" if self.axis == 0 else "Change height of"
        return count_label(verb, len(self.ids), "shape")

    @property
    def merge_key(self) -> Hashable:
        """The same side of the same shapes."""
        return None if self.change.relative else ("extent", self.ids, self.axis)

    def apply(self, level: Level) -> Level:
        """Stretch the polygons.

        Raises:
            CommandError: No polygon is selected.
        """
        found = [b for b in level.bodies if b.id in self.ids and isinstance(b.shape, Polygon)]
        if not found:
            raise CommandError("Select a polygon first.")
        for body in found:
            level = self._stretched(level, body)
        return level

    def _stretched(self, level: Level, body: Body) -> Level:
        assert isinstance(body.shape, Polygon)
        before = extent(body.shape, self.axis)
        wanted = min(max(self.change.of(before), SIDE_MIN), SIDE_MAX)
        factor = wanted / before
        factors = (factor, 1.0) if self.axis == 0 else (1.0, factor)
        middle = tuple(
            (min(v[k] for v in body.shape.vertices) + max(v[k] for v in body.shape.vertices)) / 2
            for k in (0, 1)
        )
        return Stretch(body=body.id, factors=factors, hold=(middle[0], middle[1])).apply(level)


@dataclasses.dataclass(frozen=True, kw_only=True)
class ResetExtent:
    """Gives polygons back a width or height, each its own."""

    axis: Axis
    rows: tuple[tuple[int, float], ...]
    """Body and its width or height [m]."""
    merge_key: Hashable | None = None

    @property
    def label(self) -> str:
        """Names the side."""
        return f"Reset {'height' if self.axis else 'width'}"

    def apply(self, level: Level) -> Level:
        """Resize the bodies.

        Raises:
            CommandError: No shape can have the size.
        """
        for body, value in self.rows:
            change = Change(amount=value)
            level = SetExtent(ids=(body,), axis=self.axis, change=change).apply(level)
        return level


@dataclasses.dataclass(frozen=True, kw_only=True)
class SetCorner:
    """Puts one coordinate of a polygon's corner elsewhere in the world."""

    body: int
    corner: int
    axis: Axis
    value: float
    """New coordinate [m]."""

    @property
    def label(self) -> str:
        """Label with the number of the corner."""
        return f"Move corner {self.corner + 1}"

    @property
    def merge_key(self) -> Hashable:
        """The same coordinate."""
        return "corner", self.body, self.corner, self.axis

    def apply(self, level: Level) -> Level:
        """Reshape the polygon.

        Raises:
            CommandError: The body would no longer be a convex polygon.
        """
        body = level.body(self.body)
        assert not isinstance(body.shape, Circle)
        corners: list[Point] = list(world_vertices(body))
        x, y = corners[self.corner]
        corners[self.corner] = (self.value, y) if self.axis == 0 else (x, self.value)
        return SetVertices(body=self.body, vertices=tuple(corners)).apply(level)


@dataclasses.dataclass(frozen=True, kw_only=True)
class ResetCorners:
    """Gives a polygon back its corners, where it is now.

    Joints and thrusters stay where they are in the world.
    """

    body: int
    shape: Polygon
    merge_key: Hashable | None = None

    @property
    def label(self) -> str:
        """Label of the edit in menus and history."""
        return "Reset corners"

    def apply(self, level: Level) -> Level:
        """Put the corners back; those that are the same stay where they are."""
        body = level.body(self.body)
        assert not isinstance(body.shape, Circle)
        origin = to_world(body, _offset(self.shape, body.shape))
        back = body.replace(shape=self.shape, position=origin, mass_properties=None)
        return freed(reshaped(level, back), self.body)


def _offset(shape: Polygon, other: Polygon) -> Point:
    """Return the shift of a shape that brings most of its corners onto those of the other [m].

    (0, 0) where at most one corner would meet: that is always possible.
    """
    pairs = itertools.product(shape.vertices, other.vertices)
    shifts = [(q[0] - p[0], q[1] - p[1]) for p, q in pairs]

    def meeting(shift: Point) -> tuple[int, float]:
        corners = sum(math.dist(shift, each) < _SAME_PLACE for each in shifts)
        return max(corners, 1), -math.hypot(*shift)

    return max((0.0, 0.0), *shifts, key=meeting)
