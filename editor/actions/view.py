"""Actions of the View and Tools menus: camera, switches, tools."""

import dataclasses
from collections.abc import Callable
from typing import Final

from editor.base.camera import ARENA, ZOOM_NOTCH
from editor.base.prompts import TextQuestion
from editor.base.settings import DEBUG_FIRST
from editor.editing.picking import selection_box
from editor.play.mode import Mode
from editor.session import Session
from kinetix.errors import CommandError

BUILT_IN_LAYOUTS: Final = ("edit", "play", "evaluate")
"""Layouts that come with the app (`editor.window.layouts` has them)."""
_ZOOM_STEP: Final = ZOOM_NOTCH**2
"""Factor of one press of the keys that zoom."""


def choose(tool: str) -> Callable[[Session], None]:
    """Return an action that takes a tool."""

    def run(session: Session) -> None:
        session.choose_tool(tool)

    return run


def is_tool(tool: str) -> Callable[[Session], bool]:
    """Return whether a tool is in the hand."""
    return lambda session: session.tool.id == tool


def frame_selection(session: Session) -> None:
    """Show what is selected, or everything."""
    level = session.scene
    selection = session.selection or tuple(body.id for body in level.bodies)
    box = selection_box(level, selection)
    if box is None:
        fit(session)
        return
    session.camera = session.camera.fitted(box[:2], box[2:], margin=60.0)


def fit(session: Session) -> None:
    """Show the whole arena; the canvas fits it to the panels around it."""
    session.tab.fitted = False
    session.camera = session.camera.fitted(*ARENA)


def actual_size(session: Session) -> None:
    """Zoom to 100 pixels per metre."""
    session.camera = dataclasses.replace(session.camera, zoom=1.0)


def zoom(session: Session, *, closer: bool) -> None:
    """Zoom by a step: at the pointer, or in the middle where the pointer is not on the canvas."""
    camera, hands = session.camera, session.hands
    middle = (camera.origin[0] + camera.size[0] / 2, camera.origin[1] + camera.size[1] / 2)
    at = middle if hands.cursor is None else hands.cursor_screen
    session.camera = camera.zoomed(_ZOOM_STEP if closer else 1 / _ZOOM_STEP, at)


def switch(name: str) -> Callable[[Session], None]:
    """Return an action that turns a part of the view on or off."""

    def run(session: Session) -> None:
        setattr(session.view, name, not getattr(session.view, name))

    return run


def open_menu(session: Session) -> None:
    """Open the first menu of the bar, which is shown if it was hidden."""
    session.view.interface = session.view.menu = True


def switch_names(session: Session) -> None:
    """Show or hide the names on the canvas; says how to give one where there is none."""
    session.settings.names = not session.settings.names
    level = session.scene
    if session.settings.names and level.unnamed() is level:
        session.toast("Nothing here has a name yet: select something and press F2.")


def switch_sound(session: Session) -> None:
    """Mute, or let be heard."""
    session.settings.sound = not session.settings.sound
    session.toast(session.sound.fault or ("Sound on" if session.settings.sound else "Sound off"))


def toggle_panels(session: Session) -> None:
    """Show or hide the panels; in Play the bars stay, and only the panels come and go."""
    view = session.view
    if session.editing or not view.interface:
        view.interface = not view.interface
    else:
        view.panels_in_play = not view.panels_in_play


def shows_panels(session: Session) -> bool:
    """Return whether there are panels around the canvas."""
    view, mode = session.view, session.mode
    stay = session.editing or mode is Mode.REPLAY or view.panels_in_play
    return view.interface and stay


def toggle_debug(session: Session) -> None:
    """Turn the debug drawing on or off; the first time with some drawings switched on."""
    session.view.debug_draw = not session.view.debug_draw
    if session.view.debug_draw and not session.settings.debug_draw:
        session.settings.debug_draw = list(DEBUG_FIRST)


def toggle_drawing(session: Session, name: str) -> None:
    """Turn one debug drawing on or off; one that goes on turns the debug drawing on."""
    view, settings = session.view, session.settings
    on = not (view.debug_draw and name in settings.debug_draw)
    kept = [other for other in settings.debug_draw if other != name]
    settings.debug_draw = [*kept, name] if on else kept
    view.debug_draw = view.debug_draw or on


def lay_out(name: str) -> Callable[[Session], None]:
    """Return an action that puts the panels where a layout has them."""

    def run(session: Session) -> None:
        session.view.layout = name

    return run


def keep_layout(session: Session) -> None:
    """Keep the present layout under a name."""

    def answer(name: str | None) -> None:
        if name is None:
            return
        if name.lower() in BUILT_IN_LAYOUTS:
            raise CommandError(f"{name} comes with the app: choose another name.")
        session.view.layout_name = name[:40]

    session.ask(TextQuestion(title="Keep this layout as", accept="Keep", answer=answer))


def forget_layout(session: Session, name: str) -> None:
    """Forget a layout that was kept."""
    session.settings.layouts.pop(name, None)


def bring(panel: str) -> Callable[[Session], None]:
    """Return an action that brings a panel to the front."""

    def run(session: Session) -> None:
        session.view.front = panel

    return run


def is_on(name: str) -> Callable[[Session], bool]:
    """Return whether a part of the view is on."""
    return lambda session: bool(getattr(session.view, name))


def switch_setting(name: str) -> Callable[[Session], None]:
    """Return an action that turns a preference on or off."""

    def run(session: Session) -> None:
        setattr(session.settings, name, not getattr(session.settings, name))

    return run


def is_set(name: str) -> Callable[[Session], bool]:
    """Return whether a preference is on."""
    return lambda session: bool(getattr(session.settings, name))


def switch_tab(step: int) -> Callable[[Session], None]:
    """Return an action that brings the next or previous tab to the front."""

    def run(session: Session) -> None:
        if len(session.tabs) < 2:
            raise CommandError("There is only one tab.")
        session.show_tab((session.tabs.index_in_front + step) % len(session.tabs))

    return run
