"""Edits of joints: joining two bodies, bringing the anchors together again."""

import dataclasses
import math
from collections.abc import Callable, Collection, Hashable

from editor.documents.commands.base import EntityId
from kinetix.errors import CommandError
from kinetix.level.geometry import referenced_body, relative_angle, to_local, to_world
from kinetix.level.mirror import reversed_joint
from kinetix.level.model import (
    ARENA_NAMES,
    BodyReference,
    Circle,
    Joint,
    JointKind,
    Level,
    Motor,
    Point,
)


def drawing_rank(level: Level, reference: BodyReference) -> tuple[int, int]:
    """Sorts body references from below: the arena, polygons, circles, each in list order."""
    if isinstance(reference, str):
        return 0, ARENA_NAMES.index(reference)
    for index, body in enumerate(level.bodies):
        if body.id == reference:
            return (2 if isinstance(body.shape, Circle) else 1), index
    raise CommandError(f"There is no body {reference}.")


def joint_between(
    level: Level, bodies: tuple[BodyReference, BodyReference], point: Point, kind: JointKind
) -> Joint:
    """Return a new joint of two bodies at a world point; the lower body is `a`.

    Raises:
        CommandError: A body is missing, or both are the same.
    """
    a, b = sorted(bodies, key=lambda reference: drawing_rank(level, reference))
    if a == b:
        raise CommandError("A joint needs two different bodies.")
    body_a, body_b = referenced_body(level, a), referenced_body(level, b)
    return Joint(
        id=level.next_id,
        kind=kind,
        a=a,
        b=b,
        anchor_a=to_local(body_a, point),
        anchor_b=to_local(body_b, point),
        reference_angle=body_b.angle - body_a.angle,
        motor=Motor() if kind == "revolute" else None,
    )


@dataclasses.dataclass(frozen=True, kw_only=True)
class AddJoint:
    """Joins two bodies at a world point."""

    bodies: tuple[BodyReference, BodyReference]
    point: Point
    kind: JointKind
    merge_key: Hashable | None = None

    @property
    def label(self) -> str:
        """Names the kind."""
        return "Add joint" if self.kind == "revolute" else "Add weld"

    def apply(self, level: Level) -> Level:
        """Append the joint.

        Raises:
            CommandError: A body is missing, or both are the same.
        """
        joint = joint_between(level, self.bodies, self.point, self.kind)
        return level.replace(joints=(*level.joints, joint), next_id=level.next_id + 1)


@dataclasses.dataclass(frozen=True, kw_only=True)
class MoveJoint:
    """Puts a joint's anchors at another world point of its two bodies."""

    joint: int
    point: Point
    merge_key: Hashable | None = None

    @property
    def label(self) -> str:
        """Label of the edit in menus and history."""
        return "Move joint"

    def apply(self, level: Level) -> Level:
        """Set both anchors.

        Raises:
            CommandError: The joint does not exist.
        """
        return _with_joint(level, self.joint, lambda joint: self._moved(level, joint))

    def _moved(self, level: Level, joint: Joint) -> Joint:
        return joint.replace(
            anchor_a=to_local(referenced_body(level, joint.a), self.point),
            anchor_b=to_local(referenced_body(level, joint.b), self.point),
        )


@dataclasses.dataclass(frozen=True, kw_only=True)
class RehangJoint:
    """Puts a joint at another place and on the bodies there; a body that stays is driven as before.

    Name, motor and limits stay.
    """

    joint: int
    bodies: tuple[BodyReference, BodyReference]
    point: Point
    merge_key: Hashable | None = None

    @property
    def label(self) -> str:
        """Label of the edit in menus and history."""
        return "Move joint to other bodies"

    def apply(self, level: Level) -> Level:
        """Join the other bodies.

        Raises:
            CommandError: The joint or a body does not exist, or both bodies are the same.
        """

        def rehung(joint: Joint) -> Joint:
            fresh = joint_between(level, self.bodies, self.point, joint.kind)
            # A body that stays at the other end turns the other way against its new partner.
            if fresh.a == joint.b or fresh.b == joint.a:
                joint = reversed_joint(joint)
            return fresh.replace(
                id=joint.id, name=joint.name, motor=joint.motor, limits=joint.limits
            )

        return _with_joint(level, self.joint, rehung)


@dataclasses.dataclass(frozen=True, kw_only=True)
class ReassignJoint:
    """Lets a joint hold another body; the anchor stays where it is in the world."""

    joint: int
    end: str
    """`a` or `b`."""
    body: BodyReference
    merge_key: Hashable | None = None

    @property
    def label(self) -> str:
        """Label of the edit in menus and history."""
        return f"Change body {self.end.upper()} of joint"

    def apply(self, level: Level) -> Level:
        """Change one end.

        Raises:
            CommandError: The joint does not exist, or both ends would be the same body.
        """
        return _with_joint(level, self.joint, lambda joint: self._reassigned(level, joint))

    def _reassigned(self, level: Level, joint: Joint) -> Joint:
        if self.body == (joint.b if self.end == "a" else joint.a):
            raise CommandError("A joint needs two different bodies.")
        point = to_world(
            referenced_body(level, getattr(joint, self.end)), getattr(joint, f"anchor_{self.end}")
        )
        local = to_local(referenced_body(level, self.body), point)
        changed = joint.replace(**{self.end: self.body, f"anchor_{self.end}": local})
        return changed.replace(reference_angle=relative_angle(level, changed))


@dataclasses.dataclass(frozen=True, kw_only=True)
class Reanchor:
    """Brings the two anchors of joints together, on body b's side (the fix of W209)."""

    joints: tuple[EntityId, ...]
    merge_key: Hashable | None = None

    @property
    def label(self) -> str:
        """Label of the edit in menus and history."""
        return "Re-anchor joint"

    def apply(self, level: Level) -> Level:
        """Move anchor b onto anchor a."""

        def reanchored(joint: Joint) -> Joint:
            at = to_world(referenced_body(level, joint.a), joint.anchor_a)
            return joint.replace(anchor_b=to_local(referenced_body(level, joint.b), at))

        return _with_joints(level, self.joints, reanchored)


@dataclasses.dataclass(frozen=True, kw_only=True)
class HoldAsDrawn:
    """Lets joints hold the angles at which their bodies are drawn (the fix of W213)."""

    joints: tuple[EntityId, ...]
    merge_key: Hashable | None = None

    @property
    def label(self) -> str:
        """Label of the edit in menus and history."""
        return "Hold as drawn"

    def apply(self, level: Level) -> Level:
        """Count the drawn angles as zero."""

        def held(joint: Joint) -> Joint:
            return joint.replace(reference_angle=relative_angle(level, joint))

        return _with_joints(level, self.joints, held)


@dataclasses.dataclass(frozen=True, kw_only=True)
class WidenLimits:
    """Lets the limits of joints take in the drawn angles (the fix of W215)."""

    joints: tuple[EntityId, ...]
    merge_key: Hashable | None = None

    @property
    def label(self) -> str:
        """Label of the edit in menus and history."""
        return "Widen limits"

    def apply(self, level: Level) -> Level:
        """Move the limits no further than to the drawn angle, whole turns left aside."""

        def widened(joint: Joint) -> Joint:
            if joint.limits is None:
                return joint
            low, high = sorted((joint.limits.min, joint.limits.max))
            drawn = relative_angle(level, joint) - joint.reference_angle
            turns = math.tau * round((drawn - (low + high) / 2) / math.tau)
            drawn -= turns
            limits = joint.limits.replace(min=min(low, drawn), max=max(high, drawn))
            return joint.replace(reference_angle=joint.reference_angle + turns, limits=limits)

        return _with_joints(level, self.joints, widened)


def _with_joint(level: Level, joint_id: int, change: Callable[[Joint], Joint]) -> Level:
    if all(joint.id != joint_id for joint in level.joints):
        raise CommandError(f"There is no joint {joint_id}.")
    return _with_joints(level, (joint_id,), change)


def _with_joints(
    level: Level, ids: Collection[EntityId], change: Callable[[Joint], Joint]
) -> Level:
    return level.replace(
        joints=tuple(change(joint) if joint.id in ids else joint for joint in level.joints)
    )
