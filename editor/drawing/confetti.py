"""Coloured paper for a win: falls once, over the level, and is gone."""

import math
from typing import Final

from imgui_bundle import imgui

from editor.base.camera import Point
from editor.toolkit.appearance import COLOURS, alpha, u32
from editor.toolkit.widgets import px

SECONDS: Final = 1.8
"""Duration of the fall."""
_PIECES: Final = 70
_COLOURS: Final = ("good", "warn", "info", "accent", "bad")


def paint_confetti(draw: imgui.ImDrawList, low: Point, high: Point, elapsed: float) -> None:
    """Draw it as it is some time after the win.

    Args:
        draw: Where to draw.
        low: Upper left corner of where it falls [px].
        high: Lower right corner [px].
        elapsed: Since the win [s].
    """
    if not 0.0 <= elapsed < SECONDS:
        return
    width, height = high[0] - low[0], high[1] - low[1]
    fade = min(1.0, (SECONDS - elapsed) / 0.5)
    for k in range(_PIECES):
        # Thrown up from both lower corners; the golden ratio spreads speeds and turns evenly.
        left = k % 2 == 0
        share = (k * 0.618034) % 1.0
        other = (k * 0.414214) % 1.0
        along = (0.15 + 0.75 * share) * width * elapsed / SECONDS * 1.15
        rise = (0.75 + 0.75 * other) * height
        x = low[0] + along if left else high[0] - along
        y = high[1] - rise * elapsed + 0.62 * height * elapsed * elapsed
        if not low[1] <= y <= high[1]:
            continue
        turn = 9.0 * elapsed * (0.5 + share) + k
        long, short = px(5), px(3.2) * abs(math.cos(1.7 * turn)) + px(0.6)
        c, s = math.cos(turn), math.sin(turn)
        corners: list[imgui.ImVec2Like] = [
            imgui.ImVec2(x + c * u - s * v, y + s * u + c * v)
            for u, v in ((-long, -short), (long, -short), (long, short), (-long, short))
        ]
        colour = u32(alpha(COLOURS.of(_COLOURS[k % len(_COLOURS)]), fade))
        draw.add_convex_poly_filled(corners, colour)
