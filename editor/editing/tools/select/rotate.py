"""Turning: the rotation handle of bodies and the direction of a thruster."""

import math
from typing import Final

from editor.base.events import Pointer, PointerEvent
from editor.base.overlay import Cursor, Label, Line, Style
from editor.documents.commands.group import Rotate, centroid
from editor.documents.commands.thrusters import PlaceThruster
from editor.editing.picking import selected_bodies, thruster_position
from editor.editing.snapping import snap_angle
from editor.editing.tools.base import Feedback, Gesture, ToolContext
from editor.editing.tools.thruster import aimed

FINE_STEP: Final = math.radians(1.0)
"""Step of the angle with Shift."""


def rotate_bodies(session: ToolContext, press: PointerEvent) -> Gesture:
    """Turn the selected bodies about their centroid; Shift: 1° steps, Ctrl: any angle."""
    bodies = list(selected_bodies(session.document.level, session.document.unlocked))
    ids = tuple(body.id for body in bodies)
    pivot = centroid(bodies)
    start = math.atan2(press.world[1] - pivot[1], press.world[0] - pivot[0])
    # One body turns to round angles, a group by round angles.
    first = bodies[0].angle if len(bodies) == 1 else 0.0
    feedback = Feedback(cursor=Cursor.ROTATE)
    while True:
        event = yield feedback
        now = math.atan2(event.world[1] - pivot[1], event.world[0] - pivot[0])
        angle = first + math.remainder(now - start, math.tau)
        if not event.modifiers.ctrl:
            step = FINE_STEP if event.modifiers.shift else session.angle_step
            angle = snap_angle(angle, step)
        if event.typed:
            angle = math.radians(event.typed[0])
        # Never more than half a turn, so that a body's angle stays near what it was.
        turn = math.remainder(angle - first, math.tau)
        command = Rotate(ids=ids, angle=turn, pivot=pivot)
        if event.kind is Pointer.RELEASE:
            return command
        label = Label(at=event.world, text=f"{math.degrees(first + turn):.0f}°")
        line = Line(a=pivot, b=event.world, style=Style.GUIDE)
        feedback = Feedback(command=command, marks=(line, label), cursor=Cursor.ROTATE)


def aim(session: ToolContext) -> Gesture:
    """Turn the selected thruster."""
    level = session.document.level
    thruster = next(t for t in level.thrusters if t.id in session.document.unlocked)
    body, point = level.body(thruster.body), thruster_position(level, thruster)
    feedback = Feedback(cursor=Cursor.ROTATE)
    while True:
        event = yield feedback
        step = None if event.modifiers.ctrl else session.angle_step
        direction = aimed(body, point, event.world, step=step)
        if event.typed:
            direction = math.radians(event.typed[0])
        command = PlaceThruster(thruster=thruster.id, direction=direction)
        if event.kind is Pointer.RELEASE:
            return command
        degrees = math.degrees(math.remainder(direction, math.tau))
        label = Label(at=event.world, text=f"{degrees:.0f}°")
        feedback = Feedback(command=command, marks=(label,), cursor=Cursor.ROTATE)
