"""The parts of a level that decide which step is compiled for it alone; free of JAX."""

from collections.abc import Hashable

from kinetix.level.model import ARENA_NAMES, Circle, Level
from kinetix.level.sizes import capacity_of


def outline(level: Level) -> Hashable:
    """Return a value that differs wherever the features of two levels differ.

    It says which shapes there are and which of them are joined, fixed, bouncing or in the same
    collision group; what motors, limits and thrusters there are. It does not say where anything is,
    how large or how strong. Levels of different outlines may still have the same features.
    """
    bodies = tuple(
        (
            body.id,
            0 if isinstance(body.shape, Circle) else len(body.shape.vertices),
            body.fixed,
            body.collision,
            body.restitution > 0,
        )
        for body in level.bodies
    )
    joints = tuple(
        (
            joint.kind,
            joint.a,
            joint.b,
            joint.motor is not None and joint.motor.on,
            joint.limits is not None and joint.limits.on,
        )
        for joint in level.joints
    )
    parts = (getattr(level.arena, name) for name in ARENA_NAMES)
    arena = tuple((part.collision, part.restitution > 0) for part in parts)
    return capacity_of(level), bodies, joints, arena, bool(level.thrusters)
