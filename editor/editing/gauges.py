"""Quantities of what is selected that can be dragged on the canvas: where their handles stand.

A joint's limits are a wedge and its motor's speed an arc; a thruster's power is a length; velocity,
spin and gravity are arrows. Each has a pair of functions: from the value to a place, and back.
"""

import math
from typing import Final

from editor.base.overlay import Arc, Handle, HandleKind, Line, Mark, Style
from editor.editing.picking import joint_position, reach, selected_bodies, thruster_position
from kinetix.level.geometry import referenced_body
from kinetix.level.model import Body, Joint, Level, Limits, Point, Thruster

Selection = tuple[int | str, ...]

KINDS: Final = frozenset(
    {
        HandleKind.LIMIT_MIN,
        HandleKind.LIMIT_MAX,
        HandleKind.MOTOR,
        HandleKind.POWER,
        HandleKind.VELOCITY,
        HandleKind.SPIN,
        HandleKind.GRAVITY,
    }
)
"""Kinds of handles that this module places."""

WEDGE_PIXELS: Final = 40.0
"""Radius of the wedge of a joint's limits [px at 100 %]."""
MOTOR_PIXELS: Final = 58.0
"""Radius of the arc of a motor's speed [px at 100 %]."""
MOTOR_SWEEP: Final = math.radians(50.0)
"""Angle of the arc at speed 1 [rad]; it begins upwards."""
POWER_BASE: Final = 22.0
POWER_PIXELS: Final = 30.0
"""A thruster's bar is that long at power 0, and this much longer at power 1 [px at 100 %]."""
VELOCITY_SECONDS: Final = 0.15
"""A velocity's arrow is as long as the way in this time."""
CLEAR_PIXELS: Final = 24.0
"""Distance of a body's arrows from its outline [px at 100 %]."""
SPIN_SWEEP: Final = math.radians(8.0)
"""Angle of the arc at 1 rad/s [rad]; it begins at the upper left."""
SPIN_START: Final = math.radians(135.0)
REST_DIRECTION: Final = math.radians(-45.0)
"""Direction of the handle of a body at rest [rad]."""
GRAVITY_AT: Final[Point] = (0.5, 4.5)
"""Start of the arrow of gravity [m]."""
GRAVITY_METRES: Final = 0.04
"""Its length at 1 m/s² [m]."""


def off(origin: Point, angle: float, length: float) -> Point:
    """Return the point at a direction [rad] and distance [m]."""
    return origin[0] + length * math.cos(angle), origin[1] + length * math.sin(angle)


def limit_base(level: Level, joint: Joint) -> float:
    """Return the direction in the world that a joint's angle 0 has [rad]."""
    return referenced_body(level, joint.a).angle + joint.reference_angle


def clearance(body: Body, metres: float) -> float:
    """Return how far from its place the arrows of a body begin [m]."""
    return reach(body) + CLEAR_PIXELS * metres


def power_length(power: float, metres: float) -> float:
    """Return the length of a thruster's bar [m]; the root keeps weak and strong ones in sight."""
    return (POWER_BASE + POWER_PIXELS * math.sqrt(max(power, 0.0))) * metres


def power_of(length: float, metres: float) -> float:
    """Return the power that a bar of that length [m] means."""
    return (max(length / metres - POWER_BASE, 0.0) / POWER_PIXELS) ** 2


def handles_of(level: Level, selection: Selection, metres: float) -> tuple[Handle, ...]:
    """Return the handles of the quantities of one selected thing; of gravity when there is none.

    Gravity has one only where there is something that it pulls.

    Args:
        level: Where it is.
        selection: What is selected.
        metres: Width of a pixel at 100 % [m].
    """
    if not selection:
        if not level.bodies:
            return ()
        gx, gy = level.gravity
        tip = (GRAVITY_AT[0] + gx * GRAVITY_METRES, GRAVITY_AT[1] + gy * GRAVITY_METRES)
        return (Handle(kind=HandleKind.GRAVITY, at=tip),)
    if len(selection) != 1:
        return ()
    for joint in level.joints:
        if joint.id == selection[0]:
            return _joint_handles(level, joint, metres)
    for thruster in level.thrusters:
        if thruster.id == selection[0]:
            return (_power_handle(level, thruster, metres),)
    bodies = selected_bodies(level, selection)
    return _body_handles(bodies[0], metres) if bodies and not bodies[0].fixed else ()


def _joint_handles(level: Level, joint: Joint, metres: float) -> tuple[Handle, ...]:
    if joint.kind == "fixed":
        return ()
    at, found = joint_position(level, joint), []
    if joint.limits is not None and joint.limits.on:
        base, radius = limit_base(level, joint), WEDGE_PIXELS * metres
        low, high = base + joint.limits.min, base + joint.limits.max
        found += [
            Handle(kind=HandleKind.LIMIT_MIN, at=off(at, low, radius)),
            Handle(kind=HandleKind.LIMIT_MAX, at=off(at, high, radius)),
        ]
    if joint.motor is not None and joint.motor.on:
        angle = math.pi / 2 + joint.motor.speed * MOTOR_SWEEP
        found.append(Handle(kind=HandleKind.MOTOR, at=off(at, angle, MOTOR_PIXELS * metres)))
    return tuple(found)


def thruster_direction(level: Level, thruster: Thruster) -> float:
    """Return where a thruster pushes, in the world [rad]."""
    return level.body(thruster.body).angle + thruster.angle


def _power_handle(level: Level, thruster: Thruster, metres: float) -> Handle:
    back = thruster_direction(level, thruster) + math.pi
    at = off(thruster_position(level, thruster), back, power_length(thruster.power, metres))
    return Handle(kind=HandleKind.POWER, at=at)


def _body_handles(body: Body, metres: float) -> tuple[Handle, ...]:
    clear = clearance(body, metres)
    speed = math.hypot(*body.velocity)
    moves = speed > 1e-6
    direction = math.atan2(body.velocity[1], body.velocity[0]) if moves else REST_DIRECTION
    tip = off(body.position, direction, clear + speed * VELOCITY_SECONDS)
    spin = SPIN_START + body.angular_velocity * SPIN_SWEEP
    return (
        Handle(kind=HandleKind.VELOCITY, at=tip),
        Handle(kind=HandleKind.SPIN, at=off(body.position, spin, clear)),
    )


def marks_of(level: Level, selection: Selection, metres: float) -> tuple[Mark, ...]:
    """Return what is drawn under the handles: wedge, arcs, arrows.

    Args:
        level: Where the selected thing is, a preview included.
        selection: What is selected.
        metres: Width of a pixel at 100 % [m].
    """
    places = {handle.kind: handle.at for handle in handles_of(level, selection, metres)}
    marks: list[Mark] = []
    if HandleKind.GRAVITY in places:
        tip = places[HandleKind.GRAVITY]
        marks.append(Line(a=GRAVITY_AT, b=tip, style=Style.QUANTITY, arrow=True))
    joint = next((j for j in level.joints if selection[:1] == (j.id,)), None)
    if joint is not None and places:
        marks += _joint_marks(level, joint, metres)
    for thruster in level.thrusters:
        if HandleKind.POWER in places and thruster.id == selection[0]:
            at = thruster_position(level, thruster)
            marks.append(Line(a=at, b=places[HandleKind.POWER], style=Style.FORCE))
    bodies = selected_bodies(level, selection)
    if bodies and HandleKind.VELOCITY in places:
        marks += _body_marks(bodies[0], places[HandleKind.VELOCITY], metres)
    return tuple(marks)


def _joint_marks(level: Level, joint: Joint, metres: float) -> list[Mark]:
    at, marks = joint_position(level, joint), []
    limits = joint.limits or Limits(on=False)
    if limits.on:
        base = limit_base(level, joint)
        radius = WEDGE_PIXELS * metres
        now = referenced_body(level, joint.b).angle
        inside = limits.min - 1e-6 <= now - base <= limits.max + 1e-6
        marks.append(
            Arc(
                centre=at,
                radius=radius,
                start=base + limits.min,
                end=base + limits.max,
                style=Style.QUANTITY,
                filled=True,
            )
        )
        style = Style.QUANTITY if inside else Style.REFUSED
        marks.append(Line(a=at, b=off(at, now, radius), style=style))
    if joint.motor is not None and joint.motor.on:
        end = math.pi / 2 + joint.motor.speed * MOTOR_SWEEP
        radius = MOTOR_PIXELS * metres
        marks.append(Arc(centre=at, radius=radius, start=math.pi / 2, end=end, style=Style.FORCE))
    return marks


def _body_marks(body: Body, tip: Point, metres: float) -> list[Mark]:
    clear, marks = clearance(body, metres), []
    if math.hypot(*body.velocity) > 1e-6:
        angle = math.atan2(body.velocity[1], body.velocity[0])
        start = off(body.position, angle, clear)
        marks.append(Line(a=start, b=tip, style=Style.QUANTITY, arrow=True))
    if abs(body.angular_velocity) > 1e-6:
        end = SPIN_START + body.angular_velocity * SPIN_SWEEP
        marks.append(
            Arc(
                centre=body.position,
                radius=clear,
                start=SPIN_START,
                end=end,
                style=Style.QUANTITY,
            )
        )
    return marks
