"""Switches of the debug drawing."""

from typing import TYPE_CHECKING

from imgui_bundle import imgui

from editor.actions import view
from editor.drawing.debug_draw import LAYERS, SIMULATED
from editor.toolkit import widgets
from editor.toolkit.appearance import Icons
from editor.window.panels.base import Panel

if TYPE_CHECKING:
    from editor.session import Session


class DebugPanel(Panel):
    """One box a layer; they are kept between runs."""

    id, title, icon = "debug", "Debug", Icons.debug

    def draw(self, session: "Session") -> None:
        """Draw the boxes, as many columns as fit."""
        settings = session.settings
        changed, on = widgets.checkbox(
            session, "debug.all", "Debug drawing", session.view.debug_draw
        )
        if changed and on != session.view.debug_draw:
            session.queue("view.debug_draw")
        imgui.separator()
        columns = max(1, int(imgui.get_content_region_avail().x / widgets.px(168)))
        if imgui.begin_table("layers", columns):
            for name, label in LAYERS.items():
                imgui.table_next_column()
                on = session.view.debug_draw and name in settings.debug_draw
                changed, _ = widgets.checkbox(session, f"debug.{name}", label, on)
                if name in SIMULATED:
                    widgets.tooltip(label, "Shows while the level is played.")
                if changed:
                    view.toggle_drawing(session, name)
            imgui.end_table()
