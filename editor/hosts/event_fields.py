"""Reads the fields of a script's events; a wrong value gets one sentence."""

import math
from collections.abc import Collection
from typing import Any, Final

from editor.base import events
from editor.base.controls import PAD_NAMES
from editor.base.settings import LARGEST_SIDE
from editor.toolkit.keys import IMGUI
from kinetix.errors import KinetixError

Event = dict[str, Any]

_BUTTONS: Final = {1: events.LEFT, 2: events.MIDDLE, 3: events.RIGHT}


def point(event: Event, key: str) -> tuple[float, float]:
    """Return the two numbers that an event has under a key."""
    told = event[key]
    try:
        x, y = told
        return float(x), float(y)
    except (TypeError, ValueError):
        raise KinetixError(f"{key} is {told!r}: expected two numbers") from None


def size(event: Event) -> tuple[int, int]:
    """Return the size of an event's window [px]."""
    width, height = event["size"]
    if not all(type(side) is int and 0 < side <= LARGEST_SIDE for side in (width, height)):
        raise KinetixError(
            f"size is {event['size']!r}: expected two numbers of pixels up to {LARGEST_SIDE}"
        )
    return width, height


def button(event: Event) -> int:
    """Return the button of an event, by default the left one."""
    told = event.get("button", 1)
    if told not in tuple(_BUTTONS):
        raise KinetixError(f"button is {told!r}: expected 1, 2 or 3")
    return _BUTTONS[told]


def count(event: Event) -> int:
    """Return how many frames an event takes."""
    count = int(event["frames"])
    if count < 0:
        raise KinetixError(f"frames is {count}: expected 0 or more")
    return count


def factor(event: Event) -> float:
    """Return by how much an event's fingers have moved apart."""
    factor = float(event["factor"])
    if not 0 < factor < math.inf:
        raise KinetixError(f"factor is {factor:g}: expected more than 0")
    return factor


def control(event: Event) -> str:
    """Return the stick or button of an event's gamepad."""
    told = event["control"]
    if not isinstance(told, str) or told not in PAD_NAMES:
        raise KinetixError(f"unknown control {told!r}; there are {', '.join(sorted(PAD_NAMES))}")
    return told


def known_key(name: str, more: Collection[str] = ()) -> str:
    """Return the name of a key that there is, among `more` as well."""
    if name not in IMGUI and name not in more:
        raise KinetixError(f"unknown key {name!r}; names are pygame's, such as left, space, f5, a")
    return name
