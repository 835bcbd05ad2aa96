"""Thicknesses, marks and draw order, for the JAX renderer and the editor's vectors; free of JAX.

Lengths are metres unless noted otherwise; angles are radians, counter-clockwise.
"""

import dataclasses
import math
from typing import Final

Point = tuple[float, float]

DRAW_ORDER: Final = ("background", "floor", "polygons", "circles", "joints", "thrusters")
"""Later ones cover earlier ones; inside a kind the order is the index. Polygons start at index 4:
walls and ceiling (1–3) are never drawn. Bodies carry their outline and role glyph with them."""

FLOOR: Final = 0
"""Global index of the floor, the only arena body that is drawn."""
FLOOR_GLYPH_DEPTH: Final = 0.2
"""Depth of the floor's glyph below its surface [m]: the floor's middle is out of sight."""
FIRST_POLYGON: Final = 4
"""Global index of the first polygon that is not part of the arena."""


@dataclasses.dataclass(frozen=True, kw_only=True)
class Glyph:
    """A role's sign in the middle of a body, in units of its radius: nothing lies beyond 1."""

    disc: float = 0.0
    """Radius of a filled disc; 0 for none."""
    ring: tuple[float, float] | None = None
    """Inner and outer radius of a ring."""
    cross: tuple[float, float] | None = None
    """Half length and half width of two bars at ±45° (they turn with the body)."""


ROLE_GLYPHS: Final = (
    None,
    Glyph(disc=0.62),
    Glyph(disc=0.38, ring=(0.7, 1.0)),
    Glyph(cross=(0.95, 0.2)),
)
"""By role: nothing, ● green, ◎ blue, ✕ red. Distinguished by shape alone."""


@dataclasses.dataclass(frozen=True, kw_only=True)
class Pattern:
    """Stripes over a body's fill, fixed to the body's frame."""

    angles: tuple[float, ...]
    """Directions of the stripes; two make a lattice."""
    period: float = 0.11
    width: float = 0.028


ROLE_PATTERNS: Final = (
    None,
    Pattern(angles=(math.pi / 4,)),
    Pattern(angles=(0.0,)),
    Pattern(angles=(math.pi / 4, -math.pi / 4)),
)
"""By role; drawn only when `Style.patterns` is on."""

THRUSTER_NOZZLE: Final[tuple[Point, ...]] = ((0.5, 0.14), (0.5, -0.14), (0.02, -0.3), (0.02, 0.3))
"""Nozzle of a thruster's mark, clockwise, in units of the mark's size. The frame's +x is the
direction in which the body is pushed; the mark's centre is the attachment."""
THRUSTER_FLAME: Final[tuple[Point, ...]] = ((0.02, 0.24), (0.02, -0.24), (-0.5, 0.0))
"""Flame, clockwise; it points backwards and has the binding's colour."""


@dataclasses.dataclass(frozen=True, kw_only=True)
class Style:
    """Style of pictures for people. The pixel observation has its own fixed rules (`pixels.py`)."""

    outline: float = 0.02
    """Thickness of edges, inside the body."""
    least_outline: float = 1.0
    """Edges are at least this thick [px], so that they never vanish when zoomed out."""
    mark_outline: float = 0.008
    """Thickness of the edges of joint and thruster marks, at least half of `least_outline`."""
    spoke: float = 0.02
    """Thickness of a circle's radius line, along its local +y."""
    joint_radius: float = 0.045
    """Radius of a revolute joint's disc; a weld is a square with this half side."""
    thruster_size: float = 0.2
    """Side of the square that holds a thruster's mark."""
    glyph_radius: float = 0.09
    """Radius of a role glyph on a large body."""
    glyph_share: float = 0.42
    """A role glyph is never larger than this share of the body's inscribed radius."""
    glyphs: bool = True
    """True if bodies carry their role's glyph."""
    patterns: bool = False
    """True if bodies carry their role's pattern."""


STYLE: Final = Style()
"""Default style of the app."""


def glyph_radius(inscribed: float, style: Style = STYLE) -> float:
    """Return the radius of the role glyph on a body.

    Args:
        inscribed: Distance from the body's centre to its nearest edge; a circle's radius.
        style: The style in use.
    """
    return min(style.glyph_radius, style.glyph_share * inscribed)


__all__ = [
    "DRAW_ORDER",
    "FIRST_POLYGON",
    "FLOOR",
    "FLOOR_GLYPH_DEPTH",
    "ROLE_GLYPHS",
    "ROLE_PATTERNS",
    "STYLE",
    "THRUSTER_FLAME",
    "THRUSTER_NOZZLE",
    "Glyph",
    "Pattern",
    "Point",
    "Style",
    "glyph_radius",
]
