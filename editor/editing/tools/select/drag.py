"""Drags of what is selected: bodies, a joint's anchor, a thruster's place."""

import math
from typing import Any, Final

from editor.base.events import Point, Pointer, PointerEvent
from editor.base.overlay import Cursor, Label, Mark
from editor.documents.commands.base import EntityId
from editor.documents.commands.bodies import PLACE_DECIMALS
from editor.documents.commands.group import Move
from editor.documents.commands.joints import MoveJoint, RehangJoint
from editor.documents.commands.thrusters import PlaceThruster
from editor.editing.picking import bodies_at
from editor.editing.snapping import measured, snap_point, snap_shift
from editor.editing.tools.base import Feedback, Gesture, ToolContext
from editor.editing.tools.joint import pair_marks
from editor.editing.tools.thruster import NO_BODY
from kinetix.errors import CommandError

_ON_THE_EDGE: Final = 1e-4
"""A thruster that was snapped to an edge may lie this far outside by rounding [m]."""


def drag_bodies(
    session: ToolContext, press: PointerEvent, ids: tuple[int, ...], *, leader: EntityId
) -> Gesture:
    """Move bodies: Shift keeps to one axis, Ctrl inverts snapping, typed numbers are the shift.

    Args:
        session: The app.
        press: Where the drag began.
        ids: The bodies that move.
        leader: What was grabbed; its centre is what the grid takes.
    """
    level = session.document.level
    bodies = [body for body in level.bodies if body.id in ids]
    bodies.sort(key=lambda body: (body.id != leader, body.id not in session.selection))
    available = session.targets(ids)
    snapped, command = None, None
    feedback = Feedback(cursor=Cursor.MOVE)
    while True:
        event = yield feedback
        shift = (event.world[0] - press.world[0], event.world[1] - press.world[1])
        if event.modifiers.shift:
            shift = (shift[0], 0.0) if abs(shift[0]) >= abs(shift[1]) else (0.0, shift[1])
        snapped = snap_shift(bodies, shift, session.rules(event.modifiers), available, snapped)
        dx, dy = (round(value, PLACE_DECIMALS) for value in snapped.point)
        if event.modifiers.shift:
            dx, dy = (dx, 0.0) if shift[1] == 0.0 else (0.0, dy)
        if event.typed:
            dx, dy = _typed_shift(event.typed, shift)
        command = Move(ids=ids, shift=(dx, dy))
        if event.kind is Pointer.RELEASE:
            return command
        label = Label(at=event.world, text=f"{dx:+.2f}, {dy:+.2f} m")
        feedback = Feedback(
            command=command, marks=(*measured(snapped.guides), label), cursor=Cursor.MOVE
        )


def _typed_shift(typed: tuple[float, ...], dragged: Point) -> Point:
    """Return the shift that was typed: along the longer axis of the drag, or in x and y [m].

    A single number goes the way of the drag; with a minus it goes left or down.
    """
    number, *others = typed
    if others:
        return number, others[0]
    axis = 0 if abs(dragged[0]) >= abs(dragged[1]) else 1
    amount = min(number, math.copysign(number, dragged[axis]))
    return (amount, 0.0) if axis == 0 else (0.0, amount)


def drag_joint(session: ToolContext, press: PointerEvent, joint: int) -> Gesture:
    """Move a joint's anchor; dropped where other bodies lie over each other, it joins those."""
    del press
    available, snapped = session.targets(), None
    feedback = Feedback(cursor=Cursor.MOVE)
    while True:
        event = yield feedback
        snapped = snap_point(event.world, session.rules(event.modifiers), available, snapped)
        command = _joint_at(session, joint, snapped.point)
        if event.kind is Pointer.RELEASE:
            return command
        marks: tuple[Mark, ...] = measured(snapped.guides)
        if isinstance(command, RehangJoint):
            names = " and ".join(session.document.name_of(body) for body in command.bodies)
            pair = pair_marks(session.document.level, command.bodies, command.point)
            marks = (*marks, *pair, Label(at=event.world, text=f"joins {names}"))
        feedback = Feedback(command=command, marks=marks, cursor=Cursor.MOVE)


def _joint_at(session: ToolContext, joint_id: int, point: Point) -> MoveJoint | RehangJoint:
    """Return the edit that puts a joint at a point: on its bodies while they reach there.

    Raises:
        CommandError: The joint has been deleted meanwhile.
    """
    level = session.document.level
    joint = next((joint for joint in level.joints if joint.id == joint_id), None)
    if joint is None:
        raise CommandError("The joint that was dragged is gone.")
    hidden = session.document.hidden
    under = [body for body in bodies_at(level, point) if body not in hidden]
    kept = [end for end in (joint.a, joint.b) if end in under]
    if len(kept) == 2 or len(under) < 2:
        return MoveJoint(joint=joint_id, point=point)
    others = [body for body in under if body not in kept]
    first, second = [*kept, *others][:2]
    if isinstance(first, str) and isinstance(second, str):
        return MoveJoint(joint=joint_id, point=point)
    bodies: Any = (first, second)
    return RehangJoint(joint=joint_id, bodies=bodies, point=point)


def drag_thruster(session: ToolContext, press: PointerEvent, thruster: int) -> Gesture:
    """Move a thruster on its body or to another one; beside all bodies it stays where it was last.

    Args:
        session: The app.
        press: Where the drag began.
        thruster: The one that moves.
    """
    del press
    level = session.document.level
    own = next(each.body for each in level.thrusters if each.id == thruster)
    available, snapped, command = session.targets(), None, None
    feedback = Feedback(cursor=Cursor.MOVE)
    while True:
        event = yield feedback
        snapped = snap_point(event.world, session.rules(event.modifiers), available, snapped)
        body = _body_under(session, snapped.point, own)
        marks: tuple[Mark, ...] = measured(snapped.guides)
        if body is not None:
            command = PlaceThruster(thruster=thruster, point=snapped.point, body=body)
            if body != own:
                name = session.document.name_of(body)
                marks = (*marks, Label(at=event.world, text=f"pushes {name}"))
        if event.kind is Pointer.RELEASE:
            return command
        feedback = (
            Feedback(command=command, hint=NO_BODY, cursor=Cursor.REFUSED)
            if body is None
            else Feedback(command=command, marks=marks, cursor=Cursor.MOVE)
        )


def _body_under(session: ToolContext, point: Point, own: int) -> int | None:
    """Return the body that a thruster at a point pushes: its own while that reaches there."""
    document = session.document
    under = bodies_at(
        document.level, point, without=document.hidden, arena=False, margin=_ON_THE_EDGE
    )
    return own if own in under else int(under[0]) if under else None
