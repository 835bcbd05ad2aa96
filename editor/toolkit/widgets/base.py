"""Shared by all widgets: probe rectangles, lengths, fonts, colours."""

import contextlib
import dataclasses
from collections.abc import Iterator
from typing import TYPE_CHECKING, Final

from imgui_bundle import imgui

from editor.toolkit.appearance import Rgba

if TYPE_CHECKING:
    from editor.session import Session


_APART: Final = "#\u200b"
"""The sign with a space of no width behind it."""


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


def labelled(words: str, identity: str) -> str:
    """Return words and an id as Dear ImGui takes them.

    It cuts words at the first `##`, which names may have: a space of no width keeps signs apart.
    """
    return f"{words.replace('#', _APART)}###{identity}"


def px(value: float) -> float:
    """Return a length of the design [px at 100 %] at the present scale."""
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
