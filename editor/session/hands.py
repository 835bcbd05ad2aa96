"""Keys and pointer as they are at the moment."""

import dataclasses
from collections.abc import Callable

from editor.base.events import NO_MODIFIERS, Modifiers, Point
from editor.worker.requests import Pull


@dataclasses.dataclass(kw_only=True)
class Hands:
    """Keys held, the pointer and the gesture under way."""

    held: set[str] = dataclasses.field(default_factory=set)
    """Keys that are down."""
    modifiers: Modifiers = NO_MODIFIERS
    """Modifier keys that are down."""
    capture: Callable[[str], None] | None = None
    """Takes the next chord that is pressed instead of its action (changing keys)."""
    cursor: Point | None = None
    """Pointer position over the canvas [m], or None."""
    cursor_screen: Point = (0.0, 0.0)
    """Pointer position in the window [px]."""
    pull: Pull | None = None
    """Pull of the mouse in Play."""
    pan: tuple[Point, Point, bool] | None = None
    """While a button pans: where it began, where it was last [px], whether it has moved."""
    touched: float = 0.0
    """Time of the last input, on the clock of `time.monotonic` [s]."""

    def release(self) -> None:
        """Let go of everything: the window has lost the keyboard."""
        self.held.clear()
        self.pull = None
