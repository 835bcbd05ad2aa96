"""The words on the tabs of panels: as many as their places have room for."""

from collections.abc import Collection, Iterable

from imgui_bundle import imgui

from editor.base.language import tr
from editor.toolkit.appearance import Icons
from editor.window.panels.base import Panel


class TabWords:
    """Chooses per place: words on all tabs, on the tab in front alone, or signs alone.

    The tab in front gives up its sign before its word.
    """

    def __init__(self) -> None:
        self._places: dict[str, tuple[int, float]] = {}
        """Dock node and its room for tabs [px], by the id of a panel; of the last frame."""
        self._worded: frozenset[str] = frozenset()
        """Ids of the panels whose tabs have words."""
        self._signless: frozenset[str] = frozenset()
        """Ids of the panels whose tabs have words alone."""

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
        worded, signless = set(floating), set()
        for (_, room), row in rows.items():
            ahead = {panel.id for panel in row if panel.id in front}
            everyone = {panel.id for panel in row}
            for words, alone in ((everyone, set()), (ahead, set()), (ahead, ahead)):
                if sum(_width(_words(panel, words, alone)) for panel in row) <= room:
                    worded |= words
                    signless |= alone
                    break
        self._worded, self._signless = frozenset(worded), frozenset(signless)

    def has_words(self, panel: Panel) -> bool:
        """Return whether a panel's tab has words in this frame."""
        return panel.id in self._worded

    def name(self, panel: Panel) -> str:
        """Return a panel's title as its tab has it, with a stable identity."""
        return f"{_words(panel, self._worded, self._signless)}###panel-{panel.id}"

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
            # Dear ImGui leaves as much free at both ends as inside of a tab.
            spare = 2 * imgui.get_style().frame_padding.x + (_width(Icons.better) if folds else 0)
            self._places[panel.id] = (node.id_, node.size.x - spare)


def _words(panel: Panel, worded: Collection[str], signless: Collection[str]) -> str:
    """Return the title of a panel's tab."""
    if panel.id not in worded:
        return panel.icon
    return tr(panel.title) if panel.id in signless else f"{panel.icon}  {tr(panel.title)}"


def _width(words: str) -> float:
    """Return the width of a tab with the gap behind it [px]."""
    style = imgui.get_style()
    edge = 2 * style.frame_padding.x + 1 + style.item_inner_spacing.x
    return imgui.calc_text_size(words).x + edge
