"""The history: everything that was done, by name; a click goes there."""

from typing import TYPE_CHECKING

from imgui_bundle import imgui

from editor.base.language import tr
from editor.toolkit import widgets
from editor.toolkit.appearance import COLOURS, Icons
from editor.window.panels.base import Panel

if TYPE_CHECKING:
    from editor.session import Session


class HistoryPanel(Panel):
    """Lists the snapshots of the document in front."""

    id, title, icon = "history", "History", Icons.history

    def __init__(self) -> None:
        self._seen = (-1, -1)

    def draw(self, session: "Session") -> None:
        """Draw the list, the present moment marked."""
        history = session.document.history
        moment = (len(history.entries), history.cursor)
        with widgets.disabled(not session.editing):
            for index, entry in enumerate(history.entries):
                ahead = index > history.cursor
                current = index == history.cursor
                icon = Icons.open if index == 0 else (Icons.redo if ahead else Icons.good)
                with widgets.coloured(text=COLOURS.faint if ahead else COLOURS.text):
                    label = widgets.labelled(tr(f"{icon}  {entry.label}"), f"history-{index}")
                    if imgui.selectable(label, current)[0]:
                        session.queue(lambda index=index: session.document.jump(index))
                widgets.probe(session, f"history.{index}")
                if current and moment != self._seen:
                    imgui.set_scroll_here_y(0.6)
        if len(history.entries) == 1:
            widgets.small("Every change appears here. Ctrl+Z undoes, Ctrl+Shift+Z redoes.")
        self._seen = moment
