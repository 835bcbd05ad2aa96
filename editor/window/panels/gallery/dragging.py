"""Cards that are dragged: taken up from the grid, let go over a folder or the set."""

from typing import TYPE_CHECKING, Final

from imgui_bundle import imgui

from editor.base.language import tr
from editor.gallery.card import Card
from editor.toolkit import widgets
from editor.toolkit.appearance import COLOURS, SMALL, alpha

if TYPE_CHECKING:
    from editor.session import Session

_PAYLOAD: Final = "level"
"""Payload of dragged cards."""


def take_up(session: "Session", card: Card) -> None:
    """Let the card drawn last, or all that are chosen with it, be dragged."""
    # Dear ImGui shows what is dragged at .6 of this opacity, and pictures would shine through.
    with widgets.coloured(popup_bg=alpha(COLOURS.surface, 1 / 0.6)):
        taken = imgui.begin_drag_drop_source()
    if not taken:
        return
    gallery = session.gallery
    if card.path not in gallery.selection:
        gallery.selection = (card.path,)
        gallery.focus = card.path
    imgui.set_drag_drop_payload_py_id(_PAYLOAD, 1)
    count = len(gallery.chosen(session.library, session.results))
    widgets.raw(card.name if count == 1 else tr(f"{count} levels"))
    with widgets.font(None, SMALL):
        widgets.raw(tr("Onto a folder: moves; with Ctrl, copies"), COLOURS.muted)
        widgets.raw(tr("Onto Set: takes it in"), COLOURS.muted)
    imgui.end_drag_drop_source()


def dragging() -> bool:
    """Return whether something is being dragged."""
    return imgui.get_drag_drop_payload_py_id() is not None


def let_go_here() -> bool:
    """Return whether cards are let go over the widget drawn last, and mark it while they hover."""
    return _taken(imgui.begin_drag_drop_target())


def let_go_in_window() -> bool:
    """Return whether cards are let go over any place of the window that is being drawn."""
    low, size = imgui.get_window_pos(), imgui.get_window_size()
    rect = imgui.internal.ImRect((low.x, low.y), (low.x + size.x, low.y + size.y))
    window = imgui.get_id("side-target")
    return _taken(imgui.internal.begin_drag_drop_target_custom(rect, window))


def _taken(over: bool) -> bool:
    """Return whether the target that was begun takes cards, and end it if it was begun."""
    if not over:
        return False
    taken = imgui.accept_drag_drop_payload_py_id(_PAYLOAD) is not None
    imgui.end_drag_drop_target()
    return taken
