"""Puts a level together from world coordinates: the scenes' one way to build."""

import math
from collections.abc import Sequence
from typing import Any, Final

from kinetix.level.geometry import area_centroid, to_local
from kinetix.level.model import (
    Arena,
    ArenaBody,
    Body,
    Circle,
    Joint,
    JointKind,
    Level,
    Limits,
    Motor,
    Point,
    Polygon,
    Shape,
    Thruster,
)
from kinetix.scenes.model import GRAVITY

DEFAULT_FRICTION: Final = 0.566
"""Coefficient of friction of a pair, unless a scene says otherwise."""
FLOOR: Final = (40.0, 1.0)
"""Length and height of the floor [m]; its top is at y = 0."""

_GHOST = ArenaBody(collision="ghost")
_EMPTY_ARENA = Arena(floor=_GHOST, left_wall=_GHOST, right_wall=_GHOST, ceiling=_GHOST)


def rectangle(length: float, height: float) -> tuple[Point, ...]:
    """Corners of a rectangle around its centre, counter-clockwise [m]."""
    x, y = length / 2, height / 2
    return ((x, y), (-x, y), (-x, -y), (x, -y))


def surface_friction(coefficient: float) -> float:
    """The friction value that two equal surfaces need for a coefficient.

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
        self._name = name
        self._friction = surface_friction(friction)
        self._restitution = restitution
        self._gravity = (gravity * math.sin(slope), -gravity * math.cos(slope))
        self._offset = offset
        self._bodies: list[Body] = []
        self._joints: list[Joint] = []
        self._thrusters: list[Thruster] = []
        self._used = 0
        if floor:
            self.box(*FLOOR, 0.0, -FLOOR[1] / 2, fixed=True)

    def box(
        self, length: float, height: float, x: float, y: float, angle: float = 0.0, **more: Any
    ) -> int:
        """Add a rectangle by its centre; `more` are fields of `Body`. Returns its id."""
        return self.body(Polygon(vertices=rectangle(length, height)), x, y, angle, **more)

    def disc(self, radius: float, x: float, y: float, **more: Any) -> int:
        """Add a disc by its centre; `more` are fields of `Body`. Returns its id."""
        return self.body(Circle(radius=radius), x, y, **more)

    def polygon(self, corners: Sequence[Point], **more: Any) -> int:
        """Add a free polygon by its corners in the world, counter-clockwise. Returns its id."""
        x, y = area_centroid(corners)
        local = tuple((px - x, py - y) for px, py in corners)
        return self.body(Polygon(vertices=local), x, y, **more)

    def body(self, shape: Shape, x: float, y: float, angle: float = 0.0, **more: Any) -> int:
        """Add a body; `more` are fields of `Body`. Returns its id."""
        fields: dict[str, Any] = {
            "id": self._next(),
            "shape": shape,
            "position": (x + self._offset, y),
            "angle": angle,
            "friction": self._friction,
            "restitution": self._restitution,
        }
        body = Body(**(fields | more))
        self._bodies.append(body)
        return body.id

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
        """Join two bodies at a point of the world, at their present angles. Returns the id."""
        first, second = self._find(a), self._find(b)
        place = (at[0] + self._offset, at[1])
        joint = Joint(
            id=self._next(),
            kind=kind,
            a=a,
            b=b,
            anchor_a=to_local(first, place),
            anchor_b=to_local(second, place),
            reference_angle=second.angle - first.angle if kind == "fixed" else 0.0,
            motor=motor,
            limits=limits,
        )
        self._joints.append(joint)
        return joint.id

    def thruster(self, body: int, at: Point, angle: float, power: float) -> int:
        """Add a thruster by its place and direction in the body's frame. Returns its id."""
        thruster = Thruster(id=self._next(), body=body, position=at, angle=angle, power=power)
        self._thrusters.append(thruster)
        return thruster.id

    def level(self) -> Level:
        """The finished document."""
        return Level(
            name=self._name,
            gravity=self._gravity,
            arena=_EMPTY_ARENA,
            bodies=tuple(self._bodies),
            joints=tuple(self._joints),
            thrusters=tuple(self._thrusters),
        )

    def _next(self) -> int:
        self._used += 1
        return self._used

    def _find(self, body: int) -> Body:
        return next(each for each in self._bodies if each.id == body)
