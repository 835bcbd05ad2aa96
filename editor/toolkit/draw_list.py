"""Polygons and lines on a draw list, typed for plain points."""

from collections.abc import Sequence
from typing import Any

from imgui_bundle import imgui

from editor.base.camera import Point


def fill(draw: imgui.ImDrawList, points: Sequence[Point], colour: int) -> None:
    """Fill a convex polygon [px] of either turning sense, with smooth edges."""
    twice = sum(
        points[k - 1][0] * points[k][1] - points[k - 1][1] * points[k][0]
        for k in range(len(points))
    )
    # Dear ImGui blends the edges outwards of what turns clockwise on the screen, y downwards.
    corners: Any = list(points) if twice > 0 else list(reversed(points))
    draw.add_convex_poly_filled(corners, colour)


def stroke(
    draw: imgui.ImDrawList,
    points: Sequence[Point],
    colour: int,
    width: float,
    *,
    closed: bool = False,
) -> None:
    """Draw a line through points [px], back to the first one if closed."""
    corners: Any = list(points)
    flags = imgui.ImDrawFlags_.closed.value if closed else 0
    draw.add_polyline(corners, colour, width, flags)
