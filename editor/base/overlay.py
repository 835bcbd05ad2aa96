"""Marks of tools on the canvas: plain values in level metres; the canvas draws them."""

import dataclasses
import enum
from typing import TypeAlias

Point: TypeAlias = tuple[float, float]


class Style(enum.Enum):
    """Meaning of a mark; the theme gives it colour and thickness."""

    PREVIEW = "preview"
    """Something about to be made."""
    GUIDE = "guide"
    """A snapping guide."""
    SELECTED = "selected"
    HOVER = "hover"
    BODY_A = "body_a"
    """First body of a joint: solid outline."""
    BODY_B = "body_b"
    """Second body of a joint: dashed outline."""
    MARQUEE_CONTAINED = "marquee_contained"
    """Rubber band that takes what lies wholly inside (drawn left to right)."""
    MARQUEE_TOUCHING = "marquee_touching"
    """Rubber band that takes what it touches (drawn right to left)."""
    FORCE = "force"
    """Push of a thruster or of the mouse."""
    QUANTITY = "quantity"
    """A limit, a velocity, gravity."""
    REFUSED = "refused"
    """Something that will not work."""


class HandleKind(enum.Enum):
    """Effect of dragging a handle."""

    ROTATE = "rotate"
    SCALE = "scale"
    """A corner: both directions at once."""
    SCALE_X = "scale_x"
    SCALE_Y = "scale_y"
    RADIUS = "radius"
    VERTEX = "vertex"
    AIM = "aim"
    """Direction of a thruster."""
    LIMIT_MIN = "limit_min"
    LIMIT_MAX = "limit_max"
    """Ends of the wedge of a joint's limits."""
    MOTOR = "motor"
    """Speed of a joint's motor."""
    POWER = "power"
    """Power of a thruster."""
    VELOCITY = "velocity"
    SPIN = "spin"
    """Motion of a body at the start."""
    GRAVITY = "gravity"


class Cursor(enum.Enum):
    """Shape of the mouse cursor."""

    ARROW = "arrow"
    CROSS = "cross"
    HAND = "hand"
    MOVE = "move"
    ROTATE = "rotate"
    RESIZE = "resize"
    REFUSED = "refused"


@dataclasses.dataclass(frozen=True, kw_only=True)
class Line:
    """A straight line; `arrow` puts a head at `b`."""

    a: Point
    b: Point
    style: Style
    arrow: bool = False


@dataclasses.dataclass(frozen=True, kw_only=True)
class Ring:
    """A circle's outline."""

    centre: Point
    radius: float
    style: Style


@dataclasses.dataclass(frozen=True, kw_only=True)
class Arc:
    """A part of a circle's outline, from one angle to the other [rad]; `filled` to the centre."""

    centre: Point
    radius: float
    start: float
    end: float
    style: Style
    filled: bool = False


@dataclasses.dataclass(frozen=True, kw_only=True)
class Outline:
    """A closed polygon's outline."""

    points: tuple[Point, ...]
    style: Style


@dataclasses.dataclass(frozen=True, kw_only=True)
class Box:
    """An axis-aligned rectangle (the rubber band)."""

    low: Point
    high: Point
    style: Style


@dataclasses.dataclass(frozen=True, kw_only=True)
class Dot:
    """A small mark of constant size on the screen (anchors, centres)."""

    at: Point
    style: Style


@dataclasses.dataclass(frozen=True, kw_only=True)
class Label:
    """A short text beside a point: dimensions, angles."""

    at: Point
    text: str


@dataclasses.dataclass(frozen=True, kw_only=True)
class Handle:
    """Something to drag, of constant size on the screen."""

    kind: HandleKind
    at: Point
    index: int = 0
    """Index of the corner, edge or vertex."""


Mark: TypeAlias = Line | Ring | Arc | Outline | Box | Dot | Label | Handle
