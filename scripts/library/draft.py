"""A level in the making: shapes by their place in the arena, angles in degrees."""

import math
from collections.abc import Sequence
from typing import Any, Final

from kinetix.level.builder import LevelBuilder
from kinetix.level.geometry import FLOOR_TOP
from kinetix.level.model import (
    Arena,
    ArenaBody,
    BodyReference,
    Level,
    Limits,
    Motor,
    Point,
    Role,
    SizeName,
)

FLOOR: Final = FLOOR_TOP
"""Height of the floor's surface [m]."""

LEFT_RIGHT: Final = 0
UP_DOWN: Final = 1
W_S: Final = 2
A_D: Final = 3
"""Motor controls, named after the editor's keys; the first key turns counter-clockwise."""
KEY_1: Final = 0
KEY_2: Final = 1
"""Thruster controls."""


class Draft:
    """Collects bodies, joints and thrusters; `level` makes the document."""

    def __init__(
        self,
        *tags: str,
        difficulty: int,
        floor: Role = "none",
        friction: float = 1.0,
        steps: int = 256,
        gravity: float = -9.81,
    ) -> None:
        """Start with the empty arena.

        Args:
            tags: What the level is about.
            difficulty: 1 (trivial) to 5 (hard); an estimate, until it is measured.
            floor: Role of the floor.
            friction: Friction value of the floor and of every body that does not say its own.
            steps: Environment steps until time is up.
            gravity: Downwards when negative [m/s²].
        """
        self._tags = (*tags, f"difficulty-{difficulty}")
        self._friction = friction
        self._steps = steps
        arena = Arena(floor=ArenaBody(role=floor, friction=friction))
        self._builder = LevelBuilder(gravity=(0.0, gravity), arena=arena)

    def box(self, at: Point, width: float, height: float, role: Role = "none", **more: Any) -> int:
        """Add a rectangle by its centre; `turn` turns it [°]. Returns its id."""
        return self._builder.rectangle(*at, width, height, **self._fields(role, more))

    def ball(self, at: Point, radius: float, role: Role = "none", **more: Any) -> int:
        """Add a disc by its centre. Returns its id."""
        return self._builder.circle(*at, radius, **self._fields(role, more))

    def shape(self, corners: Sequence[Point], role: Role = "none", **more: Any) -> int:
        """Add a polygon by its 3 or 4 corners in the arena, counter-clockwise. Returns its id."""
        return self._builder.polygon(corners, **self._fields(role, more))

    def rod(
        self, start: Point, degrees: float, length: float, role: Role = "none", **more: Any
    ) -> tuple[int, Point]:
        """Add a bar that leads from a point in a direction; `width` is its thickness [m].

        Returns:
            Its id and where it ends.
        """
        angle = math.radians(degrees)
        reach = (math.cos(angle) * length, math.sin(angle) * length)
        middle = (start[0] + reach[0] / 2, start[1] + reach[1] / 2)
        bar = self.box(middle, length, more.pop("width", 0.12), role, turn=degrees, **more)
        return bar, (start[0] + reach[0], start[1] + reach[1])

    def hinge(self, a: BodyReference, b: BodyReference, at: Point, **more: Any) -> int:
        """Join two bodies so that they can turn. Returns the joint's id.

        Args:
            a: First body; it may be part of the arena.
            b: Second body.
            at: Where the axle is.
            more: `control` (one of the names above) gives it a motor, with `speed` and `power`;
                `limits` are the least and greatest angle from now on [°].
        """
        motor = None
        if "control" in more:
            motor = Motor(
                binding=more["control"],
                speed=more.get("speed", 1.0),
                power=more.get("power", 1.0),
            )
        limits = None
        if "limits" in more:
            low, high = more["limits"]
            limits = Limits(min=math.radians(low), max=math.radians(high))
        return self._builder.hinge(a, b, at, motor=motor, limits=limits)

    def weld(self, a: BodyReference, b: BodyReference, at: Point) -> int:
        """Join two bodies rigidly. Returns the joint's id."""
        return self._builder.weld(a, b, at)

    def thruster(
        self, body: int, at: Point, degrees: float, power: float, control: int = KEY_1
    ) -> int:
        """Add a thruster by its place in the arena and the direction of its push [°].

        Args:
            body: What it pushes.
            at: Where it sits.
            degrees: Direction of the push at the start; it turns with the body.
            power: In units of 10 N: a body hovers at 0.981 of its mass [kg].
            control: `KEY_1` or `KEY_2`.
        """
        angle = math.radians(degrees)
        return self._builder.thruster(body, at, angle=angle, power=power, binding=control)

    def level(self, name: str, description: str, size: SizeName) -> Level:
        """Return the finished document."""
        return self._builder.build().replace(
            name=name,
            description=description,
            tags=self._tags,
            size=size,
            max_timesteps=self._steps,
        )

    def _fields(self, role: Role, more: dict[str, Any]) -> dict[str, Any]:
        turn = math.radians(more.pop("turn", 0.0))
        return {"friction": self._friction, "angle": turn, "role": role, **more}
