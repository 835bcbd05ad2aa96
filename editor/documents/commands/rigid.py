"""Pure helpers of rigid edits: jointed components, moving anchors along, freeing bodies."""

import math
from collections.abc import Callable, Collection

from editor.documents.commands.base import EntityId
from kinetix.level.geometry import (
    centre_of_mass,
    recentred,
    referenced_body,
    relative_angle,
    rotate,
    to_local,
    to_world,
)
from kinetix.level.graph import pieces
from kinetix.level.model import Body, Circle, Joint, Level, Point

CENTRE_TOLERANCE = 1e-6
"""A free body whose centre of mass is further off than this is recentred [m]."""


def component(level: Level, ids: Collection[EntityId]) -> set[int]:
    """The given bodies and all that hang on them by joints; the arena joins nothing."""
    between = [j for j in level.joints if not (isinstance(j.a, str) or isinstance(j.b, str))]
    found = [piece for piece in pieces(level, between) if not set(piece).isdisjoint(ids)]
    return {each for piece in found for each in piece}


def joined(level: Level, ids: Collection[EntityId]) -> list[set[int]]:
    """The given bodies in pieces: those that hang on one another by joints are one."""
    bodies = {body.id for body in level.bodies if body.id in ids}
    inner = [joint for joint in level.joints if joint.a in bodies and joint.b in bodies]
    return [set(piece) for piece in pieces(level, inner) if piece[0] in bodies]


def with_bodies(level: Level, ids: Collection[EntityId], change: Callable[[Body], Body]) -> Level:
    """Return the level with some of its bodies changed."""
    return level.replace(
        bodies=tuple(change(body) if body.id in ids else body for body in level.bodies)
    )


def unwound(before: Level, after: Level, ids: Collection[EntityId]) -> Level:
    """Return the level after bodies were turned, without the whole turns that they made.

    Whole turns are invisible, but joint limits count them; all bodies of a component lose the same
    number.
    """
    turns: dict[int, int] = {}
    for piece in joined(before, ids):
        turns |= dict.fromkeys(piece, _whole_turns(before, after, piece))
    return with_bodies(after, ids, lambda b: b.replace(angle=b.angle - math.tau * turns[b.id]))


def _whole_turns(before: Level, after: Level, piece: Collection[EntityId]) -> int:
    """Turns that take a piece from the middle of its limits, or else out of the turn it was in."""
    for joint in after.joints:
        limits = joint.limits if joint.kind == "revolute" else None
        if limits is None or not limits.on or (joint.a in piece) == (joint.b in piece):
            continue
        middle = joint.reference_angle + (limits.min + limits.max) / 2
        try:
            turns = round((relative_angle(after, joint) - middle) / math.tau)
        except KeyError:
            continue
        return turns if joint.b in piece else -turns
    old = next(body for body in before.bodies if body.id in piece)
    return round(after.body(old.id).angle / math.tau) - round(old.angle / math.tau)


def with_parts(level: Level, ids: Collection[EntityId], change: Callable[[Point], Point]) -> Level:
    """The level with the anchors and thrusters on some bodies elsewhere in the body's frame."""
    joints = tuple(
        joint.replace(
            anchor_a=change(joint.anchor_a) if joint.a in ids else joint.anchor_a,
            anchor_b=change(joint.anchor_b) if joint.b in ids else joint.anchor_b,
        )
        if joint.a in ids or joint.b in ids
        else joint
        for joint in level.joints
    )
    thrusters = tuple(
        t.replace(position=change(t.position)) if t.body in ids else t for t in level.thrusters
    )
    return level.replace(joints=joints, thrusters=thrusters)


def reanchored(level: Level, moved: Collection[EntityId]) -> Level:
    """Let joints between moved and resting bodies follow the moved ones.

    The anchor on the moved body stays where it is on that body; the other one goes to the same
    place in the world. A weld holds the bodies at their new angles.
    """
    loose = {joint.id for joint in level.joints if (joint.a in moved) != (joint.b in moved)}
    return _closed(level, moved, loose)


def reanchored_each(level: Level, moved: Collection[EntityId]) -> Level:
    """Let joints follow bodies that moved each by itself.

    As `reanchored`; of two moved bodies b, which is drawn above a, keeps its anchor: a wheel goes
    on turning about its centre.
    """
    loose = {joint.id for joint in level.joints if joint.a in moved or joint.b in moved}
    return _closed(level, moved, loose)


def _closed(level: Level, moved: Collection[EntityId], loose: Collection[int]) -> Level:
    """Bring the anchors of some joints together, on a moved body."""
    if not loose:
        return level

    def follow(joint: Joint) -> Joint:
        if joint.id not in loose:
            return joint
        try:
            a, b = referenced_body(level, joint.a), referenced_body(level, joint.b)
        except KeyError:
            return joint
        if joint.b in moved:
            joint = joint.replace(anchor_a=to_local(a, to_world(b, joint.anchor_b)))
        else:
            joint = joint.replace(anchor_b=to_local(b, to_world(a, joint.anchor_a)))
        if joint.kind == "fixed":
            joint = joint.replace(reference_angle=relative_angle(level, joint))
        return joint

    return level.replace(joints=tuple(follow(joint) for joint in level.joints))


def reshaped(level: Level, new: Body) -> Level:
    """Put another shape, with its frame's origin elsewhere, in the place of a body's own.

    Its anchors and thrusters stay where they are in the world; the angle must be the same.
    """
    old = level.body(new.id)
    dx, dy = new.position[0] - old.position[0], new.position[1] - old.position[1]
    x, y = rotate((dx, dy), -old.angle)

    def kept(point: Point) -> Point:
        return point[0] - x, point[1] - y

    return with_parts(with_bodies(level, (old.id,), lambda _: new), (old.id,), kept)


def freed(level: Level, body_id: int) -> Level:
    """Put the origin of a free body's frame at its centre of mass; nothing moves in the world.

    Its anchors and thrusters are shifted along, so that they too stay where they are.
    """
    body = level.body(body_id)
    if body.fixed or isinstance(body.shape, Circle):
        return level
    shift = centre_of_mass(body.shape, level.inertia_model)
    if math.hypot(*shift) < CENTRE_TOLERANCE:
        return level

    def shifted(point: Point) -> Point:
        return point[0] - shift[0], point[1] - shift[1]

    level = with_bodies(level, (body_id,), lambda b: recentred(b, level.inertia_model))
    return with_parts(level, (body_id,), shifted)
