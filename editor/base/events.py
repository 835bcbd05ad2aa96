"""Input as plain values: what hosts make of the toolkit's events, and what tools read."""

import dataclasses
import enum
from typing import Final, TypeAlias

Point: TypeAlias = tuple[float, float]
"""x, y; in metres (y up) or in window pixels (y down), as the field that holds it says."""

FRAME: Final = 1 / 60
"""Duration of a frame, of the screen and of scripts that are replayed [s]."""
LEFT: Final = 1
MIDDLE: Final = 2
RIGHT: Final = 3


class Pointer(enum.Enum):
    """Kind of a pointer event."""

    PRESS = "press"
    MOVE = "move"
    RELEASE = "release"


@dataclasses.dataclass(frozen=True, kw_only=True)
class Modifiers:
    """Modifier keys that are down; Cmd counts as Ctrl."""

    ctrl: bool = False
    shift: bool = False
    alt: bool = False

    @property
    def prefix(self) -> str:
        """The modifiers as a chord's beginning: `"ctrl+shift+"`, or nothing."""
        names = (("ctrl", self.ctrl), ("shift", self.shift), ("alt", self.alt))
        return "".join(f"{name}+" for name, down in names if down)


NO_MODIFIERS: Final = Modifiers()


@dataclasses.dataclass(frozen=True, kw_only=True)
class PointerEvent:
    """A press, a move or a release of the pointer over the canvas."""

    kind: Pointer
    world: Point
    """Position in level metres."""
    screen: Point = (0.0, 0.0)
    """Position in window pixels."""
    button: int = LEFT
    """1 left, 2 middle, 3 right; of a move: the button that is held, 0 for none."""
    modifiers: Modifiers = NO_MODIFIERS
    time: float = 0.0
    """Seconds on the session's clock."""
    typed: tuple[float, ...] = ()
    """Numbers typed during the gesture (`1.2` or `1.2x0.4`); they override the dragged size."""


@dataclasses.dataclass(frozen=True, kw_only=True)
class KeyEvent:
    """A key went down or up; `key` is pygame's lower-case name (`left`, `space`, `f5`, `[`)."""

    key: str
    pressed: bool
    modifiers: Modifiers = NO_MODIFIERS
    repeat: bool = False
    """True if the system repeats a key that was already down."""

    @property
    def chord(self) -> str:
        """Modifiers and key as the action table writes them: `"ctrl+shift+z"`."""
        return self.modifiers.prefix + self.key


@dataclasses.dataclass(frozen=True, kw_only=True)
class TextEvent:
    """Characters that were typed (after the input method has composed them)."""

    text: str


@dataclasses.dataclass(frozen=True, kw_only=True)
class WheelEvent:
    """The wheel turned by `dy` notches (positive: away from the user) at `screen` [px]."""

    dy: float
    dx: float = 0.0
    screen: Point = (0.0, 0.0)
    modifiers: Modifiers = NO_MODIFIERS


@dataclasses.dataclass(frozen=True, kw_only=True)
class PinchEvent:
    """Two fingers have moved apart (a factor above 1) or together, around `screen` [px]."""

    factor: float
    screen: Point = (0.0, 0.0)


@dataclasses.dataclass(frozen=True, kw_only=True)
class PadEvent:
    """A stick or button of a gamepad; `control` is such as `pad left` or `pad a`."""

    control: str
    pressed: bool


@dataclasses.dataclass(frozen=True, kw_only=True)
class FocusEvent:
    """The window gained or lost the keyboard."""

    focused: bool


@dataclasses.dataclass(frozen=True, kw_only=True)
class ResizeEvent:
    """The window's new size [px]."""

    width: int
    height: int


@dataclasses.dataclass(frozen=True, kw_only=True)
class DropEvent:
    """A file was dropped on the window."""

    path: str


@dataclasses.dataclass(frozen=True, kw_only=True)
class QuitEvent:
    """The user asked the window to close."""


InputEvent: TypeAlias = (
    PointerEvent
    | KeyEvent
    | TextEvent
    | WheelEvent
    | PinchEvent
    | PadEvent
    | FocusEvent
    | ResizeEvent
    | DropEvent
    | QuitEvent
)
