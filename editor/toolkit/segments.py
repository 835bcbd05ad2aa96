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
    width = (width or imgui.get_content_region_avail().x) - gap * (len(options) - 1)
    labels = [tr(label) for _, label in options]
    shown, widths = labels, _widths(labels, width)
    if widths is None:
        # The sign alone, where there is one; the tooltip has the word.
        shown = [label.split(" ")[0] for label in labels]
        widths = _widths(shown, width)
    if widths is None:
        shown = labels
        widths = [min(_needed(label), width) for label in labels]
    imgui.push_style_var(
        imgui.StyleVar_.frame_padding,
        imgui.ImVec2(widgets.px(4), imgui.get_style().frame_padding.y),
    )
    for index, (value, _) in enumerate(options):
        if index:
            widgets.beside(widths[index] / widgets.px(1) - 0.5, gap=2)
        on = value == current
        c = COLOURS
        with widgets.coloured(
            button=c.accent_strong if on else c.field,
            button_hovered=c.accent if on else c.field_hover,
            text=(1.0, 1.0, 1.0, 1.0) if on else c.muted,
        ):
            if imgui.button(f"{shown[index]}###{name}.{value}", (widths[index], 0)):
                picked = (value,)
        widgets.probe(session, f"{name}.{value}")
        if shown[index] != labels[index]:
            widgets.tooltip(labels[index])
    imgui.pop_style_var()
    return picked


def _needed(label: str) -> float:
    return imgui.calc_text_size(label).x + 2 * widgets.px(4)


def _widths(labels: Sequence[str], room: float) -> list[float] | None:
    """Return widths of buttons for labels: equal if that will do; None if there is no room [px]."""
    needed = [_needed(label) for label in labels]
    each = room / len(labels)
    if max(needed) <= each:
        return [each] * len(labels)
    spare = (room - sum(needed)) / len(labels)
    return [width + spare for width in needed] if spare >= 0 else None
