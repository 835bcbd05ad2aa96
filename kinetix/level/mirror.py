"""Mirror images: of bodies with their joints and thrusters, and of a whole level."""

import math
from collections.abc import Iterable
from typing import Final, Literal

from kinetix.level.geometry import ARENA_WIDTH, arena_body, reverse_winding, to_local, to_world
from kinetix.level.model import (
    Arena,
    ArenaBody,
    ArenaName,
    Body,
    BodyReference,
    Circle,
    Joint,
    Level,
    Limits,
    Point,
    Polygon,
    Shape,
    Thruster,
)

Axis = Literal["x", "y"]
"""Direction that is turned round: `x` exchanges left and right, `y` top and bottom."""
MIDDLE: Final = ARENA_WIDTH / 2
"""Middle of the arena [m]."""
End = Literal["a", "b"]
BOTH: Final[tuple[End, End]] = ("a", "b")
"""Ends of a joint."""
_WALLS: Final[dict[BodyReference, ArenaName]] = {
    "left_wall": "right_wall",
    "right_wall": "left_wall",
}


def mirrored_point(point: Point, axis: Axis, middle: float = 0.0) -> Point:
    """Return the mirror image of a point or a vector.

    Args:
        point: [m]
        axis: Direction that is turned round.
        middle: Coordinate that stays [m].
    """
    x, y = point
    return (2 * middle - x, y) if axis == "x" else (x, 2 * middle - y)


def mirrored_body(body: Body, axis: Axis, middle: float) -> Body:
    """Return the mirror image of a body, its motion included.

    Args:
        body: The body.
        axis: Direction that is turned round.
        middle: Coordinate that stays [m].
    """
    return body.replace(
        shape=_mirrored_shape(body.shape, axis),
        position=mirrored_point(body.position, axis, middle),
        angle=-body.angle,
        velocity=mirrored_point(body.velocity, axis),
        angular_velocity=-body.angular_velocity,
    )


def mirrored_thruster(thruster: Thruster, axis: Axis) -> Thruster:
    """Return a thruster as it sits on its body's mirror image.

    Args:
        thruster: The thruster.
        axis: Direction that is turned round.
    """
    angle = math.pi - thruster.angle if axis == "x" else -thruster.angle
    return thruster.replace(position=mirrored_point(thruster.position, axis), angle=angle)


def mirrored_joint(joint: Joint, axis: Axis, ends: Iterable[End] = BOTH) -> Joint:
    """Return a joint as it sits between mirror images; the same key drives the mirrored motion.

    Args:
        joint: The joint.
        axis: Direction that is turned round.
        ends: Ends whose bodies are mirrored; the others are not turned.
    """
    anchors = {f"anchor_{end}": getattr(joint, f"anchor_{end}") for end in ends}
    mirrored = {name: mirrored_point(point, axis) for name, point in anchors.items()}
    return reversed_joint(joint.replace(**mirrored))


def reversed_joint(joint: Joint) -> Joint:
    """Return a joint whose reference angle, limits and motor run the other way round.

    Args:
        joint: The joint.
    """
    limits = joint.limits and Limits(
        on=joint.limits.on, min=-joint.limits.max, max=-joint.limits.min
    )
    motor = joint.motor and joint.motor.replace(speed=-joint.motor.speed)
    return joint.replace(reference_angle=-joint.reference_angle, limits=limits, motor=motor)


def mirrored_level(level: Level) -> Level:
    """Return a level with left and right exchanged; the same actions play the mirror image.

    Args:
        level: The level; a recorded solution is dropped, as rounding may keep it from winning.
    """
    old = level.arena
    arena = Arena(
        floor=_mirrored_wall(old.floor),
        left_wall=_mirrored_wall(old.right_wall),
        right_wall=_mirrored_wall(old.left_wall),
        ceiling=_mirrored_wall(old.ceiling),
    )
    return level.replace(
        gravity=mirrored_point(level.gravity, "x"),
        arena=arena,
        bodies=tuple(mirrored_body(body, "x", MIDDLE) for body in level.bodies),
        joints=tuple(_between_walls(joint, old, arena) for joint in level.joints),
        thrusters=tuple(mirrored_thruster(thruster, "x") for thruster in level.thrusters),
        solution=None,
    )


def _between_walls(joint: Joint, before: Arena, after: Arena) -> Joint:
    """Return a joint's mirror image; side walls, whose frames are no mirror images, are swapped."""
    changes: dict[str, BodyReference | Point] = {}
    for end in BOTH:
        wall = getattr(joint, end)
        if wall in _WALLS:
            place = to_world(arena_body(before, wall), getattr(joint, f"anchor_{end}"))
            changes[end] = other = _WALLS[wall]
            image = mirrored_point(place, "x", MIDDLE)
            changes[f"anchor_{end}"] = to_local(arena_body(after, other), image)
    return mirrored_joint(joint, "x").replace(**changes)


def _mirrored_wall(wall: ArenaBody) -> ArenaBody:
    if wall.geometry is None:
        return wall
    place = wall.geometry
    return wall.replace(
        geometry=place.replace(
            position=mirrored_point(place.position, "x", MIDDLE),
            vertices=reverse_winding([mirrored_point(v, "x") for v in place.vertices]),
        )
    )


def _mirrored_shape(shape: Shape, axis: Axis) -> Shape:
    if isinstance(shape, Circle):
        return shape
    return Polygon(vertices=reverse_winding([mirrored_point(v, axis) for v in shape.vertices]))
