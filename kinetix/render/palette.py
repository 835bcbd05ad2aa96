"""Colours of everything that is drawn: one table for the JAX renderer and for the editor's vectors.

Free of JAX, so that the editor's window draws before JAX is imported. Pixel observations always use
`KINETIX`; which palette people look at is theirs to choose and never changes what an agent sees.
"""

import dataclasses
from types import MappingProxyType
from typing import Final

Rgb = tuple[int, int, int]
"""Red, green, blue: sRGB, 0–255."""

ROLE_NAMES: Final = ("none", "green", "blue", "red")
"""Names of the roles 0–3; green must touch blue and must not touch red."""


@dataclasses.dataclass(frozen=True, kw_only=True)
class Palette:
    """One complete set of colours."""

    name: str
    """Identifier, as in the settings file."""
    label: str
    """Name in menus."""
    background: Rgb
    outline: Rgb
    """Edges of bodies and of marks."""
    roles: tuple[Rgb, Rgb, Rgb, Rgb]
    """Fill of bodies that move, by role number."""
    fixed_shade: float
    """Factor on a role's colour for fixed bodies."""
    motor_bindings: tuple[Rgb, Rgb, Rgb, Rgb]
    """Marks of driven joints, by binding number."""
    thruster_bindings: tuple[Rgb, Rgb]
    """Flames, by binding number."""
    uncontrolled: Rgb
    """Marks of joints that answer to no control, welds included."""
    nozzle: Rgb
    """Body of a thruster's mark."""

    def fill(self, role: int, fixed: bool = False) -> Rgb:
        """Return the colour of a body.

        Args:
            role: Role number, 0–3.
            fixed: Whether the body is fixed.

        Returns:
            The role's colour, darker when the body is fixed.
        """
        colour = self.roles[role]
        return shaded(colour, self.fixed_shade) if fixed else colour


def shaded(colour: Rgb, factor: float) -> Rgb:
    """Return the colour times a factor, rounded down (so that half of 255 is 127)."""
    red, green, blue = (int(channel * factor) for channel in colour)
    return red, green, blue


def luminance(colour: Rgb) -> float:
    """Return the relative luminance, 0–1.

    Source: WCAG 2.2, definition of relative luminance (IEC 61966-2-1).
    """
    srgb = [channel / 255 for channel in colour]
    linear = [c / 12.92 if c <= 0.04045 else ((c + 0.055) / 1.055) ** 2.4 for c in srgb]
    return 0.2126 * linear[0] + 0.7152 * linear[1] + 0.0722 * linear[2]


def contrast(first: Rgb, second: Rgb) -> float:
    """Return the contrast ratio of two colours, 1–21.

    Source: WCAG 2.2, definition of contrast ratio.
    """
    low, high = sorted((luminance(first), luminance(second)))
    return (high + 0.05) / (low + 0.05)


def ink(fill: Rgb) -> Rgb:
    """Black or white, whichever stands out more on the fill: for glyphs and text on a body."""
    black, white = (0, 0, 0), (255, 255, 255)
    return black if contrast(fill, black) >= contrast(fill, white) else white


_MOTORS: Final = ((255, 255, 0), (255, 0, 255), (0, 255, 255), (255, 153, 51))

KINETIX: Final = Palette(
    name="kinetix",
    label="Kinetix",
    background=(255, 255, 255),
    outline=(0, 0, 0),
    roles=((160, 160, 160), (0, 204, 0), (0, 102, 204), (255, 102, 102)),
    fixed_shade=0.5,
    motor_bindings=_MOTORS,
    thruster_bindings=_MOTORS[:2],
    uncontrolled=(255, 255, 255),
    nozzle=(96, 96, 96),
)
"""The colours of the published system; what agents see."""

_COLOUR_BLIND: Final = dataclasses.replace(
    KINETIX,
    name="okabe_ito",
    label="Okabe-Ito (colour-blind safe)",
    roles=((160, 160, 160), (0, 170, 90), (0, 80, 160), (180, 40, 30)),
    motor_bindings=((240, 228, 66), (204, 121, 167), (86, 180, 233), (230, 159, 0)),
    thruster_bindings=((240, 228, 66), (204, 121, 167)),
)

_HIGH_CONTRAST: Final = dataclasses.replace(
    KINETIX,
    name="high_contrast",
    label="High contrast",
    background=(0, 0, 0),
    roles=((255, 255, 255), (0, 255, 0), (130, 160, 255), (255, 40, 100)),
    # Darker than this, fixed red falls below 3:1 on black.
    fixed_shade=0.7,
    nozzle=(160, 160, 160),
)

_MONO: Final = dataclasses.replace(
    KINETIX,
    name="mono",
    label="Mono",
    roles=((205, 205, 205), (165, 165, 165), (125, 125, 125), (85, 85, 85)),
    motor_bindings=((250, 250, 250), (200, 200, 200), (150, 150, 150), (100, 100, 100)),
    thruster_bindings=((240, 240, 240), (150, 150, 150)),
)

PALETTES: Final = MappingProxyType(
    {palette.name: palette for palette in (KINETIX, _COLOUR_BLIND, _HIGH_CONTRAST, _MONO)}
)
"""All palettes by name, in the order of the menu."""

__all__ = [
    "KINETIX",
    "PALETTES",
    "ROLE_NAMES",
    "Palette",
    "Rgb",
    "contrast",
    "ink",
    "luminance",
    "shaded",
]
