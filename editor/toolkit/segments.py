"""A row of buttons of which one is down."""

from collections.abc import Sequence
from typing import TYPE_CHECKING, Any

from imgui_bundle import imgui

from editor.base.language import tr
from editor.toolkit import widgets
from editor.toolkit.appearance import COLOURS

if TYPE_CHECKING:
    from editor.session import Session


def segments(
    session: "Session",
    name: str,
    options: Sequence[tuple[Any, str]],
    current: Any,
    *,
    width: float = 0.0,
) -> tuple[Any] | None:
    """Draw a row of buttons of which one is down.

    Args:
        session: Gets the probes.
        name: Stable id.
        options: (value, label) in order.
        current: The value that is chosen.
        width: Of the whole row [px]; 0: all there is.

    Returns:
        The value that was picked in this frame, in a tuple, or None.
    """
    picked = None
    gap = widgets.px(2)
    width = width or imgui.get_content_region_avail().x
    width = (width - gap * (len(options) - 1)) / len(options)
    room = width - 2 * widgets.px(4)
    options = [(value, tr(label)) for value, label in options]
    cramped = any(imgui.calc_text_size(label).x > room for _, label in options)
    imgui.push_style_var(
        imgui.StyleVar_.frame_padding,
        imgui.ImVec2(widgets.px(4), imgui.get_style().frame_padding.y),
    )
    for index, (value, label) in enumerate(options):
        if index:
            imgui.same_line(0, gap)
        on = value == current
        if cramped and imgui.calc_text_size(label).x > room:
            # The sign alone, where there is one; the tooltip has the word.
            shown, full = label.split(" ")[0], label
        else:
            shown, full = label, ""
        c = COLOURS
        with widgets.coloured(
            button=c.accent_strong if on else c.field,
            button_hovered=c.accent if on else c.field_hover,
            text=(1.0, 1.0, 1.0, 1.0) if on else c.muted,
        ):
            if imgui.button(f"{shown}###{name}.{value}", (width, 0)):
                picked = (value,)
        widgets.probe(session, f"{name}.{value}")
        if full:
            widgets.tooltip(full)
    imgui.pop_style_var()
    return picked
