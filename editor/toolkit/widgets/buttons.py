"""Buttons, boxes to tick, lists to choose from."""

import contextlib
from collections.abc import Iterator, Sequence
from typing import TYPE_CHECKING

from imgui_bundle import imgui

from editor.base.language import tr
from editor.toolkit.appearance import COLOURS, Icons, Rgba, alpha
from editor.toolkit.widgets.base import coloured, disabled, labelled, probe, px
from editor.toolkit.widgets.words import MIXED, tooltip, wrapped

if TYPE_CHECKING:
    from editor.session import Session


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
    width = icon_width(words, height)
    with (
        disabled(not enabled),
        coloured(
            button=alpha(c.accent, 0.24) if on else (0.0, 0.0, 0.0, 0.0),
            button_hovered=alpha(c.accent, 0.34) if on else c.field_hover,
            button_active=alpha(c.accent, 0.44) if on else c.field_active,
            text=tint or (c.text if on or label else c.muted),
        ),
    ):
        pressed = imgui.button(labelled(words, name), (width, height))
        low = imgui.get_item_rect_min()
        sign_at = (low.x + (width - size.x) / 2, low.y + (height - size.y) / 2)
        ink = imgui.get_color_u32(imgui.Col_.text)
        _enlarged(imgui.get_window_draw_list(), sign_at, ink, icon)
    probe(session, name, enabled=enabled)
    return pressed


def icon_width(words: str, height: float = 0.0) -> float:
    """Return the width of an icon button [px].

    Args:
        words: Its sign, and perhaps a word.
        height: Its height [px]; 0 for a field's.
    """
    return max(imgui.calc_text_size(words).x + 2 * px(8), height or imgui.get_frame_height())


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
        pressed = imgui.button(labelled(tr(label), name), (width, 0))
    probe(session, name)
    return pressed


def button(session: "Session", name: str, label: str, *, width: float = 0.0) -> bool:
    """Draw an ordinary button."""
    pressed = imgui.button(labelled(tr(label), name), (width, 0))
    probe(session, name)
    return pressed


def checkbox(
    session: "Session",
    name: str,
    label: str,
    value: bool,
    *,
    mixed: bool = False,
    enabled: bool = True,
) -> tuple[bool, bool]:
    """Draw a box to tick; `mixed` shows a dash. Returns whether it changed, and to what.

    Words that have no room beside the box are broken.
    """
    words = tr(label)
    gap = imgui.get_style().item_inner_spacing.x
    room = imgui.get_content_region_avail().x - imgui.get_frame_height() - gap
    fits = imgui.calc_text_size(words).x <= room
    imgui.begin_group()
    imgui.begin_disabled(not enabled)
    imgui.push_item_flag(imgui.ItemFlags_.mixed_value.value, mixed)
    with _bordered():
        changed, value = imgui.checkbox(f"{words if fits else ''}###{name}", value)
    imgui.pop_item_flag()
    if not fits:
        imgui.same_line(0, gap)
        imgui.align_text_to_frame_padding()
        wrapped(label)
        if enabled and imgui.is_item_clicked():
            changed, value = True, not value
    imgui.end_disabled()
    imgui.end_group()
    probe(session, name, enabled=enabled)
    return changed, value


def radio(session: "Session", name: str, label: str, on: bool) -> bool:
    """One of several that exclude each other; returns whether it was chosen."""
    with _bordered():
        pressed = imgui.radio_button(labelled(tr(label), name), on)
    probe(session, name)
    return pressed


@contextlib.contextmanager
def _bordered() -> Iterator[None]:
    """Give boxes a border: an empty one has next to no contrast to a panel."""
    imgui.push_style_var(imgui.StyleVar_.frame_border_size, 1.0)
    with coloured(border=COLOURS.faint):
        yield
    imgui.pop_style_var()


def clear_button(session: "Session", field: str) -> bool:
    """Draw the cross beside a field with text in it; returns whether it was pressed.

    Args:
        session: Whose probe notes it.
        field: Id of the field.
    """
    imgui.same_line(0, px(2))
    pressed = icon_button(session, f"{field}.clear", Icons.close, tint=COLOURS.faint)
    tooltip("Clear")
    return pressed


def choice(
    session: "Session",
    name: str,
    current: str | None,
    options: Sequence[tuple[str, str]],
    *,
    preview: str = "",
) -> str | None:
    """Draw a drop-down list.

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
            if imgui.selectable(labelled(tr(label), f"{name}.{value}"), value == current)[0]:
                picked = value
            probe(session, f"{name}.{value}")
        imgui.end_combo()
    return picked
