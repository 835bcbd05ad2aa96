"""Small building blocks of the panels: buttons, property rows, key caps, badges, probe rectangles.

Every widget that a person can click notes its rectangle in `session.probe` under a stable id, so
that tests and replays can point at it by name.
"""

import contextlib
import dataclasses
from collections.abc import Iterator, Sequence
from typing import TYPE_CHECKING, Final

from imgui_bundle import imgui

from editor.base.language import tr
from editor.toolkit import draw_list
from editor.toolkit.appearance import COLOURS, FONTS, SMALL, TITLE, Icons, Rgba, alpha, u32

if TYPE_CHECKING:
    from editor.session import Session

ROW_LABEL: Final = 0.33
"""Share of a property row's width that its label gets."""
_CAP_GAP: Final = 3.0
"""Room between two key caps [px at 100 %]."""
MIXED: Final = "—"
"""Text of a field when the selected things differ."""


@dataclasses.dataclass(frozen=True, kw_only=True)
class Probe:
    """Place of a widget."""

    low: tuple[float, float]
    high: tuple[float, float]
    enabled: bool
    frame: int

    @property
    def centre(self) -> tuple[float, float]:
        """The middle [px]."""
        return (self.low[0] + self.high[0]) / 2, (self.low[1] + self.high[1]) / 2


def probe(session: "Session", name: str, *, enabled: bool = True) -> None:
    """Note the rectangle of the last widget under a name."""
    low, high = imgui.get_item_rect_min(), imgui.get_item_rect_max()
    session.probe[name] = Probe(
        low=(low.x, low.y), high=(high.x, high.y), enabled=enabled, frame=imgui.get_frame_count()
    )


def px(value: float) -> float:
    """A length of the design [px at 100 %] at the present scale."""
    style = imgui.get_style()
    # Room grows with the text, or words would be cut off.
    return value * style.font_scale_dpi * style.font_scale_main


@contextlib.contextmanager
def font(kind: imgui.ImFont | None, size: float = 0.0) -> Iterator[None]:
    """Another font or size [px at 100 %; 0 keeps it] for what is drawn inside."""
    imgui.push_font(kind, size)
    try:
        yield
    finally:
        imgui.pop_font()


@contextlib.contextmanager
def coloured(**colours: Rgba) -> Iterator[None]:
    """Other style colours, by their names in `imgui.Col_`, for what is drawn inside."""
    for name, value in colours.items():
        imgui.push_style_color(getattr(imgui.Col_, name), imgui.ImVec4(*value))
    try:
        yield
    finally:
        imgui.pop_style_color(len(colours))


@contextlib.contextmanager
def disabled(when: bool) -> Iterator[None]:
    """Greyed out and inert, if so."""
    imgui.begin_disabled(when)
    try:
        yield
    finally:
        imgui.end_disabled()


def raw(words: str, colour: Rgba | None = None) -> None:
    """A line of text as it is, in no other language; percent signs mean themselves."""
    imgui.push_style_color(imgui.Col_.text, imgui.ImVec4(*(colour or COLOURS.text)))
    imgui.text_unformatted(words)
    imgui.pop_style_color()


def text(words: str, colour: Rgba | None = None) -> None:
    """A line of text in the language of the app."""
    raw(tr(words), colour)


def muted(words: str) -> None:
    """A quiet line of text."""
    text(words, COLOURS.muted)


def wrapped(words: str, colour: Rgba | None = None) -> None:
    """Text that breaks at the panel's edge."""
    imgui.push_text_wrap_pos(0.0)
    text(words, colour)
    imgui.pop_text_wrap_pos()


def small(words: str, colour: Rgba | None = None) -> None:
    """Small print."""
    with font(None, SMALL):
        wrapped(words, colour or COLOURS.muted)


def tooltip(title: str, detail: str = "", keys: str = "") -> None:
    """Explains the last widget while the mouse rests on it (or the keyboard is there)."""
    if not imgui.is_item_hovered(
        imgui.HoveredFlags_.for_tooltip.value | imgui.HoveredFlags_.allow_when_disabled.value
    ):
        return
    imgui.push_style_var(imgui.StyleVar_.window_padding, imgui.ImVec2(px(10), px(7)))
    if imgui.begin_tooltip():
        text(title)
        if keys:
            imgui.same_line(0, px(12))
            key_caps(keys)
        if detail:
            imgui.push_text_wrap_pos(px(320))
            with font(None, SMALL):
                muted(detail)
            imgui.pop_text_wrap_pos()
        imgui.end_tooltip()
    imgui.pop_style_var()


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


def badge(words: str, colour: Rgba, *, filled: bool = False) -> None:
    """A word in a coloured lozenge."""
    words = tr(words)
    line = imgui.get_text_line_height()
    with font(FONTS.bold, SMALL - 1):
        size = imgui.calc_text_size(words)
        pad, height = px(7), size.y + px(4)
        at = imgui.get_cursor_screen_pos()
        low = (at.x, at.y + (line - height) / 2)
        high = (at.x + size.x + 2 * pad, low[1] + height)
        draw = imgui.get_window_draw_list()
        draw.add_rect_filled(low, high, u32(alpha(colour, 0.95 if filled else 0.18)), px(5))
        ink = COLOURS.backdrop if filled else colour
        draw.add_text((at.x + pad, low[1] + (height - size.y) / 2), u32(ink), words)
        imgui.dummy((size.x + 2 * pad, line))


def icon_button(  # noqa: PLR0913 - one button has that many looks
    session: "Session",
    name: str,
    icon: str,
    *,
    label: str = "",
    on: bool = False,
    enabled: bool = True,
    tint: Rgba | None = None,
    height: float = 0.0,
) -> bool:
    """A flat button with a sign and perhaps a word; `on` lights it.

    Args:
        session: Whose probe notes it.
        name: Its stable id.
        icon: The sign.
        label: The word beside it.
        on: Whether what it switches is on.
        enabled: Whether it can be pressed.
        tint: Colour of the sign; None for the text's.
        height: Its height [px]; 0 for a field's.

    Returns:
        Whether it was pressed.
    """
    c = COLOURS
    words = f"{icon}  {tr(label)}" if label else icon
    size = imgui.calc_text_size(words)
    height = height or imgui.get_frame_height()
    width = max(size.x + 2 * px(8), height)
    with (
        disabled(not enabled),
        coloured(
            button=alpha(c.accent, 0.24) if on else (0.0, 0.0, 0.0, 0.0),
            button_hovered=alpha(c.accent, 0.34) if on else c.field_hover,
            button_active=alpha(c.accent, 0.44) if on else c.field_active,
            text=tint or (c.text if on or label else c.muted),
        ),
    ):
        pressed = imgui.button(f"{words}###{name}", (width, height))
        low = imgui.get_item_rect_min()
        sign_at = (low.x + (width - size.x) / 2, low.y + (height - size.y) / 2)
        ink = imgui.get_color_u32(imgui.Col_.text)
        _enlarged(imgui.get_window_draw_list(), sign_at, ink, icon)
    probe(session, name, enabled=enabled)
    return pressed


def sign(draw: imgui.ImDrawList, at: tuple[float, float], colour: int, icon: str) -> None:
    """Draw an icon.

    Args:
        draw: Where to.
        at: Upper left corner of its line [px].
        colour: As a draw list takes it.
        icon: One of `Icons`.
    """
    draw.add_text(at, colour, icon)
    _enlarged(draw, at, colour, icon)


def _enlarged(draw: imgui.ImDrawList, at: tuple[float, float], colour: int, icon: str) -> None:
    """Draw the triangle as large as the other shapes: the font has only a small one."""
    if icon != Icons.triangle:
        return
    size = imgui.calc_text_size(icon)
    x, y, r = at[0] + size.x / 2, at[1] + size.y / 2, px(7)
    draw.add_triangle_filled((x, y - r * 0.9), (x + r, y + r * 0.8), (x - r, y + r * 0.8), colour)


def primary_button(session: "Session", name: str, label: str, *, width: float = 0.0) -> bool:
    """The button that Enter would press."""
    c = COLOURS
    with coloured(
        button=c.accent_strong,
        button_hovered=c.accent,
        button_active=alpha(c.accent, 0.8),
        text=(1.0, 1.0, 1.0, 1.0),
    ):
        pressed = imgui.button(f"{tr(label)}###{name}", (width, 0))
    probe(session, name)
    return pressed


def button(session: "Session", name: str, label: str, *, width: float = 0.0) -> bool:
    """An ordinary button."""
    pressed = imgui.button(f"{tr(label)}###{name}", (width, 0))
    probe(session, name)
    return pressed


def checkbox(
    session: "Session", name: str, label: str, value: bool, *, mixed: bool = False
) -> tuple[bool, bool]:
    """A box to tick; `mixed` shows a dash. Returns whether it changed, and to what."""
    imgui.push_item_flag(imgui.ItemFlags_.mixed_value.value, mixed)
    changed, value = imgui.checkbox(f"{tr(label)}###{name}", value)
    imgui.pop_item_flag()
    probe(session, name)
    return changed, value


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


def empty_state(icon: str, title: str, hint: str) -> None:
    """Draw the text of a panel that has nothing to show: its purpose and how to fill it."""
    space = imgui.get_content_region_avail()
    imgui.dummy((0, max(min(space.y * 0.18, px(40)), px(6))))
    for words, size, colour in (
        (icon, TITLE + 4, COLOURS.faint),
        (title, 0.0, COLOURS.text),
    ):
        with font(FONTS.bold if size == 0.0 else None, size):
            width = imgui.calc_text_size(tr(words)).x
            imgui.set_cursor_pos_x(imgui.get_cursor_pos_x() + max((space.x - width) / 2, 0))
            text(words, colour)
    centred_lines(hint, min(space.x - px(12), px(280)))


def centred_lines(words: str, width: float) -> None:
    """Small text broken to a width, each line in the middle of the panel."""
    with font(None, SMALL):
        space = imgui.get_content_region_avail().x
        for line in broken(tr(words), width):
            offset = (space - imgui.calc_text_size(line).x) / 2
            imgui.set_cursor_pos_x(imgui.get_cursor_pos_x() + max(offset, 0))
            raw(line, COLOURS.muted)


def broken(words: str, width: float) -> list[str]:
    """Text broken at spaces so that no line is wider than `width` [px]."""
    lines: list[str] = []
    for paragraph in words.split("\n"):
        line = ""
        for word in paragraph.split(" "):
            longer = f"{line} {word}".strip()
            if line and imgui.calc_text_size(longer).x > width:
                lines.append(line)
                line = word
            else:
                line = longer
        lines.append(line)
    return lines


def beside(width: float, *, gap: float = 14) -> None:
    """Go on in the same line where the next item has room, else in the next line.

    Args:
        width: Of the next item [px at 100 %].
        gap: Before it, likewise.
    """
    right = imgui.get_window_pos().x + imgui.get_window_width()
    edge = right - imgui.get_style().window_padding.x
    if imgui.get_item_rect_max().x + px(gap + width) < edge:
        imgui.same_line(0, px(gap))


def separator_gap(width: float = 8.0) -> None:
    """A thin upright line between groups of a bar."""
    imgui.same_line(0, px(width))
    at = imgui.get_cursor_screen_pos()
    height = imgui.get_frame_height()
    imgui.get_window_draw_list().add_line(
        (at.x, at.y + px(4)), (at.x, at.y + height - px(4)), u32(COLOURS.line), px(1)
    )
    imgui.dummy((px(1), height))
    imgui.same_line(0, px(width))


def spinner(radius: float, colour: Rgba | None = None) -> None:
    """A turning arc: something is being done."""
    r = px(radius)
    at = imgui.get_cursor_screen_pos()
    height = imgui.get_text_line_height()
    centre = (at.x + r, at.y + height / 2)
    draw = imgui.get_window_draw_list()
    start = imgui.get_time() * 5.0
    draw.add_circle(centre, r - px(1), u32(alpha(colour or COLOURS.accent, 0.2)), 0, px(2))
    draw.path_arc_to(centre, r - px(1), start, start + 1.8)
    draw.path_stroke(u32(colour or COLOURS.accent), px(2))
    imgui.dummy((2 * r, height))


def choice(
    session: "Session",
    name: str,
    current: str | None,
    options: Sequence[tuple[str, str]],
    *,
    preview: str = "",
) -> str | None:
    """A drop-down list.

    Args:
        session: Whose probe notes it.
        name: Its stable id.
        current: Value that is chosen; None shows `MIXED`.
        options: (value, label) in order.
        preview: What the closed list says instead of the chosen label.

    Returns:
        The value that was picked in this frame, or None.
    """
    labels = dict(options)
    picked = None
    opened = imgui.begin_combo(f"###{name}", tr(preview or labels.get(current or "", MIXED)))
    probe(session, name)
    if opened:
        for value, label in options:
            # A value may be empty, an id may not.
            if imgui.selectable(f"{tr(label)}###{name}.{value}", value == current)[0]:
                picked = value
            probe(session, f"{name}.{value}")
        imgui.end_combo()
    return picked


def kind_colour(kind: str) -> Rgba:
    """Return the colour of a message of a kind."""
    c = COLOURS
    return {"info": c.info, "success": c.good, "warning": c.warn, "error": c.bad}[kind]


KIND_ICONS: Final[dict[str, str]] = {
    "info": Icons.info,
    "success": Icons.good,
    "warning": Icons.warning,
    "error": Icons.error,
}


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
