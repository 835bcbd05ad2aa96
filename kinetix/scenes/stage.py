"""Puts a scene together: a level builder with one coefficient of friction for every pair."""

import math
from collections.abc import Sequence
from typing import Any, Final

from kinetix.level.builder import LevelBuilder
from kinetix.level.model import JointKind, Level, Limits, Motor, Point, Shape
from kinetix.scenes.model import GRAVITY

DEFAULT_FRICTION: Final = 0.566
"""Coefficient of friction of a pair, unless a scene says otherwise."""
FLOOR: Final = (40.0, 1.0)
"""Length and height of the floor [m]; its top is at y = 0."""


def surface_friction(coefficient: float) -> float:
    """Return the friction value that two equal surfaces need for a coefficient.

    Source: the mixing rule 0.4·√(f_a² + f_b²).
    """
    return coefficient / (0.4 * math.sqrt(2))


class Stage:
    """A level in the making. No walls; nothing but what is added."""

    def __init__(
        self,
        name: str,
        *,
        friction: float = DEFAULT_FRICTION,
        restitution: float = 0.0,
        gravity: float = GRAVITY,
        slope: float = 0.0,
        floor: bool = False,
        offset: float = 0.0,
    ) -> None:
        """Start with an empty space.

        Args:
            name: Title of the level.
            friction: Coefficient of every pair.
            restitution: Of every pair.
            gravity: [m/s²].
            slope: By how much gravity is turned, so that downhill is +x [rad].
            floor: Whether there is a floor with its top at y = 0.
            offset: Added to every x [m].
        """
        pull = (gravity * math.sin(slope), -gravity * math.cos(slope))
        self._builder = LevelBuilder(name, gravity=pull, arena=False)
        self._surface: dict[str, Any] = {
            "friction": surface_friction(friction),
            "restitution": restitution,
        }
        self._offset = offset
        if floor:
            self.box(*FLOOR, 0.0, -FLOOR[1] / 2, fixed=True)

    def box(
        self, length: float, height: float, x: float, y: float, angle: float = 0.0, **more: Any
    ) -> int:
        """Add a rectangle by its centre; `more` are fields of `Body`. Returns its id."""
        fields: dict[str, Any] = self._surface | {"angle": angle} | more
        return self._builder.rectangle(x + self._offset, y, length, height, **fields)

    def disc(self, radius: float, x: float, y: float, **more: Any) -> int:
        """Add a disc by its centre; `more` are fields of `Body`. Returns its id."""
        return self._builder.circle(x + self._offset, y, radius, **(self._surface | more))

    def polygon(self, corners: Sequence[Point], **more: Any) -> int:
        """Add a free polygon by its corners in the world, counter-clockwise. Returns its id."""
        moved = [(x + self._offset, y) for x, y in corners]
        return self._builder.polygon(moved, **(self._surface | more))

    def body(self, shape: Shape, x: float, y: float, angle: float = 0.0, **more: Any) -> int:
        """Add a body; `more` are fields of `Body`. Returns its id."""
        fields: dict[str, Any] = self._surface | {"angle": angle} | more
        return self._builder.body(shape, x + self._offset, y, **fields)

    def post(self, x: float, y: float) -> int:
        """Add a small fixed box that touches nothing, to hang things on. Returns its id."""
        return self.box(0.1, 0.1, x, y, fixed=True, collision="ghost")

    def join(
        self,
        kind: JointKind,
        a: int,
        b: int,
        at: Point,
        *,
        motor: Motor | None = None,
        limits: Limits | None = None,
    ) -> int:
        """Join two bodies at a point of the world, at their present angles. Returns the id.

        A hinge's zero is where both bodies have one angle.
        """
        place = (at[0] + self._offset, at[1])
        if kind == "fixed":
            return self._builder.weld(a, b, place)
        return self._builder.hinge(a, b, place, motor=motor, limits=limits, reference_angle=0.0)

    def thruster(self, body: int, at: Point, angle: float, power: float) -> int:
        """Add a thruster by its place and direction in the world. Returns its id."""
        place = (at[0] + self._offset, at[1])
        return self._builder.thruster(body, place, angle=angle, power=power)

    def level(self) -> Level:
        """Return the finished document."""
        return self._builder.build()
