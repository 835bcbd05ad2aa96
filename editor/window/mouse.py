"""The mouse over the canvas becomes pointer events; a click on a key cap chooses another key."""

from collections.abc import Sequence
from typing import TYPE_CHECKING, Final

from imgui_bundle import imgui

from editor import actions
from editor.actions.editing import context
from editor.base import events
from editor.base.camera import Point
from editor.base.overlay import Cursor
from editor.drawing.key_plates import CapPlace
from editor.editing.picking import bodies_at
from editor.editing.tools.base import is_drag

if TYPE_CHECKING:
    from editor.session import Session

_NOWHERE: Final = (-1e6, -1e6)
_BUTTONS: Final = {events.LEFT: 0, events.RIGHT: 1, events.MIDDLE: 2}
"""Our button numbers to Dear ImGui's."""

_CURSORS: Final = {
    Cursor.ARROW: imgui.MouseCursor_.arrow,
    Cursor.CROSS: imgui.MouseCursor_.arrow,
    Cursor.HAND: imgui.MouseCursor_.hand,
    Cursor.MOVE: imgui.MouseCursor_.resize_all,
    Cursor.ROTATE: imgui.MouseCursor_.hand,
    Cursor.RESIZE: imgui.MouseCursor_.resize_nwse,
    Cursor.REFUSED: imgui.MouseCursor_.not_allowed,
}


class Mouse:
    """Holds what lasts between frames: which buttons are down and where the pointer was."""

    def __init__(self) -> None:
        self._down: list[int] = []
        self._last = (0.0, 0.0)
        self._hovered = False
        self._cap: tuple[int, Point] | None = None
        """The thing whose key cap is being clicked, and where."""

    @property
    def dragging(self) -> bool:
        """True if a button went down over the canvas and is down still."""
        return bool(self._down) or self._cap is not None

    def take(self, session: "Session", caps: Sequence[CapPlace], *, hovered: bool) -> None:
        """Make pointer events of Dear ImGui's mouse; a drag goes on outside the canvas."""
        io = imgui.get_io()
        gone = not imgui.is_mouse_pos_valid()
        # What is dragged out of the window stays at its edge until the pointer comes back.
        mouse = self._last if gone and self._down else (io.mouse_pos.x, io.mouse_pos.y)
        self._hovered = hovered
        inside = self._hovered or bool(self._down)
        if self._hovered and (io.mouse_wheel or io.mouse_wheel_h):
            actions.handle(
                session,
                events.WheelEvent(
                    dx=io.mouse_wheel_h,
                    dy=io.mouse_wheel,
                    screen=mouse,
                    modifiers=_modifiers(),
                ),
            )
        if self._on_cap(session, mouse, caps):
            return
        if session.editing and not session.driver.active and not self._down:
            # Every frame, as what lies under a resting pointer may change: handles follow.
            self._pointer(session, events.Pointer.MOVE, mouse if inside else _NOWHERE, 0)
        elif inside and mouse != self._last:
            self._pointer(session, events.Pointer.MOVE, mouse, self._down[0] if self._down else 0)
        for button, theirs in _BUTTONS.items():
            if imgui.is_mouse_clicked(theirs) and self._hovered:
                self._down.append(button)
                self._pointer(session, events.Pointer.PRESS, mouse, button)
            elif button in self._down and not imgui.is_mouse_down(theirs):
                self._down.remove(button)
                self._pointer(session, events.Pointer.RELEASE, mouse, button)
        if not inside:
            session.hands.cursor = None
        self._last = mouse
        if self._hovered and session.editing:
            imgui.set_mouse_cursor(_CURSORS[session.driver.feedback.cursor].value)

    def _on_cap(self, session: "Session", mouse: Point, caps: Sequence[CapPlace]) -> bool:
        """Let a click on a key cap choose another key; whether the mouse is the cap's.

        A drag that begins there is the tool's, and so is all that happens on a cap over a shape:
        there the caps of what is selected alone are clicked.
        """
        if self._cap is not None:
            entity, start = self._cap
            there = session.editing and any(cap.entity == entity for cap in caps)
            return self._click_cap(session, mouse, entity, start, there=there)
        free = session.editing and session.tool.id == "select" and not session.driver.active
        if not (free and self._hovered and not self._down and session.settings.key_caps):
            return False
        found = next((cap for cap in caps if _inside(mouse, cap.low, cap.high)), None)
        if found is None:
            return False
        world = session.camera.to_world(mouse)
        without = session.document.locked | session.document.hidden
        shapes = bodies_at(session.scene, world, without=without, arena=False)
        if shapes and found.entity not in session.selection:
            return False
        session.hovered, self._last = found.entity, mouse
        session.hands.cursor = world
        imgui.set_mouse_cursor(imgui.MouseCursor_.hand.value)
        if imgui.is_mouse_clicked(0):
            self._cap = (found.entity, mouse)
        return not any(imgui.is_mouse_clicked(button) for button in (1, 2))

    def _click_cap(
        self, session: "Session", mouse: Point, entity: int, start: Point, *, there: bool
    ) -> bool:
        """Wait for the release of a press on a cap; one that is dragged becomes the tool's."""
        if not there:
            self._cap = None
            return False
        if is_drag(session, start, mouse):
            self._cap = None
            self._down.append(events.LEFT)
            self._pointer(session, events.Pointer.PRESS, start, events.LEFT)
            return False
        if not imgui.is_mouse_down(0):
            self._cap = None
            session.queue(lambda: context.ask_key(session, entity, start))
        return True

    def _pointer(
        self, session: "Session", kind: events.Pointer, mouse: tuple[float, float], button: int
    ) -> None:
        event = events.PointerEvent(
            kind=kind,
            world=session.camera.to_world(mouse),
            screen=mouse,
            button=button,
            modifiers=_modifiers(),
            time=session.time,
        )
        actions.handle(session, event)


def _inside(point: Point, low: Point, high: Point) -> bool:
    return low[0] <= point[0] <= high[0] and low[1] <= point[1] <= high[1]


def _modifiers() -> events.Modifiers:
    io = imgui.get_io()
    return events.Modifiers(ctrl=io.key_ctrl, shift=io.key_shift, alt=io.key_alt)
