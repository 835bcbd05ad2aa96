"""Gamepads: sticks and the cross drive motors, buttons fire thrusters, pause and stop.

SDL knows the layout of most pads and gives their parts common names, whatever the maker.
"""

import contextlib
from typing import Final, TypeAlias

import pygame
from pygame._sdl2 import controller, sdl2

from editor.base import events

PRESS: Final = 0.5
"""A stick counts as pushed from this share of its way on …"""
RELEASE: Final = 0.35
"""… until it comes back to this: between them it keeps what it was."""
_FULL: Final = 32767.0
_FAILURES: Final = (pygame.error, sdl2.error)
"""Errors of pygame about gamepads; the second is no subclass of the first."""

_AXES: Final = {
    pygame.CONTROLLER_AXIS_LEFTX: ("pad left", "pad right"),
    pygame.CONTROLLER_AXIS_LEFTY: ("pad up", "pad down"),
    pygame.CONTROLLER_AXIS_RIGHTX: ("pad right-stick left", "pad right-stick right"),
    pygame.CONTROLLER_AXIS_RIGHTY: ("pad right-stick up", "pad right-stick down"),
}
"""Names of an axis's low and high end."""
_BUTTONS: Final = {
    pygame.CONTROLLER_BUTTON_DPAD_LEFT: "pad left",
    pygame.CONTROLLER_BUTTON_DPAD_RIGHT: "pad right",
    pygame.CONTROLLER_BUTTON_DPAD_UP: "pad up",
    pygame.CONTROLLER_BUTTON_DPAD_DOWN: "pad down",
    pygame.CONTROLLER_BUTTON_A: "pad a",
    pygame.CONTROLLER_BUTTON_B: "pad b",
    pygame.CONTROLLER_BUTTON_X: "pad x",
    pygame.CONTROLLER_BUTTON_Y: "pad y",
    pygame.CONTROLLER_BUTTON_START: "pad start",
    pygame.CONTROLLER_BUTTON_BACK: "pad back",
}

_Source: TypeAlias = tuple[int, str, str]
"""The number of a pad, its stick or button, and the name of the key that this stands for."""


class Gamepads:
    """Opens every pad that is plugged in and turns its events into ours."""

    def __init__(self) -> None:
        self._open: dict[int, controller.Controller] = {}
        self._pushed: set[_Source] = set()
        # Without pads, or without the rights to them, the app does as well.
        with contextlib.suppress(*_FAILURES):
            controller.init()

    def translate(self, event: pygame.event.Event) -> list[events.InputEvent]:
        """Return the input event of a pad's event; nothing for all others."""
        if event.type == pygame.CONTROLLERDEVICEADDED:
            with contextlib.suppress(*_FAILURES):
                self._open[event.device_index] = controller.Controller(event.device_index)
        elif event.type == pygame.CONTROLLERDEVICEREMOVED:
            return self._let_go(_pad(event))
        elif event.type == pygame.CONTROLLERAXISMOTION:
            return self._axis(_pad(event), event.axis, event.value / _FULL)
        elif event.type in (pygame.CONTROLLERBUTTONDOWN, pygame.CONTROLLERBUTTONUP):
            name = _BUTTONS.get(event.button)
            if name is not None:
                source = (_pad(event), f"button {event.button}", name)
                return self._set(source, event.type == pygame.CONTROLLERBUTTONDOWN)
        return []

    def _axis(self, pad: int, axis: int, value: float) -> list[events.InputEvent]:
        found: list[events.InputEvent] = []
        for name, way in zip(_AXES.get(axis, ()), (-value, value), strict=False):
            source = (pad, f"axis {axis}", name)
            if way >= PRESS:
                found += self._set(source, True)
            elif way <= RELEASE:
                found += self._set(source, False)
        return found

    def _set(self, source: _Source, pressed: bool) -> list[events.InputEvent]:
        """Note one source: its name is held as long as any source of that name is pushed."""
        name = source[-1]
        held = self._holds(name)
        (self._pushed.add if pressed else self._pushed.discard)(source)
        if self._holds(name) == held:
            return []
        return [events.PadEvent(control=name, pressed=pressed)]

    def _holds(self, name: str) -> bool:
        return any(source[-1] == name for source in self._pushed)

    def _let_go(self, pad: int) -> list[events.InputEvent]:
        """A pad was pulled out: nothing of it is held any more."""
        gone = [source for source in self._pushed if source[0] == pad]
        return [event for source in gone for event in self._set(source, False)]


def _pad(event: pygame.event.Event) -> int:
    """Return which pad an event is of."""
    return getattr(event, "instance_id", 0)
