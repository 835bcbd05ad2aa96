"""From pygame's events to ours: every key, button, wheel, text, focus and drop.

imgui-bundle's own pygame adapter knows only the navigation keys and six letters, takes text from
key presses (no dead keys), counts wheel notches twice and fails on the mouse's back button.
"""

import string
from collections.abc import Callable
from typing import Final

import pygame

from editor.base import events
from editor.hosts.inputs import FAR
from editor.toolkit.keys import IMGUI

PINCH_SHARE = 12.0
"""Zoom of two fingers that move apart by the width of the pad."""
_SCREEN_ONLY = (0.0, 0.0)
"""Hosts know no level coordinates; the canvas works them out from the screen position."""
_PLACES: Final = {
    pygame.KSCAN_GRAVE: "`",
    pygame.KSCAN_MINUS: "-",
    pygame.KSCAN_EQUALS: "=",
    pygame.KSCAN_LEFTBRACKET: "[",
    pygame.KSCAN_RIGHTBRACKET: "]",
    pygame.KSCAN_BACKSLASH: "\\",
    pygame.KSCAN_NONUSHASH: "\\",
    pygame.KSCAN_SEMICOLON: ";",
    pygame.KSCAN_APOSTROPHE: "'",
    pygame.KSCAN_COMMA: ",",
    pygame.KSCAN_PERIOD: ".",
    pygame.KSCAN_SLASH: "/",
} | {getattr(pygame, f"KSCAN_{key}"): key.lower() for key in "0123456789" + string.ascii_uppercase}
"""Names of keys by their place, which is that of an American keyboard."""


def modifiers(mask: int) -> events.Modifiers:
    """Return the modifiers of a key event; Cmd counts as Ctrl."""
    return events.Modifiers(
        ctrl=bool(mask & (pygame.KMOD_CTRL | pygame.KMOD_META)),
        shift=bool(mask & pygame.KMOD_SHIFT),
        alt=bool(mask & pygame.KMOD_ALT),
    )


def _key(event: pygame.event.Event) -> events.InputEvent:
    name = pygame.key.name(event.key)
    if name not in IMGUI:
        # What a layout has in place of brackets, such as ö and ü, does what they do; so do the
        # letters of layouts that have other letters than ours.
        name = _PLACES.get(getattr(event, "scancode", None), name)
    return events.KeyEvent(
        key=name,
        pressed=event.type == pygame.KEYDOWN,
        modifiers=modifiers(event.mod),
    )


def _button(event: pygame.event.Event) -> events.InputEvent:
    pressed = event.type == pygame.MOUSEBUTTONDOWN
    return events.PointerEvent(
        kind=events.Pointer.PRESS if pressed else events.Pointer.RELEASE,
        world=_SCREEN_ONLY,
        screen=event.pos,
        button=event.button,
    )


def _motion(event: pygame.event.Event) -> events.InputEvent:
    return events.PointerEvent(
        kind=events.Pointer.MOVE, world=_SCREEN_ONLY, screen=event.pos, button=0
    )


def _leave(event: pygame.event.Event) -> events.InputEvent:
    del event
    return events.PointerEvent(kind=events.Pointer.MOVE, world=_SCREEN_ONLY, screen=FAR, button=0)


def _wheel(event: pygame.event.Event) -> events.InputEvent:
    dx = getattr(event, "precise_x", float(event.x))
    dy = getattr(event, "precise_y", float(event.y))
    return events.WheelEvent(dx=-dx, dy=dy)


def _pinch(event: pygame.event.Event) -> events.InputEvent | None:
    if event.num_fingers != 2 or not event.pinched:
        return None
    width, height = pygame.display.get_window_size()
    factor = PINCH_SHARE ** float(event.pinched)
    return events.PinchEvent(factor=factor, screen=(event.x * width, event.y * height))


_TRANSLATE: dict[int, Callable[[pygame.event.Event], events.InputEvent | None]] = {
    pygame.KEYDOWN: _key,
    pygame.KEYUP: _key,
    pygame.MOUSEBUTTONDOWN: _button,
    pygame.MOUSEBUTTONUP: _button,
    pygame.MOUSEMOTION: _motion,
    pygame.WINDOWLEAVE: _leave,
    pygame.MOUSEWHEEL: _wheel,
    pygame.MULTIGESTURE: _pinch,
    pygame.TEXTINPUT: lambda event: events.TextEvent(text=event.text),
    pygame.WINDOWFOCUSGAINED: lambda event: events.FocusEvent(focused=True),
    pygame.WINDOWFOCUSLOST: lambda event: events.FocusEvent(focused=False),
    pygame.WINDOWSIZECHANGED: lambda event: events.ResizeEvent(width=event.x, height=event.y),
    pygame.DROPFILE: lambda event: events.DropEvent(path=event.file),
    pygame.QUIT: lambda event: events.QuitEvent(),
}


def translate(event: pygame.event.Event) -> events.InputEvent | None:
    """Return one pygame event as ours.

    Args:
        event: Any event of pygame's queue.

    Returns:
        What it means to the app; None when it means nothing.
    """
    handler = _TRANSLATE.get(event.type)
    return handler(event) if handler is not None else None
