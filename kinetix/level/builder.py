"""Builds a level from Python: bodies by their place in the world. No JAX."""

import operator
import typing
from collections.abc import Iterable, Sequence
from typing import Any, Final

from kinetix.errors import LevelError
from kinetix.level.body_fields import (
    BodyFields,
    check_fields,
    check_name,
    number_below,
    pair,
    real,
    size,
)
from kinetix.level.geometry import arena_body, centre_of_corners, polygon_fault, to_local
from kinetix.level.model import (
    ARENA_NAMES,
    MAX_ENTITIES,
    MOTOR_BINDINGS,
    THRUSTER_BINDINGS,
    Arena,
    ArenaBody,
    ArenaName,
    Body,
    BodyReference,
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
from kinetix.level.sizes import without_outgrown_size

_GHOST = ArenaBody(collision="ghost")
EMPTY_ARENA: Final = Arena(floor=_GHOST, left_wall=_GHOST, right_wall=_GHOST, ceiling=_GHOST)
"""An arena that nothing touches."""


class LevelBuilder:
    """Collects bodies, joints and thrusters; `build` returns the level.

    Units are SI, angles in radians, counter-clockwise. Every call returns the new entity's id.
    Positions may be anything; files keep to ±15 m.
    """

    def __init__(
        self, name: str = "", gravity: Sequence[float] = (0.0, -9.81), arena: bool | Arena = True
    ) -> None:
        """Start with an empty space.

        Args:
            name: Title of the level; "Untitled" without one.
            gravity: Acceleration of gravity (x, y) [m/s²].
            arena: Whether there are a floor at y = 0.4, walls at x = 0 and 5 and a ceiling at
                y = 5; or an arena of one's own.

        Raises:
            LevelError: The name is no string, or the gravity is not two finite numbers.
        """
        if not isinstance(name, str):
            raise LevelError(f"name {name!r:.60}: expected a string")
        begun = Level(
            name=name or "Untitled",
            gravity=pair("gravity", gravity),
            arena=arena if isinstance(arena, Arena) else Arena() if arena else EMPTY_ARENA,
        )
        self._take(begun)

    @classmethod
    def from_level(cls, level: Level) -> "LevelBuilder":
        """Return a builder that goes on from a level: all that is there stays, with its ids.

        What `build` returns has the level's title, options and arena too. With more in it, it has
        no recorded solution, and where it has outgrown the level's `size`, the smallest that fits.

        Args:
            level: Such as `kinetix.load_level("s/first_flight")`.

        Raises:
            LevelError: `level` is not a level.
        """
        if not isinstance(level, Level):
            raise LevelError(f"level: expected a kinetix.Level, got {type(level).__name__}")
        builder = cls()
        builder._take(level)
        return builder

    def _take(self, level: Level) -> None:
        self._begun = level
        self._bodies = {body.id: body for body in level.bodies}
        self._joints = list(level.joints)
        self._thrusters = list(level.thrusters)
        self._used = level.next_id - 1

    def __repr__(self) -> str:
        """Return the name and how much there is."""
        return (
            f"LevelBuilder({self._begun.name!r}: {len(self._bodies)} bodies, "
            f"{len(self._joints)} joints, {len(self._thrusters)} thrusters)"
        )

    @property
    def floor(self) -> ArenaName:
        """Name of the arena's floor, for joints."""
        return "floor"

    @property
    def left_wall(self) -> ArenaName:
        """Name of the arena's left wall, for joints."""
        return "left_wall"

    @property
    def right_wall(self) -> ArenaName:
        """Name of the arena's right wall, for joints."""
        return "right_wall"

    @property
    def ceiling(self) -> ArenaName:
        """Name of the arena's ceiling, for joints."""
        return "ceiling"

    def rectangle(
        self, x: float, y: float, width: float, height: float, **more: typing.Unpack[BodyFields]
    ) -> int:
        """Add a rectangle by its centre [m].

        Args:
            x: Of the centre.
            y: Of the centre.
            width: Along x before it is turned by `angle`.
            height: Along y before it is turned by `angle`.
            more: See `BodyFields`.

        Raises:
            LevelError: A value cannot be.
        """
        shape = Polygon(vertices=rectangle(size("width", width), size("height", height)))
        return self.body(shape, x, y, **more)

    def circle(self, x: float, y: float, radius: float, **more: typing.Unpack[BodyFields]) -> int:
        """Add a disc by its centre and radius [m]; `more`: see `BodyFields`.

        Raises:
            LevelError: A value cannot be.
        """
        return self.body(Circle(radius=size("radius", radius)), x, y, **more)

    def polygon(self, points: Iterable[Sequence[float]], **more: typing.Unpack[BodyFields]) -> int:
        """Add a convex polygon by its 3 or 4 corners in the world.

        Args:
            points: Counter-clockwise [m]; as they are before the body is turned by `angle`.
            more: See `BodyFields`.

        Raises:
            LevelError: The corners are no such polygon, or a value cannot be.
        """
        corners = tuple(pair("points", point) for point in points)
        fault = polygon_fault(corners)
        if fault is not None:
            raise LevelError(f"polygon {_short(corners)}: {fault}")
        x, y = centre_of_corners(corners, self._begun.inertia_model)
        local = tuple((px - x, py - y) for px, py in corners)
        return self.body(Polygon(vertices=local), x, y, **more)

    def body(self, shape: Shape, x: float, y: float, **more: typing.Unpack[BodyFields]) -> int:
        """Add a body of any shape of the format by the origin of its frame [m].

        Raises:
            LevelError: A value cannot be.
        """
        fields: dict[str, Any] = dict(more)
        check_fields(fields)
        body_id = self._next("bodies", len(self._bodies))
        self._bodies[body_id] = Body(
            id=body_id, shape=shape, position=(real("x", x), real("y", y)), **fields
        )
        return body_id

    def hinge(
        self,
        a: BodyReference,
        b: BodyReference,
        at: Sequence[float],
        *,
        motor: Motor | None = None,
        limits: Limits | Sequence[float] | None = None,
        reference_angle: float | None = None,
        name: str | None = None,
    ) -> int:
        """Join two bodies at a point so that they can turn against each other.

        Bodies connected by joints, also through fixed ones, do not collide.

        Args:
            a: First body.
            b: Second body; a motor at +1 turns it counter-clockwise against the first.
            at: The point in the world [m].
            motor: `kinetix.level.Motor`; none without one.
            limits: Least and greatest angle of b against a, or `kinetix.level.Limits` [rad].
            reference_angle: Angle of b minus angle of a that counts as zero; by default the present
                one [rad].
            name: For people, of 1 to 60 characters; the editor shows it.

        Raises:
            LevelError: A body is missing, or a value cannot be.
        """
        if limits is not None and not isinstance(limits, Limits):
            low, high = pair("limits", limits)
            limits = Limits(min=low, max=high)
        if limits is not None and limits.min > limits.max:
            raise LevelError(f"limits ({limits.min:g}, {limits.max:g}): expected min ≤ max")
        if motor is not None:
            motor = _checked(motor)
        return self._join(
            "revolute",
            (a, b),
            at,
            motor=motor,
            limits=limits,
            reference_angle=reference_angle,
            name=name,
        )

    def weld(
        self, a: BodyReference, b: BodyReference, at: Sequence[float], *, name: str | None = None
    ) -> int:
        """Join two bodies rigidly.

        Args:
            a: First body.
            b: Second body.
            at: The point in the world [m].
            name: For people, of 1 to 60 characters; the editor shows it.

        Raises:
            LevelError: A body is missing, or a value cannot be.
        """
        return self._join("fixed", (a, b), at, name=name)

    def thruster(
        self,
        body: int,
        at: Sequence[float],
        *,
        angle: float,
        power: float,
        binding: int = 0,
        name: str | None = None,
    ) -> int:
        """Add a thruster to a body.

        Args:
            body: What it pushes.
            at: Where it sits, in the world [m].
            angle: Direction of its push at the start; it turns with the body [rad].
            power: Strength in units of 10 N.
            binding: Action channel that drives it, 0 or 1.
            name: For people, of 1 to 60 characters; the editor shows it.

        Raises:
            LevelError: The body is missing, or a value cannot be.
        """
        body = _plain(body)
        pushed = self._find(body)
        if isinstance(body, str):
            raise LevelError(f"thruster on {body}: expected a body that is not part of the arena")
        thruster = Thruster(
            id=self._next("thrusters", len(self._thrusters)),
            body=body,
            position=to_local(pushed, pair("at", at)),
            angle=real("angle", angle) - pushed.angle,
            power=real("power", power, low=0.0),
            binding=number_below("thruster: binding", binding, THRUSTER_BINDINGS),
            name=check_name(name),
        )
        self._thrusters.append(thruster)
        return thruster.id

    def build(self) -> Level:
        """Return the level as it is now; the builder can be used further."""
        added = self._used + 1 != self._begun.next_id
        return without_outgrown_size(
            self._begun.replace(
                next_id=self._used + 1,
                bodies=tuple(self._bodies.values()),
                joints=tuple(self._joints),
                thrusters=tuple(self._thrusters),
                solution=None if added else self._begun.solution,
            )
        )

    def _join(
        self,
        kind: JointKind,
        ends: tuple[BodyReference, BodyReference],
        at: Sequence[float],
        *,
        motor: Motor | None = None,
        limits: Limits | None = None,
        reference_angle: float | None = None,
        name: str | None = None,
    ) -> int:
        ends = _plain(ends[0]), _plain(ends[1])
        first, second = (self._find(end) for end in ends)
        if ends[0] == ends[1] or (isinstance(ends[0], str) and isinstance(ends[1], str)):
            raise LevelError(f"joint between {ends[0]} and {ends[1]}: expected two bodies")
        place = pair("at", at)
        if reference_angle is None:
            reference_angle = second.angle - first.angle
        joint = Joint(
            id=self._next("joints", len(self._joints)),
            kind=kind,
            a=ends[0],
            b=ends[1],
            anchor_a=to_local(first, place),
            anchor_b=to_local(second, place),
            reference_angle=real("reference_angle", reference_angle),
            motor=motor,
            limits=limits,
            name=check_name(name),
        )
        self._joints.append(joint)
        return joint.id

    def _next(self, kind: str, count: int) -> int:
        if count >= MAX_ENTITIES:
            raise LevelError(f"expected at most {MAX_ENTITIES} {kind} in a level")
        self._used += 1
        return self._used

    def _find(self, reference: BodyReference) -> Body:
        if isinstance(reference, str):
            if reference not in ARENA_NAMES:
                raise LevelError(
                    f"there is no body {reference!r}: expected an id or {', '.join(ARENA_NAMES)}"
                )
            if self._begun.arena == EMPTY_ARENA:
                raise LevelError(
                    f"there is no {reference}, as arena=False: add a body with fixed=True instead"
                )
            return arena_body(self._begun.arena, reference)
        known = isinstance(reference, int) and not isinstance(reference, bool)
        if not known or reference not in self._bodies:
            raise LevelError(
                f"there is no body {reference!r}: expected an id that rectangle, circle or polygon "
                f"returned"
            )
        return self._bodies[reference]


def _plain(reference: Any) -> Any:
    """Return an id of numpy's or JAX's as a number of Python's; anything else as it is."""
    if isinstance(reference, bool):
        return reference
    try:
        return operator.index(reference)
    except TypeError:
        return reference


def rectangle(width: float, height: float) -> tuple[Point, ...]:
    """Return the corners of a rectangle around its centre, counter-clockwise [m]."""
    x, y = width / 2, height / 2
    return ((x, y), (-x, y), (-x, -y), (x, -y))


def _checked(motor: Any) -> Motor:
    if not isinstance(motor, Motor):
        raise LevelError(f"motor {motor!r}: expected a kinetix.level.Motor, such as Motor()")
    real("motor: speed", motor.speed)
    real("motor: power", motor.power, low=0.0)
    binding = number_below("motor: binding", motor.binding, MOTOR_BINDINGS)
    return motor.replace(binding=binding)


def _short(corners: Sequence[Point]) -> str:
    return ", ".join(f"({x:g}, {y:g})" for x, y in corners[:5])
