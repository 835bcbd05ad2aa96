"""Switches of the debug drawing."""

from typing import TYPE_CHECKING

from imgui_bundle import imgui

from editor import widgets
from editor.debug_draw import LAYERS, SIMULATED
from editor.look import Icons
from editor.panels.base import Panel

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
        if changed:
            session.view.debug_draw = on
        imgui.separator()
        columns = max(1, int(imgui.get_content_region_avail().x / widgets.px(168)))
        if imgui.begin_table("layers", columns):
            for name, label in LAYERS.items():
                imgui.table_next_column()
                changed, on = widgets.checkbox(
                    session, f"debug.{name}", label, name in settings.debug_draw
                )
                if name in SIMULATED:
                    widgets.tooltip(label, "Shows while the level is played.")
                if changed:
                    kept = [other for other in settings.debug_draw if other != name]
                    settings.debug_draw = [*kept, name] if on else kept
                    session.view.debug_draw = session.view.debug_draw or on
            imgui.end_table()
