"""Messages of the page, as input events; whatever else arrives is refused with one sentence."""

import dataclasses
import math
from collections.abc import Callable
from typing import Any, Final, TypeAlias

from editor.base import events
from editor.hosts.inputs import FAR
from kinetix.errors import KinetixError
from kinetix.files.limits import LIMITS

_NOWHERE: Final = (0.0, 0.0)
LONGEST: Final = LIMITS["level"].largest
"""Most characters of a text; the page knows the number too."""
_FAR_OUT: Final = 1e5
"""Largest coordinate [px]."""
_MOST_ZOOM: Final = 4.0
"""Largest zoom of one message."""
_BUTTONS: Final = {0: events.LEFT, 1: events.MIDDLE, 2: events.RIGHT, 3: 6, 4: 7}
"""The browser's button numbers to pygame's."""


@dataclasses.dataclass(frozen=True, kw_only=True)
class Page:
    """The page's size and density."""

    width: int
    """Width [device px]."""
    height: int
    """Height [device px]."""
    density: float
    """Device pixels per pixel of the page's layout."""


@dataclasses.dataclass(frozen=True, kw_only=True)
class Drawn:
    """The page has drawn a picture."""

    number: int


@dataclasses.dataclass(frozen=True, kw_only=True)
class Pasted:
    """The text on the clipboard of the page's machine."""

    text: str


@dataclasses.dataclass(frozen=True, kw_only=True)
class FullScreen:
    """The browser has entered or left full screen."""

    on: bool


Message: TypeAlias = events.InputEvent | Page | Drawn | Pasted | FullScreen

_LEFT: Final = events.PointerEvent(kind=events.Pointer.MOVE, world=_NOWHERE, screen=FAR, button=0)
"""The pointer is nowhere on the page."""
GONE: Final[tuple[Message, ...]] = (_LEFT, events.FocusEvent(focused=False))
"""The end of a page: nothing is held any more."""

_NAMES: Final = {
    "ArrowLeft": "left",
    "ArrowRight": "right",
    "ArrowUp": "up",
    "ArrowDown": "down",
    "PageUp": "page up",
    "PageDown": "page down",
    "Enter": "return",
    "Backquote": "`",
    "Minus": "-",
    "Equal": "=",
    "BracketLeft": "[",
    "BracketRight": "]",
    "Backslash": "\\",
    "Semicolon": ";",
    "Quote": "'",
    "Comma": ",",
    "Period": ".",
    "Slash": "/",
    "CapsLock": "caps lock",
    "ContextMenu": "menu",
    "NumpadAdd": "[+]",
    "NumpadSubtract": "[-]",
    "NumpadMultiply": "[*]",
    "NumpadDivide": "[/]",
    "NumpadDecimal": "[.]",
    "NumpadEnter": "enter",
    "NumpadEqual": "equals",
}
_SIDES: Final = {"Left": "left", "Right": "right"}
_MODIFIERS: Final = {"Shift": "shift", "Control": "ctrl", "Alt": "alt", "Meta": "meta"}
_PLAIN: Final = frozenset(
    {"Tab", "Home", "End", "Insert", "Delete", "Backspace", "Space", "Escape"}
)


def key_name(code: str, key: str) -> str | None:
    """Return pygame's name of a key, or None.

    Args:
        code: The key's place on the keyboard, such as `KeyZ` or `ShiftLeft`.
        key: What it types with the present layout: letters go by it, all others by their place.
    """
    if len(key) == 1 and key.isascii() and key.isalpha():
        return key.lower()
    if code in _NAMES:
        return _NAMES[code]
    if code in _PLAIN or (code[:1] == "F" and code[1:].isdecimal()):
        return code.lower()
    if code.startswith("Digit"):
        return code.removeprefix("Digit")
    if code.startswith("Numpad") and code[6:].isdecimal():
        return f"[{code[6:]}]"
    if code.startswith("Key"):
        return code.removeprefix("Key").lower()
    for name, ours in _MODIFIERS.items():
        side = _SIDES.get(code.removeprefix(name))
        if code.startswith(name) and side:
            return f"{side} {ours}"
    return None


def _number(value: object) -> float:
    if isinstance(value, bool) or not isinstance(value, int | float) or not math.isfinite(value):
        raise ValueError
    return max(min(float(value), _FAR_OUT), -_FAR_OUT)


def _frame(value: object) -> int:
    """Return the number of a picture: there are more of them than pixels."""
    if isinstance(value, bool) or not isinstance(value, int) or value < 0:
        raise ValueError
    return value


def _text(value: object) -> str:
    if not isinstance(value, str) or len(value) > LONGEST:
        raise ValueError
    value.encode()  # half of a surrogate pair is no text
    return value


def _flag(value: object) -> bool:
    if not isinstance(value, bool):
        raise ValueError
    return value


def _pointer(kind: events.Pointer, x: object, y: object, button: object) -> events.InputEvent:
    return events.PointerEvent(
        kind=kind,
        world=_NOWHERE,
        screen=(_number(x), _number(y)),
        button=_BUTTONS.get(int(_number(button)), 0) if button is not None else 0,
    )


def _pinch(factor: object, x: object, y: object) -> events.InputEvent:
    most = _MOST_ZOOM
    return events.PinchEvent(
        factor=max(min(_number(factor), most), 1 / most), screen=(_number(x), _number(y))
    )


def _key(code: object, key: object, pressed: object) -> events.InputEvent | None:
    name = key_name(_text(code), _text(key))
    return None if name is None else events.KeyEvent(key=name, pressed=_flag(pressed))


_READ: Final[dict[str, Callable[..., Message | None]]] = {
    "move": lambda x, y: _pointer(events.Pointer.MOVE, x, y, None),
    "down": lambda x, y, button: _pointer(events.Pointer.PRESS, x, y, button),
    "up": lambda x, y, button: _pointer(events.Pointer.RELEASE, x, y, button),
    "leave": lambda: _LEFT,
    "wheel": lambda dx, dy: events.WheelEvent(dx=_number(dx), dy=_number(dy)),
    "pinch": _pinch,
    "key": _key,
    "text": lambda text: events.TextEvent(text=_text(text)),
    "paste": lambda text: Pasted(text=_text(text)),
    "focus": lambda focused: events.FocusEvent(focused=_flag(focused)),
    "full": lambda on: FullScreen(on=_flag(on)),
    "size": lambda width, height, density: Page(
        width=int(_number(width)), height=int(_number(height)), density=_number(density)
    ),
    "drawn": lambda number: Drawn(number=_frame(number)),
}


def read(said: object) -> tuple[list[Message], list[KinetixError]]:
    """Return the page's messages as events, and those that are refused.

    Args:
        said: A list of messages, each a list of its name and its values.

    Raises:
        KinetixError: The text is not a message of the page.
    """
    if not isinstance(said, list):
        raise KinetixError("input: expected a list of messages")
    messages: list[Message] = []
    faults: list[KinetixError] = []
    for one in said:
        try:
            message = _read_one(one)
        except KinetixError as fault:
            faults.append(fault)
        else:
            messages += [message] if message is not None else []
    return messages, faults


def _read_one(said: Any) -> Message | None:
    try:
        name, *values = said
        return _READ[name](*values)
    except (TypeError, ValueError, KeyError, OverflowError) as error:
        raise KinetixError(f"input: {str(said)[:80]} is not a known message") from error
