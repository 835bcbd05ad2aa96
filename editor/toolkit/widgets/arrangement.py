"""Sections, property rows, gaps and raised windows."""

import contextlib
from collections.abc import Iterator
from typing import Final

from imgui_bundle import imgui

from editor.base.language import tr
from editor.toolkit import draw_list
from editor.toolkit.appearance import COLOURS, FONTS, SMALL, alpha, u32
from editor.toolkit.widgets.base import font, px
from editor.toolkit.widgets.words import muted, tooltip

ROW_LABEL: Final = 0.33
"""Share of a property row's width that its label gets."""


def section(title: str, *, opened: bool = True) -> bool:
    """A heading that folds; returns whether what follows is to be drawn."""
    storage, key = imgui.get_state_storage(), imgui.get_id(f"section-{title}")
    is_open = storage.get_bool(key, opened)
    imgui.dummy((0, px(3)))
    start, width = imgui.get_cursor_screen_pos(), imgui.get_content_region_avail().x
    height = imgui.get_text_line_height() + px(6)
    nav = imgui.ButtonFlags_.enable_nav.value
    if imgui.invisible_button(f"section-{title}", (max(width, 1.0), height), nav):
        is_open = not is_open
        storage.set_bool(key, is_open)
    colour = u32(COLOURS.text if imgui.is_item_hovered() else COLOURS.muted)
    draw = imgui.get_window_draw_list()
    middle = start.y + height / 2
    with font(FONTS.bold, SMALL - 1):
        words = tr(title).upper()
        size = imgui.calc_text_size(words)
        draw.add_text((start.x + px(14), middle - size.y / 2), colour, words)
        left = start.x + px(22) + size.x
    _chevron(draw, (start.x + px(4), middle), colour, down=is_open)
    draw.add_line((left, middle), (start.x + width, middle), u32(COLOURS.line), px(1))
    return is_open


def _chevron(draw: imgui.ImDrawList, at: tuple[float, float], colour: int, *, down: bool) -> None:
    """A small open arrow head, as headings that fold carry it."""
    r = px(3.5)
    if down:
        points = [(at[0] - r, at[1] - r / 2), (at[0], at[1] + r / 2), (at[0] + r, at[1] - r / 2)]
    else:
        points = [(at[0] - r / 2, at[1] - r), (at[0] + r / 2, at[1]), (at[0] - r / 2, at[1] + r)]
    draw_list.stroke(draw, points, colour, px(1.6))


@contextlib.contextmanager
def property_table(name: str, *, label: float = ROW_LABEL) -> Iterator[bool]:
    """Rows of label and field, the label's share of the width given; draw them with `row`."""
    flags = imgui.TableFlags_.sizing_stretch_prop.value | imgui.TableFlags_.no_pad_outer_x.value
    opened = imgui.begin_table(name, 2, flags)
    if opened:
        stretch = imgui.TableColumnFlags_.width_stretch.value
        imgui.table_setup_column("label", stretch, label)
        imgui.table_setup_column("field", stretch, 1 - label)
    try:
        yield opened
    finally:
        if opened:
            imgui.end_table()


def row(label: str, detail: str = "") -> None:
    """Begin a row of a property table: writes the label, leaves the cursor at the field."""
    imgui.table_next_row()
    imgui.table_next_column()
    imgui.align_text_to_frame_padding()
    muted(label)
    if detail:
        tooltip(label, detail)
    imgui.table_next_column()
    imgui.set_next_item_width(-1.0)


def beside(width: float, *, gap: float = 14) -> None:
    """Go on in the same line where the next item has room, else in the next line.

    Args:
        width: Of the next item [px at 100 %].
        gap: Space before it, in the same unit.
    """
    edge = imgui.get_cursor_screen_pos().x + imgui.get_content_region_avail().x
    if imgui.get_item_rect_max().x + px(gap + width) <= edge:
        imgui.same_line(0, px(gap))


def beside_words(words: str, *, gap: float = 8) -> None:
    """Go on in the same line where a button with these words has room, else in the next line."""
    padding = 2 * imgui.get_style().frame_padding.x
    beside((imgui.calc_text_size(tr(words)).x + padding) / px(1), gap=gap)


def separator_gap() -> None:
    """A thin upright line between groups of a bar."""
    imgui.same_line(0, px(8))
    at = imgui.get_cursor_screen_pos()
    height = imgui.get_frame_height()
    imgui.get_window_draw_list().add_line(
        (at.x, at.y + px(4)), (at.x, at.y + height - px(4)), u32(COLOURS.line), px(1)
    )
    imgui.dummy((px(1), height))
    imgui.same_line(0, px(8))


def spinner(radius: float, *, framed: bool = False) -> None:
    """A turning arc: something is being done; `framed`: on a line with buttons."""
    r = px(radius)
    at = imgui.get_cursor_screen_pos()
    height = imgui.get_frame_height() if framed else imgui.get_text_line_height()
    centre = (at.x + r, at.y + height / 2)
    draw = imgui.get_window_draw_list()
    start = imgui.get_time() * 5.0
    draw.add_circle(centre, r - px(1), u32(alpha(COLOURS.accent, 0.2)), 0, px(2))
    draw.path_arc_to(centre, r - px(1), start, start + 1.8)
    draw.path_stroke(u32(COLOURS.accent), px(2))
    imgui.dummy((2 * r, height))


_RAISED: Final = (
    imgui.WindowFlags_.no_docking.value
    | imgui.WindowFlags_.no_saved_settings.value
    | imgui.WindowFlags_.no_collapse.value
    | imgui.WindowFlags_.no_resize.value
    | imgui.WindowFlags_.no_title_bar.value
)


@contextlib.contextmanager
def raised_window(name: str, width: float, height: float) -> Iterator[None]:
    """A window in the middle of the app, in front when it appears, as large as there is room.

    Args:
        name: Its id.
        width: At scale 1 [px].
        height: At scale 1 [px].
    """
    viewport = imgui.get_main_viewport()
    size = viewport.work_size
    centre = (viewport.work_pos.x + size.x / 2, viewport.work_pos.y + size.y / 2)
    imgui.set_next_window_pos(centre, 0, (0.5, 0.5))
    imgui.set_next_window_size((min(px(width), size.x * 0.94), min(px(height), size.y * 0.92)))
    imgui.push_style_color(imgui.Col_.window_bg, imgui.ImVec4(*COLOURS.raised))
    imgui.push_style_var(imgui.StyleVar_.window_padding, imgui.ImVec2(px(22), px(18)))
    imgui.push_style_var(imgui.StyleVar_.window_border_size, 1.0)
    imgui.begin(f"###{name}", None, _RAISED)
    if imgui.is_window_appearing():
        imgui.set_window_focus()
    yield
    imgui.end()
    imgui.pop_style_var(2)
    imgui.pop_style_color()
