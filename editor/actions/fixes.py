"""One-click fixes of the problems panel: the command that mends an issue, where there is one."""

import dataclasses

from editor.commands.base import Command
from editor.commands.fields import SetField, SetLevelField
from editor.commands.group import Remove
from editor.commands.joints import Reanchor
from editor.session import Session
from kinetix.level.geometry import polygon_fault, reverse_winding
from kinetix.level.model import Body, Joint, Level, Polygon
from kinetix.level.sizes import AUTOMATIC, SIZES, needed_capacity
from kinetix.level.validate import Issue


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
        """Take the role from all but the first of each."""
        seen: set[str] = set()

        def kept(body: Body) -> Body:
            if body.role not in ("green", "blue"):
                return body
            if body.role in seen:
                return body.replace(role="none")
            seen.add(body.role)
            return body

        return level.replace(bodies=tuple(kept(body) for body in level.bodies))


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


def _fix_order(level: Level, ids: tuple[int, ...]) -> Fix | None:
    def mendable(body: Body) -> bool:
        if not isinstance(body.shape, Polygon) or body.id not in ids:
            return False
        return polygon_fault(reverse_winding(body.shape.vertices)) is None

    if not any(mendable(body) for body in level.bodies):
        return None
    return Fix(label="Fix order", command=FixOrder(ids=ids))


def _delete(level: Level, ids: tuple[int, ...]) -> Fix | None:
    joints = tuple(joint.id for joint in level.joints if joint.id in ids)
    return Fix(label="Delete", command=Remove(ids=joints)) if joints else None


def _swap_limits(level: Level, ids: tuple[int, ...]) -> Fix | None:
    swapped = any(
        j.id in ids and j.limits is not None and j.limits.min > j.limits.max for j in level.joints
    )
    return Fix(label="Swap", command=SwapLimits(ids=ids)) if swapped else None


def _reanchor(level: Level, ids: tuple[int, ...]) -> Fix:
    del level
    return Fix(label="Re-anchor", command=Reanchor(joints=ids))


_BY_ENTITY = {
    "E103": _keep_first,
    "E107": _fix_order,
    "E108": _delete,
    "W205": _swap_limits,
    "W207": _delete,
    "W209": _reanchor,
}
