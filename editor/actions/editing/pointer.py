"""The pointer on the canvas: pan, zoom, gestures, the stack's menu, pulling bodies."""

import dataclasses
from typing import Final

from editor.actions.editing import context
from editor.base.camera import ZOOM_NOTCH
from editor.base.controls import NOOP
from editor.base.events import LEFT, MIDDLE, RIGHT, PinchEvent, Pointer, PointerEvent, WheelEvent
from editor.editing.picking import bodies_at
from editor.editing.tools.base import is_drag
from editor.play.mode import Mode
from editor.session import Session
from editor.worker.requests import Pull
from kinetix.level.geometry import to_local

PAN_NOTCH: Final = 30.0
"""Distance panned per notch of the wheel [px]."""
_MOST_NOTCHES: Final = 100.0
"""A wheel that reports more than this in one frame is broken."""
PAN_BUTTONS: Final = (MIDDLE, RIGHT)


def use_pointer(session: Session, event: PointerEvent, table: context.Table) -> None:
    """Give a pointer event to whom it concerns.

    Args:
        session: The app.
        event: The event.
        table: The action table, for the menu of a right click.
    """
    session.hands.cursor, session.hands.cursor_screen = event.world, event.screen
    session.hands.modifiers = event.modifiers
    if _panned(session, event, table):
        return
    if event.button not in (0, LEFT):
        return
    if session.editing:
        session.driver.pointer(event)
    else:
        _pull(session, event)


def move_wheel(session: Session, event: WheelEvent) -> None:
    """Zoom at the pointer or pan, as the settings say; Ctrl always zooms, sideways always pans."""
    settings = session.settings
    dy = min(max(event.dy, -_MOST_NOTCHES), _MOST_NOTCHES)
    dy = -dy if settings.wheel_inverted else dy
    pans = settings.wheel == "pan" and not event.modifiers.ctrl
    if dy and not pans:
        session.camera = session.camera.zoomed(ZOOM_NOTCH**dy, event.screen)
    down = PAN_NOTCH * dy if pans else 0.0
    if event.dx or down:
        session.camera = session.camera.panned((-PAN_NOTCH * event.dx, down))


def pinch(session: Session, event: PinchEvent) -> None:
    """Zoom with two fingers, at the place between them."""
    if not session.settings.pinch or session.gallery.open or session.prompts:
        return
    (left, top), (width, height) = session.camera.origin, session.camera.size
    x, y = event.screen
    if 0 <= x - left <= width and 0 <= y - top <= height:
        session.camera = session.camera.zoomed(event.factor, event.screen)


def _panned(session: Session, event: PointerEvent, table: context.Table) -> bool:
    """Pan by a middle or right drag; a right click opens the menu of the place."""
    if event.kind is Pointer.PRESS and event.button in PAN_BUTTONS and not session.driver.active:
        session.hands.pan = (event.screen, event.screen, False)
        return True
    if session.hands.pan is None:
        return False
    start, last, moved = session.hands.pan
    if event.kind is Pointer.MOVE:
        moved = moved or is_drag(session, start, event.screen)
        if moved:
            delta = (event.screen[0] - last[0], event.screen[1] - last[1])
            session.camera = session.camera.panned(delta)
            last = event.screen
        session.hands.pan = (start, last, moved)
    elif event.kind is Pointer.RELEASE:
        session.hands.pan = None
        if not moved and event.button == RIGHT and session.editing:
            context.open_menu(session, event, table)
    return True


def _pull(session: Session, event: PointerEvent) -> None:
    """Hold a simulated body with the mouse."""
    if event.kind is Pointer.PRESS and session.playback.snapshot is not None:
        level = session.scene
        under = bodies_at(level, event.world, arena=False)
        free = [i for i in under if isinstance(i, int) and not level.body(i).fixed]
        if free:
            anchor = to_local(level.body(free[0]), event.world)
            session.hands.pull = Pull(body=free[0], anchor=anchor, target=event.world)
    elif event.kind is Pointer.MOVE and session.hands.pull is not None:
        paused = session.mode is Mode.PAUSED
        session.hands.pull = dataclasses.replace(
            session.hands.pull, target=event.world, teleport=paused and event.modifiers.ctrl
        )
    elif event.kind is Pointer.RELEASE and session.hands.pull is not None:
        if session.hands.pull.teleport:
            session.playback.step(NOOP, session.hands.pull)
        session.hands.pull = None
