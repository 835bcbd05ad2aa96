"""Keys as they look on a keyboard."""

from typing import Final

from imgui_bundle import imgui

from editor.toolkit.appearance import COLOURS, FONTS, SMALL, alpha, u32
from editor.toolkit.widgets.base import font, px

_CAP_GAP: Final = 3.0
"""Room between two key caps [px at 100 %]."""


def key_cap(label: str, *, lit: bool = False) -> None:
    """One key as a small plate."""
    line = imgui.get_text_line_height()
    with font(FONTS.bold, SMALL - 1):
        size = imgui.calc_text_size(label)
        width, height = _cap_width(label), size.y + px(4)
        at = imgui.get_cursor_screen_pos()
        offset = (line - height) / 2
        draw = imgui.get_window_draw_list()
        low = (at.x, at.y + offset)
        high = (at.x + width, at.y + offset + height)
        draw_key_plate(draw, low, high, lit=lit)
        colour = u32(COLOURS.backdrop if lit else COLOURS.text)
        draw.add_text((at.x + (width - size.x) / 2, low[1] + (height - size.y) / 2), colour, label)
        imgui.dummy((width, line))


def draw_key_plate(
    draw: imgui.ImDrawList,
    low: tuple[float, float],
    high: tuple[float, float],
    *,
    lit: bool,
    opacity: float = 1.0,
) -> None:
    """The plate of a key cap."""
    face = COLOURS.accent if lit else COLOURS.field_hover
    height = high[1] - low[1]
    rounding, drop = min(px(4), 0.25 * height), min(px(1.5), 0.09 * height)
    shadow = (low[0], low[1] + drop), (high[0], high[1] + drop)
    draw.add_rect_filled(*shadow, u32(alpha(COLOURS.backdrop, 0.9 * opacity)), rounding)
    draw.add_rect_filled(low, high, u32(alpha(face, opacity)), rounding)
    draw.add_rect(low, high, u32(alpha(COLOURS.text, 0.18 * opacity)), rounding)


def key_caps(keys: str) -> None:
    """A chord as a row of plates: `"Ctrl+Z"` is two."""
    for index, part in enumerate(_caps_of(keys)):
        if index:
            imgui.same_line(0, px(_CAP_GAP))
        key_cap(part)


def width_of_caps(keys: str) -> float:
    """Return the width of a chord's plates [px]."""
    parts = _caps_of(keys)
    with font(FONTS.bold, SMALL - 1):
        return sum(map(_cap_width, parts)) + px(_CAP_GAP) * (len(parts) - 1)


def _cap_width(label: str) -> float:
    """Return the width of a plate in the present font [px]."""
    size = imgui.calc_text_size(label)
    return max(size.x + 2 * px(5), size.y + px(5))


def _caps_of(keys: str) -> list[str]:
    return keys.split("+") if not keys.endswith("+") else [*keys[:-2].split("+"), "+"]
