"""The log: every message that the app gave, errors with their details."""

from typing import TYPE_CHECKING

from imgui_bundle import imgui

from editor.base.language import tr
from editor.toolkit import widgets
from editor.toolkit.appearance import COLOURS, FONTS, SMALL, Icons
from editor.window.panels.base import Panel

if TYPE_CHECKING:
    from editor.session import Session


class LogPanel(Panel):
    """Newest at the bottom; follows what is added."""

    id, title, icon = "log", "Log", Icons.log

    def __init__(self) -> None:
        self._seen = 0

    def draw(self, session: "Session") -> None:
        """Draw the lines."""
        lines = [*session.worker.log.lines, *session.log.lines]
        if not lines:
            widgets.empty_state(Icons.log, "Nothing yet", "Messages of the app are kept here.")
            return
        if imgui.small_button(tr("Copy all")):
            session.clipboard.set("\n".join(lines))
        widgets.probe(session, "log.copy")
        imgui.begin_child("lines")
        # The letters of all scripts, which the other font lacks.
        with widgets.font(FONTS.regular, SMALL):
            for line in lines:
                colour = COLOURS.bad if line.startswith("Traceback") else COLOURS.muted
                widgets.wrapped(line.rstrip(), colour)
        if len(lines) != self._seen:
            imgui.set_scroll_here_y(1.0)
            self._seen = len(lines)
        imgui.end_child()
