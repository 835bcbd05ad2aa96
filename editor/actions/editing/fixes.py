"""One-click fixes of the problems panel: the command that mends an issue, where there is one."""

import dataclasses
from typing import TypeVar

from editor.documents.commands.base import Command
from editor.documents.commands.fields import SetField, SetLevelField
from editor.documents.commands.group import Remove
from editor.documents.commands.joints import HoldAsDrawn, Reanchor, WidenLimits
from editor.documents.commands.rigid import freed
from editor.session import Session
from kinetix.level.geometry import polygon_fault, reverse_winding
from kinetix.level.model import ARENA_NAMES, ArenaBody, Body, Joint, Level, Polygon
from kinetix.level.sizes import AUTOMATIC, SIZES, needed_capacity
from kinetix.level.validate import Issue

Part = TypeVar("Part", Body, ArenaBody)


@dataclasses.dataclass(frozen=True, kw_only=True)
class Fix:
    """A button beside a problem."""

    label: str
    command: Command


def fix_of(session: Session, issue: Issue) -> Fix | None:
    """The fix for an issue of the document in front, or None when only the user can mend it."""
    level = session.document.level
    if issue.code in ("E101", "E102"):
        return _give_role(session, "green" if issue.code == "E101" else "blue")
    if issue.code == "E109":
        return _fitting_size(level)
    maker = _BY_ENTITY.get(issue.code)
    ids = tuple(i for i in issue.ids if isinstance(i, int))
    return maker(level, ids) if maker and ids else None


def _give_role(session: Session, role: str) -> Fix | None:
    bodies = {body.id for body in session.document.level.bodies}
    chosen = tuple(i for i in session.selection if i in bodies)
    if len(chosen) != 1:
        return None
    command = SetField(ids=chosen, field="role", value=role)
    return Fix(label=f"Make selected {role}", command=command)


def _fitting_size(level: Level) -> Fix:
    needed = needed_capacity(level)
    name = next((n for n in AUTOMATIC if SIZES[n].covers(needed)), None)
    label = f"Switch to {name}" if name else "Size: automatic"
    return Fix(label=label, command=SetLevelField(field="size", value=name))


@dataclasses.dataclass(frozen=True, kw_only=True)
class KeepFirst:
    """Leaves one green and one blue body; the others become neutral."""

    label: str = "Keep first green and blue"
    merge_key: None = None

    def apply(self, level: Level) -> Level:
        """Take the role from all but the first of each; the arena comes before the bodies."""
        seen: set[str] = set()

        def kept(part: Part) -> Part:
            if part.role not in ("green", "blue"):
                return part
            if part.role in seen:
                return part.replace(role="none")
            seen.add(part.role)
            return part

        arena = {name: kept(getattr(level.arena, name)) for name in ARENA_NAMES}
        return level.replace(
            arena=level.arena.replace(**arena), bodies=tuple(kept(b) for b in level.bodies)
        )


@dataclasses.dataclass(frozen=True, kw_only=True)
class FixOrder:
    """Turns the vertices of polygons counter-clockwise."""

    ids: tuple[int, ...]
    label: str = "Fix order of vertices"
    merge_key: None = None

    def apply(self, level: Level) -> Level:
        """Reverse those that run clockwise."""

        def turned(body: Body) -> Body:
            if body.id not in self.ids or not isinstance(body.shape, Polygon):
                return body
            return body.replace(shape=Polygon(vertices=reverse_winding(body.shape.vertices)))

        return level.replace(bodies=tuple(turned(body) for body in level.bodies))


@dataclasses.dataclass(frozen=True, kw_only=True)
class Recentre:
    """Puts the origin of bodies' frames at their centres of mass; nothing moves in the world."""

    ids: tuple[int, ...]
    label: str = "Recentre shape"
    merge_key: None = None

    def apply(self, level: Level) -> Level:
        """Recentre the free bodies among them."""
        for body_id in self.ids:
            level = freed(level, body_id)
        return level


@dataclasses.dataclass(frozen=True, kw_only=True)
class SwapLimits:
    """Exchanges the limits of joints whose least angle is the greater one."""

    ids: tuple[int, ...]
    label: str = "Swap limits"
    merge_key: None = None

    def apply(self, level: Level) -> Level:
        """Exchange min and max."""

        def swapped(joint: Joint) -> Joint:
            limits = joint.limits
            if joint.id not in self.ids or limits is None or limits.min <= limits.max:
                return joint
            return joint.replace(limits=limits.replace(min=limits.max, max=limits.min))

        return level.replace(joints=tuple(swapped(joint) for joint in level.joints))


def _keep_first(level: Level, ids: tuple[int, ...]) -> Fix:
    del level, ids
    return Fix(label="Keep first", command=KeepFirst())


def _fix_shape(level: Level, ids: tuple[int, ...]) -> Fix | None:
    if all(
        isinstance(body.shape, Polygon) and polygon_fault(body.shape.vertices) is None
        for body in level.bodies
        if body.id in ids
    ):
        return Fix(label="Recentre", command=Recentre(ids=ids))

    def mendable(body: Body) -> bool:
        if not isinstance(body.shape, Polygon) or body.id not in ids:
            return False
        return polygon_fault(reverse_winding(body.shape.vertices)) is None

    if not any(mendable(body) for body in level.bodies):
        return None
    return Fix(label="Fix order", command=FixOrder(ids=ids))


def _delete(level: Level, ids: tuple[int, ...]) -> Fix | None:
    bodies = {body.id for body in level.bodies}
    others = tuple(i for i in ids if i not in bodies)
    return Fix(label="Delete", command=Remove(ids=others)) if others else None


def _first_binding(level: Level, ids: tuple[int, ...]) -> Fix:
    joints = {joint.id for joint in level.joints}
    field = "motor.binding" if ids[0] in joints else "binding"
    return Fix(label="Use binding 0", command=SetField(ids=ids, field=field, value=0))


def _fix_limits(level: Level, ids: tuple[int, ...]) -> Fix:
    swapped = any(
        j.id in ids and j.limits is not None and j.limits.min > j.limits.max for j in level.joints
    )
    if swapped:
        return Fix(label="Swap limits", command=SwapLimits(ids=ids))
    command = SetField(ids=ids, field="limits.on", value=False)
    return Fix(label="Switch limits off", command=command)


def _reanchor(level: Level, ids: tuple[int, ...]) -> Fix:
    del level
    return Fix(label="Re-anchor", command=Reanchor(joints=ids))


def _hold_as_drawn(level: Level, ids: tuple[int, ...]) -> Fix:
    del level
    return Fix(label="Hold as drawn", command=HoldAsDrawn(joints=ids))


def _widen_limits(level: Level, ids: tuple[int, ...]) -> Fix:
    del level
    return Fix(label="Widen limits", command=WidenLimits(joints=ids))


_BY_ENTITY = {
    "E103": _keep_first,
    "E107": _fix_shape,
    "E108": _delete,
    "E110": _first_binding,
    "W205": _fix_limits,
    "W207": _delete,
    "W209": _reanchor,
    "W213": _hold_as_drawn,
    "W215": _widen_limits,
    "W217": _delete,
}
