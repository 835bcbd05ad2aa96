"""Dashed lines, arrows and labels, and the room that labels share."""

import dataclasses
import math
from collections.abc import Sequence

from imgui_bundle import imgui

from editor.base.camera import Point
from editor.base.language import tr
from editor.toolkit.appearance import COLOURS, FONTS, SMALL, alpha, u32
from editor.toolkit.widgets import font, px


def dashed(
    draw: imgui.ImDrawList, points: Sequence[Point], colour: int, width: float, *, closed: bool
) -> None:
    """A dashed line through points [px]."""
    dash, gap = px(6), px(4)
    pairs = list(zip(points, [*points[1:], *points[:1]], strict=True))
    for (ax, ay), (bx, by) in pairs if closed else pairs[:-1]:
        length = math.hypot(bx - ax, by - ay)
        if length < 1e-6:
            continue
        ux, uy = (bx - ax) / length, (by - ay) / length
        at = 0.0
        while at < length:
            end = min(at + dash, length)
            draw.add_line(
                (ax + ux * at, ay + uy * at), (ax + ux * end, ay + uy * end), colour, width
            )
            at = end + gap


def arrow(
    draw: imgui.ImDrawList, a: Point, b: Point, colour: int, width: float, head: float
) -> None:
    """A line with a head at `b` [px]."""
    length = math.hypot(b[0] - a[0], b[1] - a[1])
    if length < 1e-3:
        return
    ux, uy = (b[0] - a[0]) / length, (b[1] - a[1]) / length
    head = min(head, length)
    base = (b[0] - ux * head, b[1] - uy * head)
    draw.add_line(a, base, colour, width)
    wing = head * 0.45
    draw.add_triangle_filled(
        b,
        (base[0] - uy * wing, base[1] + ux * wing),
        (base[0] + uy * wing, base[1] - ux * wing),
        colour,
    )


def label_plate(draw: imgui.ImDrawList, at: Point, words: str) -> None:
    """A short text on a plate, to the lower right of a place [px]."""
    words = tr(words)
    with font(FONTS.regular, SMALL):
        size = imgui.calc_text_size(words)
        low = (at[0] + px(14), at[1] + px(14))
        high = (low[0] + size.x + px(12), low[1] + size.y + px(6))
        draw.add_rect_filled(low, high, u32(alpha(COLOURS.raised, 0.94)), px(5))
        draw.add_rect(low, high, u32(COLOURS.line), px(5))
        draw.add_text((low[0] + px(6), low[1] + px(3)), u32(COLOURS.text), words)


@dataclasses.dataclass(kw_only=True)
class Room:
    """The places on the screen that labels have taken, so that none covers another."""

    taken: list[tuple[Point, Point]] = dataclasses.field(default_factory=list)

    def take(self, low: Point, high: Point) -> bool:
        """Take a rectangle [px] if it is free; returns whether it was."""
        for other_low, other_high in self.taken:
            beside = low[0] >= other_high[0] or high[0] <= other_low[0]
            if not beside and low[1] < other_high[1] and high[1] > other_low[1]:
                return False
        self.taken.append((low, high))
        return True
