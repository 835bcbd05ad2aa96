"""The words on the tabs of panels: as many as their places have room for."""

from collections.abc import Collection, Iterable
from typing import Final

from imgui_bundle import imgui

from editor.base.language import tr
from editor.toolkit.widgets import px
from editor.window.panels.base import Panel

_EDGES: Final = 14.0
"""Room for the edges of a row of tabs [px at 100 %]."""
_FOLD: Final = 30.0
"""Room for the button that folds it [px at 100 %]."""


class TabWords:
    """Chooses per place: words on all tabs, on the tab in front alone, or signs alone."""

    def __init__(self) -> None:
        self._places: dict[str, tuple[int, float]] = {}
        """Dock node and its room for tabs [px], by the id of a panel; of the last frame."""
        self._worded: frozenset[str] = frozenset()
        """Ids of the panels whose tabs have words."""

    def choose(self, panels: Iterable[Panel], front: Collection[str]) -> None:
        """Choose for this frame.

        Args:
            panels: All of them.
            front: Ids of those whose tab is in front.
        """
        rows: dict[tuple[int, float], list[Panel]] = {}
        floating = set()
        for panel in panels:
            place = self._places.get(panel.id)
            if place is None:
                floating.add(panel.id)
            else:
                rows.setdefault(place, []).append(panel)
        worded = set(floating)
        for (_, room), row in rows.items():
            ahead = [panel for panel in row if panel.id in front]
            if _width(row, row) <= room:
                worded |= {panel.id for panel in row}
            elif _width(row, ahead) <= room:
                worded |= {panel.id for panel in ahead}
        self._worded = frozenset(worded)

    def has_words(self, panel: Panel) -> bool:
        """Return whether a panel's tab has words in this frame."""
        return panel.id in self._worded

    def name(self, panel: Panel) -> str:
        """Return a panel's title as its tab has it, with a stable identity."""
        return panel.window_name if self.has_words(panel) else f"{panel.icon}###panel-{panel.id}"

    def note(self, panel: Panel, *, folds: bool) -> None:
        """Remember where the current window is docked.

        Args:
            panel: Whose window it is.
            folds: Whether its place has a button that folds it.
        """
        node = imgui.internal.get_window_dock_node()
        if node is None:
            self._places.pop(panel.id, None)
        else:
            spare = px(_EDGES + _FOLD if folds else _EDGES)
            self._places[panel.id] = (node.id_, node.size.x - spare)


def _width(row: Collection[Panel], worded: Collection[Panel]) -> float:
    """Return the width of a row of tabs of which some have words [px]."""
    style = imgui.get_style()
    edge = 2 * style.frame_padding.x + 1 + style.item_inner_spacing.x
    words = (f"{p.icon}  {tr(p.title)}" if p in worded else p.icon for p in row)
    return sum(imgui.calc_text_size(each).x + edge for each in words)
