"""Drags of quantities: a joint's limits and motor speed, power, velocity, spin, gravity."""

import math
from collections.abc import Callable
from typing import Final

from editor.base.events import Pointer, PointerEvent
from editor.base.overlay import Cursor, Handle, HandleKind, Label
from editor.documents.commands.base import Command
from editor.documents.commands.fields import SetField, SetLevelField
from editor.editing import gauges
from editor.editing.picking import joint_position, thruster_position
from editor.editing.snapping import snap_angle
from editor.editing.tools.base import Feedback, Gesture, ToolContext
from kinetix.level.limits import (
    FASTEST,
    FASTEST_MOTOR,
    FASTEST_SPIN,
    STRONGEST_GRAVITY,
    STRONGEST_THRUSTER,
    WIDEST_LIMIT,
)
from kinetix.level.model import Joint, Level, Limits, Motor

SPEED_STEP: Final = 0.05
POWER_STEP: Final = 0.05
VELOCITY_STEP: Final = 0.1
"""Step of velocities [m/s]."""
SPIN_STEP: Final = 0.1
"""Step of spins [rad/s]."""
GRAVITY_STEP: Final = 0.1
"""Step of gravity [m/s²]; with Ctrl there are no steps."""
MOTOR_MOST: Final = 3.4
"""Beyond this speed the arc would cover its own beginning."""

_Change = tuple[Command, str]


def adjust(session: ToolContext, handle: Handle) -> Gesture:
    """Drag the handle of a quantity; Ctrl leaves out the rounding, typed numbers are the value."""
    level = session.document.level
    change = _CHANGES[handle.kind]
    feedback = Feedback(cursor=Cursor.MOVE)
    while True:
        event = yield feedback
        command, words = change(session, level, event)
        if event.kind is Pointer.RELEASE:
            return command
        marks = gauges.marks_of(command.apply(level), session.document.unlocked, session.metres)
        label = Label(at=event.world, text=words)
        feedback = Feedback(command=command, marks=(*marks, label), cursor=Cursor.MOVE)


def _rounded(value: float, step: float, event: PointerEvent) -> float:
    return round(value, 6) if event.modifiers.ctrl else round(round(value / step) * step, 6)


def _length(event: PointerEvent, dragged: float, most: float) -> float:
    """Return the length of an arrow: as dragged or typed; where it points, the pointer says."""
    return min(abs(event.typed[0]) if event.typed else dragged, most)


def _joint(session: ToolContext, level: Level) -> Joint:
    return next(joint for joint in level.joints if joint.id == session.document.unlocked[0])


def _limit(which: str) -> Callable[[ToolContext, Level, PointerEvent], _Change]:
    def change(session: ToolContext, level: Level, event: PointerEvent) -> _Change:
        joint = _joint(session, level)
        limits = joint.limits or Limits()
        at = joint_position(level, joint)
        pointed = math.atan2(event.world[1] - at[1], event.world[0] - at[0])
        before = getattr(limits, which)
        turn = math.remainder(pointed - gauges.limit_base(level, joint) - before, math.tau)
        value = before + turn
        # Of two ends at one place the drag's direction says which one is meant.
        together = limits.max - limits.min < 1e-6
        end = ("max" if turn > 0 else "min") if together else which
        if event.typed:
            value = min(max(math.radians(event.typed[0]), -WIDEST_LIMIT), WIDEST_LIMIT)
        elif not event.modifiers.ctrl:
            value = snap_angle(value, session.angle_step)
        value = min(value, limits.max) if end == "min" else max(value, limits.min)
        shown = f"{math.degrees(value):.1f}°"
        command = SetField(ids=(joint.id,), field=f"limits.{end}", value=value, shown=shown)
        return command, f"{end} {shown}"

    return change


def _motor(session: ToolContext, level: Level, event: PointerEvent) -> _Change:
    joint = _joint(session, level)
    motor = joint.motor or Motor()
    at = joint_position(level, joint)
    pointed = math.atan2(event.world[1] - at[1], event.world[0] - at[0]) - math.pi / 2
    before = motor.speed * gauges.MOTOR_SWEEP
    swept = before + math.remainder(pointed - before, math.tau)
    speed = _rounded(swept / gauges.MOTOR_SWEEP, SPEED_STEP, event)
    most = FASTEST_MOTOR if event.typed else MOTOR_MOST
    speed = min(max(event.typed[0] if event.typed else speed, -most), most)
    return SetField(ids=(joint.id,), field="motor.speed", value=speed), f"speed {speed:.2f}"


def _power(session: ToolContext, level: Level, event: PointerEvent) -> _Change:
    thruster = next(t for t in level.thrusters if t.id == session.document.unlocked[0])
    at, back = thruster_position(level, thruster), gauges.thruster_direction(level, thruster)
    along = (at[0] - event.world[0]) * math.cos(back) + (at[1] - event.world[1]) * math.sin(back)
    power = _rounded(gauges.power_of(along, session.metres), POWER_STEP, event)
    power = min(max(event.typed[0] if event.typed else power, 0.0), STRONGEST_THRUSTER)
    return SetField(ids=(thruster.id,), field="power", value=power), f"power {power:.2f}"


def _velocity(session: ToolContext, level: Level, event: PointerEvent) -> _Change:
    body = level.body(int(session.document.unlocked[0]))
    dx, dy = event.world[0] - body.position[0], event.world[1] - body.position[1]
    clear = gauges.clearance(body, session.metres)
    speed = max(math.hypot(dx, dy) - clear, 0.0) / gauges.VELOCITY_SECONDS
    speed = _length(event, _rounded(speed, VELOCITY_STEP, event), FASTEST)
    angle = math.atan2(dy, dx)
    if not event.modifiers.ctrl:
        angle = snap_angle(angle, session.angle_step)
    x, y = round(speed * math.cos(angle), 6), round(speed * math.sin(angle), 6)
    shown = f"{x:.2f}, {y:.2f} m/s"
    command = SetField(ids=(body.id,), field="velocity", value=(x, y), shown=shown)
    return command, f"{speed:.2f} m/s"


def _spin(session: ToolContext, level: Level, event: PointerEvent) -> _Change:
    body = level.body(int(session.document.unlocked[0]))
    at = body.position
    pointed = math.atan2(event.world[1] - at[1], event.world[0] - at[0]) - gauges.SPIN_START
    before = body.angular_velocity * gauges.SPIN_SWEEP
    swept = before + math.remainder(pointed - before, math.tau)
    spin = _rounded(swept / gauges.SPIN_SWEEP, SPIN_STEP, event)
    spin = min(max(event.typed[0] if event.typed else spin, -FASTEST_SPIN), FASTEST_SPIN)
    command = SetField(ids=(body.id,), field="angular_velocity", value=spin)
    return command, f"{spin:.2f} rad/s"


def _gravity(session: ToolContext, level: Level, event: PointerEvent) -> _Change:
    del level
    x = (event.world[0] - gauges.GRAVITY_AT[0]) / gauges.GRAVITY_METRES
    y = (event.world[1] - gauges.GRAVITY_AT[1]) / gauges.GRAVITY_METRES
    dragged = _rounded(math.hypot(x, y), GRAVITY_STEP, event)
    strength = _length(event, dragged, STRONGEST_GRAVITY)
    angle = math.atan2(y, x)
    if not event.modifiers.ctrl:
        angle = snap_angle(angle, session.angle_step)
    x, y = round(strength * math.cos(angle), 6), round(strength * math.sin(angle), 6)
    return SetLevelField(field="gravity", value=(x, y)), f"{x:.2f}, {y:.2f} m/s²"


_CHANGES: Final[dict[HandleKind, Callable[[ToolContext, Level, PointerEvent], _Change]]] = {
    HandleKind.LIMIT_MIN: _limit("min"),
    HandleKind.LIMIT_MAX: _limit("max"),
    HandleKind.MOTOR: _motor,
    HandleKind.POWER: _power,
    HandleKind.VELOCITY: _velocity,
    HandleKind.SPIN: _spin,
    HandleKind.GRAVITY: _gravity,
}
