"""Fonts, colours and sizes of the app, at any scale."""

from pathlib import Path

import imgui_bundle
from imgui_bundle import imgui, implot

from editor.base.settings import SCALES
from editor.toolkit.appearance import COLOURS, DARK, FONTS, TEXT, THEMES, Rgba, alpha

_FONT_FOLDER = Path(imgui_bundle.__file__).parent / "assets" / "fonts"
_ICON_FONT = _FONT_FOLDER / "Font_Awesome_6_Free-Solid-900.otf"


def _merge_icons() -> None:
    config = imgui.ImFontConfig()
    config.merge_mode = True
    config.pixel_snap_h = True
    # Icons are drawn a little smaller than letters and sit on the same optical middle.
    config.glyph_min_advance_x = 17.0
    config.glyph_offset = imgui.ImVec2(0.0, 0.5)
    imgui.get_io().fonts.add_font_from_file_ttf(str(_ICON_FONT), 12.5, config)


def _font(name: str, size: float) -> imgui.ImFont:
    font = imgui.get_io().fonts.add_font_from_file_ttf(str(_FONT_FOLDER / name), size)
    _merge_icons()
    return font


def load_fonts() -> None:
    """Load the fonts into the current context; they grow and shrink without reloading."""
    FONTS.regular = _font("Roboto/Roboto-Regular.ttf", TEXT)
    FONTS.bold = _font("Roboto/Roboto-Bold.ttf", TEXT)
    FONTS.mono = _font("Inconsolata-Medium.ttf", TEXT)
    imgui.get_io().font_default = FONTS.regular


def _colour_table() -> dict[imgui.Col_, Rgba]:
    c, col = COLOURS, imgui.Col_
    clear = (0.0, 0.0, 0.0, 0.0)
    return {
        col.text: c.text,
        col.text_disabled: c.faint,
        col.window_bg: c.surface,
        col.child_bg: clear,
        col.popup_bg: c.raised,
        col.border: c.line,
        col.border_shadow: clear,
        col.frame_bg: c.field,
        col.frame_bg_hovered: c.field_hover,
        col.frame_bg_active: c.field_active,
        col.title_bg: c.backdrop,
        col.title_bg_active: c.backdrop,
        col.title_bg_collapsed: c.backdrop,
        col.menu_bar_bg: c.backdrop,
        col.scrollbar_bg: clear,
        col.scrollbar_grab: c.field_hover,
        col.scrollbar_grab_hovered: c.field_active,
        col.scrollbar_grab_active: c.faint,
        col.check_mark: c.accent,
        col.checkbox_selected_bg: alpha(c.accent, 0.25),
        col.slider_grab: c.accent,
        col.slider_grab_active: c.accent,
        col.button: c.field,
        col.button_hovered: c.field_hover,
        col.button_active: c.field_active,
        col.header: alpha(c.accent, 0.22),
        col.header_hovered: alpha(c.text, 0.07),
        col.header_active: alpha(c.accent, 0.32),
        col.separator: c.line,
        col.separator_hovered: alpha(c.accent, 0.6),
        col.separator_active: c.accent,
        col.resize_grip: clear,
        col.resize_grip_hovered: alpha(c.accent, 0.4),
        col.resize_grip_active: c.accent,
        col.input_text_cursor: c.text,
        col.tab: c.backdrop,
        col.tab_hovered: c.field_hover,
        col.tab_selected: c.surface,
        col.tab_selected_overline: c.accent,
        col.tab_dimmed: c.backdrop,
        col.tab_dimmed_selected: c.surface,
        col.tab_dimmed_selected_overline: alpha(c.accent, 0.0),
        col.docking_preview: alpha(c.accent, 0.5),
        col.docking_empty_bg: c.backdrop,
        col.plot_lines: c.accent,
        col.plot_histogram: c.accent,
        col.table_header_bg: c.raised,
        col.table_border_strong: c.line,
        col.table_border_light: alpha(c.line, 0.6),
        col.table_row_bg: clear,
        col.table_row_bg_alt: alpha(c.text, 0.02),
        col.text_link: c.accent,
        col.text_selected_bg: alpha(c.accent, 0.35),
        col.tree_lines: c.line,
        col.drag_drop_target: c.accent,
        col.nav_cursor: c.accent,
        col.nav_windowing_highlight: c.accent,
        col.nav_windowing_dim_bg: alpha(c.backdrop, 0.5),
        col.modal_window_dim_bg: alpha(c.backdrop, 0.6),
        col.unsaved_marker: c.warn,
    }


def _sizes(style: imgui.Style) -> None:
    style.window_padding = imgui.ImVec2(12, 10)
    # What is docked can be folded down to its tabs.
    style.window_min_size = imgui.ImVec2(32, 26)
    style.frame_padding = imgui.ImVec2(9, 5)
    style.item_spacing = imgui.ImVec2(8, 6)
    style.item_inner_spacing = imgui.ImVec2(6, 4)
    style.cell_padding = imgui.ImVec2(6, 3)
    style.indent_spacing = 16
    style.scrollbar_size = 11
    style.scrollbar_padding = 2
    style.grab_min_size = 9
    style.window_rounding = 8
    style.child_rounding = 6
    style.popup_rounding = 8
    style.frame_rounding = 5
    style.scrollbar_rounding = 6
    style.grab_rounding = 4
    style.tab_rounding = 5
    style.selectable_rounding = 4
    style.menu_item_rounding = 4
    style.window_border_size = 0
    style.popup_border_size = 1
    style.frame_border_size = 0
    style.tab_bar_border_size = 1
    style.tab_bar_overline_size = 2
    style.docking_separator_size = 2
    style.separator_text_border_size = 1
    style.separator_text_padding = imgui.ImVec2(0, 4)
    style.window_menu_button_position = imgui.Dir.none
    style.window_title_align = imgui.ImVec2(0.0, 0.5)
    style.disabled_alpha = 0.42
    style.hover_stationary_delay = 0.2
    style.docking_node_has_close_button = False


def _reset(style: imgui.Style) -> None:
    """Undo every earlier scaling: `scale_all_sizes` multiplies whatever it finds."""
    fresh = imgui.Style()
    for name in dir(fresh):
        value = getattr(fresh, name)
        if isinstance(value, (int, float, imgui.ImVec2)) and not name.startswith("__"):
            setattr(style, name, value)


def apply(scale: float, text_scale: float = 1.0, theme: str = "dark") -> None:
    """Set style, sizes and text size of the current context.

    Args:
        scale: 1 is 100 %; kept within 75 % and 300 %.
        text_scale: Size of the text besides; kept within 80 % and 150 %.
        theme: A name of `look.THEMES`; another name is the dark one.
    """
    COLOURS.take(THEMES.get(theme, DARK))
    low, high = SCALES
    scale = min(max(scale, low), high)
    style = imgui.get_style()
    _reset(style)
    _sizes(style)
    for colour, value in _colour_table().items():
        style.set_color_(colour, imgui.ImVec4(*value))
    style.scale_all_sizes(scale)
    style.font_size_base = TEXT
    style.font_scale_main = min(max(text_scale, 0.8), 1.5)
    style.font_scale_dpi = scale
    style.circle_tessellation_max_error = 0.15
    _apply_plots()


def _apply_plots() -> None:
    if implot.get_current_context() is None:
        return
    plots = implot.get_style()
    plots.plot_border_size = 0
    plots.plot_padding = imgui.ImVec2(8, 6)
    plots.legend_padding = imgui.ImVec2(6, 4)
    for colour, value in (
        (implot.Col_.plot_bg, alpha(COLOURS.backdrop, 0.6)),
        (implot.Col_.frame_bg, (0.0, 0.0, 0.0, 0.0)),
        (implot.Col_.axis_grid, alpha(COLOURS.text, 0.16)),
        (implot.Col_.axis_text, COLOURS.muted),
        (implot.Col_.legend_bg, alpha(COLOURS.raised, 0.85)),
        (implot.Col_.legend_border, COLOURS.line),
    ):
        plots.set_color_(colour, imgui.ImVec4(*value))
