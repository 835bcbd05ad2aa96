"""Displays on which windows can be seen: SDL draws into memory by itself where none answers."""

import os
import tempfile
from typing import Final

import pygame

_UNSEEN: Final = frozenset({"offscreen", "dummy"})
"""SDL's drivers that show nothing."""
NO_DISPLAY: Final = (
    "There is no display to open a window on. On a desktop, set DISPLAY or WAYLAND_DISPLAY. "
    "Without a display, `kinetix-editor --serve` shows the editor in a browser, `kinetix render "
    "LEVEL OUT.gif` films a level, `make run` films a tour of the editor, and `kinetix-editor "
    "--offscreen --replay EVENTS.jsonl` runs a script in it (docs/replay.md)."
)


def seen() -> bool:
    """Return whether the windows of the present driver are seen; `pygame.display` is up."""
    return pygame.display.get_driver() not in _UNSEEN


def has_display() -> bool:
    """Return whether a window could open: DISPLAY may name a server that is gone."""
    try:
        start_display()
        return seen()
    except pygame.error:
        return False
    finally:
        pygame.display.quit()


def start_display() -> None:
    """Start pygame's display.

    Raises:
        pygame.error: The machine has no display.
    """
    # Where this is not set, Wayland's library writes an error, though all that follows works.
    name = "XDG_RUNTIME_DIR"
    unset = not os.environ.get(name)
    if unset:
        os.environ[name] = tempfile.gettempdir()
    try:
        pygame.display.init()
    finally:
        if unset:
            del os.environ[name]
