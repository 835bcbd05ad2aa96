"""Problems of roles, joints, thrusters and sizes."""

import math
from collections import defaultdict
from collections.abc import Iterator
from typing import Final

from kinetix.level.geometry import arena_bodies, overlap_depth, to_world
from kinetix.level.graph import components, modes_meet
from kinetix.level.model import ARENA_NAMES, Body, BodyReference, Joint, Level
from kinetix.level.sizes import capacity_of, needed_capacity, shortages
from kinetix.level.validate.issue import Issue, capital, describe, issue
from kinetix.level.validate.placed import Placed

ANCHOR_TOLERANCE: Final = 1e-3
"""Distance of a joint's anchors that counts as none [m]."""
ANGLE_TOLERANCE: Final = 1e-3
"""Difference of a weld's angle from the one that it holds that counts as none [rad]."""
LIMIT_TOLERANCE: Final = math.radians(1.0)
"""A hinge that is drawn less than this outside its limits gets no warning [rad]."""
GIVE: Final = 0.01
"""Welded bodies that are drawn further apart never touch: a weld gives less under a blow [m]."""


def role_issues(level: Level, placed: list[Placed]) -> Iterator[Issue]:
    """Yield what is wrong with green and blue: none, several, or never touching.

    E101 to E103, W204 and W216.

    Args:
        level: The level.
        placed: Those of its bodies that have a place.
    """
    holders: defaultdict[str, list[tuple[BodyReference, Body]]] = defaultdict(list)
    for name, body in zip(ARENA_NAMES, arena_bodies(level.arena), strict=True):
        holders[body.role].append((name, body))
    for body in level.bodies:
        holders[body.role].append((body.id, body))
    green, blue = holders["green"], holders["blue"]
    ids: tuple[BodyReference, ...] = tuple(reference for reference, _ in (*green, *blue))
    if not green:
        message = "No green shape: the level cannot be won."
        yield issue("E101", message, fix="Make selected green")
    if not blue:
        yield issue("E102", "No blue shape: nothing to reach.", fix="Make selected blue")
    if len(green) > 1 or len(blue) > 1:
        message = (
            f"{len(green)} green and {len(blue)} blue shapes; expected exactly one each "
            f"(true of all published levels)."
        )
        yield issue("E103", message, ids=ids, fix="Keep first")
    if not (green and blue):
        return
    held = _held(level, placed)
    if not any(_can_touch(a, b, held) for a in green for b in blue):
        message = (
            "Green and blue can never touch (by their collision, as parts of the arena, or held "
            "apart by welds): the level cannot be won."
        )
        yield issue("W216", message, ids=ids)
    elif all(body.fixed for _, body in (*green, *blue)):
        message = "Green and blue are both fixed: unwinnable unless another shape moves."
        yield issue("W204", message, ids=ids)


def _can_touch(
    a: tuple[BodyReference, Body],
    b: tuple[BodyReference, Body],
    held: dict[BodyReference, BodyReference],
) -> bool:
    """Return whether a pair may ever touch: the engine looks at it, and no welds keep it apart."""
    within = isinstance(a[0], str) and isinstance(b[0], str)
    if within or not modes_meet(a[1], b[1]):
        return False
    rigid = a[0] in held and held[a[0]] == held.get(b[0])
    return not rigid or overlap_depth(a[1], b[1]) > -GIVE


def _held(level: Level, placed: list[Placed]) -> dict[BodyReference, BodyReference]:
    """For every body that welds hold where it is drawn a representative of those it is held to."""
    bodies = {each.reference: each.body for each in placed}
    welds: list[Joint] = []
    for joint in level.joints:
        a, b = bodies.get(joint.a), bodies.get(joint.b)
        if joint.kind == "fixed" and a is not None and b is not None:
            gap, turn = _misfit(joint, a, b)
            if gap <= ANCHOR_TOLERANCE and abs(turn) <= ANGLE_TOLERANCE:
                welds.append(joint)
    return components(welds)


def _misfit(joint: Joint, a: Body, b: Body) -> tuple[float, float]:
    """Return how far its anchors are apart [m], and the drawn angle from its reference [rad]."""
    gap = math.dist(to_world(a, joint.anchor_a), to_world(b, joint.anchor_b))
    return gap, b.angle - a.angle - joint.reference_angle


def reference_issues(level: Level) -> Iterator[Issue]:
    """Yield joints and thrusters whose bodies are not there (E108)."""
    bodies = {body.id for body in level.bodies}
    for k, joint in enumerate(level.joints):
        missing = [r for r in (joint.a, joint.b) if isinstance(r, int) and r not in bodies]
        if missing or joint.a == joint.b:
            what = "missing" if missing else "identical"
            yield issue(
                "E108",
                f"Joint {joint.id}: bodies {what}.",
                path=f"$.joints[{k}]",
                ids=(joint.id,),
                fix="Delete",
            )
    for k, thruster in enumerate(level.thrusters):
        if thruster.body not in bodies:
            yield issue(
                "E108",
                f"Thruster {thruster.id}: body missing.",
                path=f"$.thrusters[{k}].body",
                ids=(thruster.id,),
                fix="Delete",
            )


def size_issues(level: Level) -> Iterator[Issue]:
    """Yield what does not fit the level's size (E109)."""
    for sentence in shortages(needed_capacity(level), capacity_of(level)):
        yield issue("E109", sentence, path="$.size", fix="Choose the size automatically")


def joint_issues(level: Level, placed: list[Placed], broken: set[BodyReference]) -> Iterator[Issue]:
    """Yield joints that do nothing, are drawn apart or turned, senseless limits.

    W205, W207, W209, W213, W215 and W217.
    """
    bodies = {each.reference: each.body for each in placed}
    held = _held(level, placed)
    for k, joint in enumerate(level.joints):
        path, a, b = f"$.joints[{k}]", bodies.get(joint.a), bodies.get(joint.b)
        if a is None or b is None or joint.a == joint.b or joint.id in broken:
            continue
        name = capital(describe(joint.id, joint))
        if a.fixed and b.fixed:
            message = f"{name} between two fixed shapes has no effect."
            yield issue("W207", message, path=path, ids=(joint.id,))
        gap, turn = _misfit(joint, a, b)
        if gap > ANCHOR_TOLERANCE and not (a.fixed and b.fixed):
            message = f"{name}: anchor mismatch {gap:.3g} m, will be pulled together."
            yield issue("W209", message, path=path, ids=(joint.id,), fix="Re-anchor")
        if joint.kind == "revolute":
            yield from _limit_issues(joint, path)
            if not (a.fixed and b.fixed):
                yield from _excluded_issues(joint, name, turn, path)
                if joint.a in held and held[joint.a] == held.get(joint.b):
                    message = f"{name} cannot turn: its shapes are welded together."
                    yield issue("W217", message, path=path, ids=(joint.id,), fix="Delete")
            continue
        if abs(turn) > ANGLE_TOLERANCE and not (a.fixed and b.fixed):
            degrees = f"{abs(math.degrees(turn)):.3g}°"
            message = f"{name}: drawn {degrees} from the angle that it holds, will be turned there."
            yield issue("W213", message, path=path, ids=(joint.id,), fix="Hold as drawn")


def _limit_issues(joint: Joint, path: str) -> Iterator[Issue]:
    limits = joint.limits
    if limits is None or not limits.on:
        return
    path = f"{path}.limits"
    if limits.min > limits.max:
        message = f"Joint {joint.id}: the limits are swapped, min > max."
        yield issue("W205", message, path=path, ids=(joint.id,), fix="Swap limits")
    elif limits.max - limits.min >= 2 * math.pi:
        message = f"Joint {joint.id}: the limits span 360° or more."
        yield issue("W205", message, path=path, ids=(joint.id,), fix="Switch limits off")


def _excluded_issues(joint: Joint, name: str, turn: float, path: str) -> Iterator[Issue]:
    """Report a hinge drawn outside its limits; the engine sorts limits and counts whole turns.

    Args:
        joint: A hinge.
        name: What it is called.
        turn: The drawn angle from its reference angle [rad].
        path: Of the joint.
    """
    limits = joint.limits
    if limits is None or not limits.on:
        return
    outside = max(min(limits.min, limits.max) - turn, turn - max(limits.min, limits.max))
    if outside > LIMIT_TOLERANCE:
        degrees = f"{math.degrees(outside):.3g}°"
        message = f"{name}: drawn {degrees} outside its limits, will be turned there."
        yield issue("W215", message, path=f"{path}.limits", ids=(joint.id,), fix="Widen limits")


def control_issues(level: Level) -> Iterator[Issue]:
    """Yield motors and thrusters without power, and that nothing can be controlled.

    W201 and W208, and W207 of thrusters on fixed bodies.
    """
    fixed = {*ARENA_NAMES, *(body.id for body in level.bodies if body.fixed)}
    controlled = False
    for k, joint in enumerate(level.joints):
        motor = joint.motor
        if motor is None or not motor.on or joint.kind == "fixed":
            continue
        idle = [name for name in ("speed", "power") if getattr(motor, name) == 0]
        if idle:
            message = f"{capital(describe(joint.id, joint))}: motor {' and '.join(idle)} 0."
            yield issue("W208", message, path=f"$.joints[{k}].motor", ids=(joint.id,))
        elif not fixed.issuperset((joint.a, joint.b)):
            controlled = controlled or not motor.auto
    for k, thruster in enumerate(level.thrusters):
        path, name = f"$.thrusters[{k}]", capital(describe(thruster.id, thruster))
        if thruster.power == 0:
            yield issue("W208", f"{name}: power 0.", path=f"{path}.power", ids=(thruster.id,))
        if thruster.body in fixed:
            message = f"{name} on a fixed shape has no effect."
            yield issue("W207", message, path=path, ids=(thruster.id,), fix="Delete")
        elif thruster.power > 0:
            controlled = True
    if not controlled:
        message = "Nothing is controllable (no powered motor or thruster that moves a shape)."
        yield issue("W201", message)
