"""Selects and moves: decides at the press which gesture begins."""

import dataclasses
import math
from typing import Final

from editor.base.events import Point, Pointer, PointerEvent
from editor.base.overlay import Cursor, Handle, HandleKind
from editor.documents.commands.base import EntityId, Selection
from editor.documents.commands.rigid import component
from editor.editing import gauges
from editor.editing.picking import HANDLE_PIXELS, PICK_PIXELS, handles, pick_handle, stack
from editor.editing.tools.base import Feedback, Gesture, Tool, ToolContext, is_drag
from editor.editing.tools.select.box import rubber_band
from editor.editing.tools.select.drag import drag_bodies, drag_joint, drag_thruster
from editor.editing.tools.select.gauge import adjust
from editor.editing.tools.select.resize import resize
from editor.editing.tools.select.rotate import aim, rotate_bodies

CYCLE_PIXELS: Final = 4.0
CYCLE_SECONDS: Final = 0.6
"""A second click this near [px at 100 %] and this soon [s] goes one deeper into the stack."""

_ONE_AT_A_TIME: Final = "Joints and thrusters are dragged one at a time: select one alone."

_CURSORS: Final = {
    HandleKind.ROTATE: Cursor.ROTATE,
    HandleKind.AIM: Cursor.ROTATE,
    **dict.fromkeys(gauges.KINDS, Cursor.MOVE),
}

_HINTS: Final = {
    HandleKind.LIMIT_MIN: "Drag: least angle of the joint. Ctrl: any angle, or type degrees.",
    HandleKind.LIMIT_MAX: "Drag: greatest angle of the joint. Ctrl: any angle, or type degrees.",
    HandleKind.MOTOR: "Drag: speed of the motor. Ctrl: any speed, or type one.",
    HandleKind.POWER: "Drag: power of the thruster. Ctrl: any power, or type one.",
    HandleKind.VELOCITY: "Drag: velocity at the start. Ctrl: any direction, or type the speed.",
    HandleKind.SPIN: "Drag: spin at the start. Ctrl: any spin, or type rad/s.",
    HandleKind.GRAVITY: "Drag: gravity. Ctrl: any direction, or type m/s².",
}


class SelectTool(Tool):
    """Click to select, drag to move, drag a handle to turn or resize, drag nothing for a band."""

    id = "select"
    label = "Select"
    hint = "Click to select, drag to move. Shift+click adds, click again for what lies below."

    def hover(self, session: ToolContext, event: PointerEvent) -> Feedback:
        """Show what a press would take."""
        handle = _handle_at(session, event)
        if handle is not None:
            hint = _HINTS.get(handle.kind, "")
            return Feedback(cursor=_CURSORS.get(handle.kind, Cursor.RESIZE), hint=hint)
        under = under_pointer(session, event)
        session.hovered = under[0] if under else None
        return Feedback(cursor=Cursor.MOVE if under else Cursor.ARROW)

    def press(self, session: ToolContext, event: PointerEvent) -> Gesture:
        """Begin the gesture that fits what lies under the pointer."""
        handle = _handle_at(session, event)
        under = under_pointer(session, event)
        if handle is not None:
            return self._click_or_handle(session, event, handle, under)
        if not under:
            return rubber_band(session, event)
        return self._click_or_drag(session, event, under)

    def _click_or_handle(
        self, session: ToolContext, press: PointerEvent, handle: Handle, under: Selection
    ) -> Gesture:
        """Drag a handle; a click on one selects what lies under it, as anywhere else."""
        before = session.selection
        feedback = Feedback(cursor=_CURSORS.get(handle.kind, Cursor.RESIZE))
        while True:
            event = yield feedback
            if event.kind is Pointer.RELEASE:
                if under:
                    self._clicked(session, press, under, before)
                return None
            if is_drag(session, press.screen, event.screen):
                break
        # The handle keeps its distance to the pointer: taking it beside its middle moves nothing.
        offset = (handle.at[0] - press.world[0], handle.at[1] - press.world[1])
        if handle.kind is HandleKind.ROTATE:
            gesture = rotate_bodies(session, dataclasses.replace(press, world=handle.at))
        elif handle.kind is HandleKind.AIM:
            gesture = aim(session)
        elif handle.kind in gauges.KINDS:
            gesture = adjust(session, handle)
        else:
            gesture = resize(session, handle)
        return (yield from _forwarded(gesture, event, offset))

    def _click_or_drag(
        self, session: ToolContext, event: PointerEvent, under: Selection
    ) -> Gesture:
        press = event
        before = session.selection
        taken = next((i for i in under if i in before), under[0])
        if taken not in before and not (press.modifiers.shift or press.modifiers.alt):
            session.selection = (taken,)
        feedback = Feedback(cursor=Cursor.MOVE)
        while True:
            event = yield feedback
            if event.kind is Pointer.RELEASE:
                self._clicked(session, press, under, before)
                return None
            if is_drag(session, press.screen, event.screen):
                break
        if taken not in session.selection:
            session.selection = (*before, taken) if press.modifiers.shift else (taken,)
        dragging = begin_drag(session, press, taken)
        if dragging is None:
            arena = isinstance(taken, str)
            session.complain("Floor, walls and ceiling do not move." if arena else _ONE_AT_A_TIME)
            return None
        return (yield from _forwarded(dragging, event, (0.0, 0.0)))

    def _clicked(
        self, session: ToolContext, press: PointerEvent, under: Selection, before: Selection
    ) -> None:
        last, session.last_click = session.last_click, press
        if press.modifiers.shift:
            top = under[0]
            without = tuple(i for i in before if i != top)
            session.selection = without if top in before else (*before, top)
            return
        again = (
            last is not None
            and math.dist(last.screen, press.screen) <= CYCLE_PIXELS * session.view.scale
            and press.time - last.time <= CYCLE_SECONDS
        )
        if (again or press.modifiers.alt) and len(before) == 1 and before[0] in under:
            deeper = (under.index(before[0]) + 1) % len(under)
            session.selection = (under[deeper],)
        else:
            session.selection = (under[0],)


def _forwarded(gesture: Gesture, event: PointerEvent, offset: Point) -> Gesture:
    """Hand the events of a drag that has begun on to its gesture, shifted in the world."""
    next(gesture)
    try:
        while True:
            world = (event.world[0] + offset[0], event.world[1] + offset[1])
            event = yield gesture.send(dataclasses.replace(event, world=world))
    except StopIteration as finished:
        return finished.value
    finally:
        gesture.close()


def begin_drag(session: ToolContext, press: PointerEvent, taken: EntityId) -> Gesture | None:
    """Return the drag of what was taken: a joint, a thruster, or bodies with all joined to them."""
    level = session.document.level
    alone = len(session.selection) == 1
    if alone and any(joint.id == taken for joint in level.joints):
        return drag_joint(session, press, int(taken))
    if alone and any(thruster.id == taken for thruster in level.thrusters):
        return drag_thruster(session, press, int(taken))
    ids = {body.id for body in level.bodies if body.id in session.document.unlocked}
    if session.settings.move_jointed and not press.modifiers.alt:
        ids = component(level, ids)
    ids -= {i for i in session.document.locked if isinstance(i, int)}
    if not ids:
        return None
    moving = tuple(body.id for body in level.bodies if body.id in ids)
    return drag_bodies(session, press, moving, leader=taken)


def under_pointer(session: ToolContext, event: PointerEvent) -> Selection:
    """Return the selectable entities under the pointer, the uppermost first."""
    document = session.document
    return stack(
        document.level,
        event.world,
        PICK_PIXELS * session.metres,
        without=document.locked | document.hidden,
        arena=session.view.edit_arena,
    )


def _handle_at(session: ToolContext, event: PointerEvent) -> Handle | None:
    document, metres = session.document, session.metres
    level, selection = document.level, document.unlocked
    available = handles(level, selection, metres)
    found = pick_handle(available, event.world, HANDLE_PIXELS * metres)
    return found or pick_handle(
        gauges.handles_of(level, selection, metres), event.world, HANDLE_PIXELS * metres
    )
