"""Hands what a person did, as the values of `editor.base.events`, to Dear ImGui.

Every host and the replay come through here. Dear ImGui is the one place that tracks which keys and
buttons are held, and it learns them from these events alone (never from the operating system's
present state); so posted events and replays behave like real ones, and losing the focus releases
everything.
"""

import collections
from collections.abc import Iterable

from imgui_bundle import imgui

from editor.base import events
from editor.toolkit import keys

FAR = (-3.4e38, -3.4e38)
"""Position of a pointer that has left the window (Dear ImGui's sign for "nowhere")."""

_BUTTONS = {1: 0, 2: 2, 3: 1, 6: 3, 7: 4}
"""Our button numbers (pygame's) to Dear ImGui's; 4 and 5, the wheel's legacy twins, are dropped."""


class InputFeeder:
    """Queues input events with Dear ImGui, in order."""

    def __init__(self) -> None:
        self._waiting: collections.deque[events.InputEvent] = collections.deque()
        self._keys: set[str] = set()
        self._buttons: set[int] = set()

    @property
    def pending(self) -> bool:
        """True if events are left for the next frame."""
        return bool(self._waiting)

    def feed(self, batch: Iterable[events.InputEvent]) -> None:
        """Queue events for the next frame.

        Dear ImGui looks at the modifiers once a frame. When a slow frame brings "s down, Ctrl up"
        together, what follows the first press therefore waits for another frame.

        Args:
            batch: What happened since the last frame. Resizes, dropped files and close requests
                are the host's business and are passed over.
        """
        io = imgui.get_io()
        self._waiting.extend(batch)
        waits = False
        while self._waiting:
            event = self._waiting[0]
            if waits and isinstance(event, events.KeyEvent) and event.key in keys.MODIFIERS:
                return
            waits = waits or _presses(event)
            self._waiting.popleft()
            match event:
                case events.PointerEvent():
                    self._pointer(io, event)
                case events.KeyEvent(key=key, pressed=pressed):
                    self._key(io, key, pressed)
                case events.WheelEvent(dx=dx, dy=dy):
                    io.add_mouse_wheel_event(dx, dy)
                case events.TextEvent(text=text):
                    # Half of a surrogate pair would make the field's text unreadable.
                    for character in text.encode("utf-8", "ignore").decode():
                        io.add_input_character(ord(character))
                case events.FocusEvent(focused=focused):
                    self._focus(io, focused)
                case _:
                    pass

    def _pointer(self, io: imgui.IO, event: events.PointerEvent) -> None:
        io.add_mouse_pos_event(*event.screen)
        button = _BUTTONS.get(event.button)
        if event.kind is events.Pointer.MOVE or button is None:
            return
        pressed = event.kind is events.Pointer.PRESS
        if pressed:
            self._buttons.add(button)
        else:
            self._buttons.discard(button)
        io.add_mouse_button_event(button, pressed)

    def _key(self, io: imgui.IO, name: str, pressed: bool) -> None:
        key = keys.IMGUI.get(name)
        if key is None:
            return
        if pressed:
            self._keys.add(name)
        else:
            self._keys.discard(name)
        modifier = keys.MODIFIERS.get(name)
        if modifier is not None:
            held = any(keys.MODIFIERS.get(other) == modifier for other in self._keys)
            io.add_key_event(modifier, held)
        io.add_key_event(key, pressed)

    def _focus(self, io: imgui.IO, focused: bool) -> None:
        if not focused:
            for name in tuple(self._keys):
                self._key(io, name, False)
            for button in self._buttons:
                io.add_mouse_button_event(button, False)
            self._buttons.clear()
        io.add_focus_event(focused)


def _presses(event: events.InputEvent) -> bool:
    """Return whether it is something that modifiers give a meaning to."""
    match event:
        case events.KeyEvent(key=key, pressed=pressed):
            return pressed and key not in keys.MODIFIERS
        case events.PointerEvent(kind=kind):
            return kind is not events.Pointer.MOVE
        case events.WheelEvent():
            return True
        case _:
            return False
