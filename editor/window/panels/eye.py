"""The agent's observation of the moment on the screen: the picture, and the named numbers."""

from typing import TYPE_CHECKING, Final

import numpy as np
from imgui_bundle import imgui

from editor.base.language import tr
from editor.toolkit import widgets
from editor.toolkit.appearance import COLOURS, FONTS, SMALL, Icons
from editor.toolkit.textures import TextureStore
from editor.toolkit.widgets import px
from editor.window.panels.base import Panel
from editor.worker.requests import ViewTable

if TYPE_CHECKING:
    from editor.session import Session

_PICTURE: Final = 250.0
"""Largest side of the picture: twice its pixels."""


class EyePanel(Panel):
    """The picture on top, a folding table for each array of the observation below."""

    id, title, icon = "eye", "Vision", Icons.eye

    def __init__(self, textures: TextureStore) -> None:
        self._textures = textures
        self._all_rows = False

    def draw(self, session: "Session") -> None:
        """Draw what is known of the moment; the rest is asked for."""
        viewer = session.viewer
        # While the layout settles every panel is in front once; looking would import JAX.
        viewer.eye_open = session.view.settled
        view = viewer.eye
        if viewer.eye_error:
            widgets.small(viewer.eye_error, COLOURS.bad)
        if view is None:
            if viewer.eye_pending:
                widgets.spinner(7)
                imgui.same_line(0, px(8))
                widgets.muted("Looking …")
            return
        side = min(imgui.get_content_region_avail().x, px(_PICTURE))
        texture = self._textures.texture("eye", view.pixels, viewer.eye_stamp)
        imgui.image(texture, (side, side))
        widgets.probe(session, "eye.picture")
        widgets.small(
            f"Pixels as a pixel agent gets them: {view.pixels.shape[1]} × {view.pixels.shape[0]}."
        )
        who = viewer.slots["a"].summary
        name = who.name if who is not None and who.parameters else "An agent with this form"
        widgets.small(f"{name} sees {view.observation.replace('_', ' ')}:")
        changed, on = widgets.checkbox(session, "eye.all", "Empty slots too", self._all_rows)
        self._all_rows = on if changed else self._all_rows
        for table in view.tables:
            if widgets.section(table.name.replace("_", " ")):
                self._table(session, table)

    def _table(self, session: "Session", table: ViewTable) -> None:
        rows = [k for k, on in enumerate(table.active) if on or self._all_rows]
        if not rows:
            widgets.small("none")
            return
        tall = len(table.columns) > len(rows)
        # Long rows read better as columns: a line a number, a column an entity.
        heads = [table.rows[k] for k in rows] if tall else [c[0] for c in table.columns]
        flags = (
            imgui.TableFlags_.row_bg.value
            | imgui.TableFlags_.scroll_x.value
            | imgui.TableFlags_.scroll_y.value
            | imgui.TableFlags_.borders_inner_v.value
            | imgui.TableFlags_.sizing_fixed_fit.value
        )
        count = len(table.columns) if tall else len(rows)
        line = imgui.get_text_line_height_with_spacing()
        height = min((count + 2) * line, px(260))
        if not imgui.begin_table(f"eye.{table.name}", len(heads) + 1, flags, (0.0, height)):
            return
        imgui.table_setup_scroll_freeze(1, 1)
        # A single number stands before its name: long names would push it out of sight.
        for head in (*heads, "") if len(heads) == 1 else ("", *heads):
            imgui.table_setup_column(tr(head))
        imgui.table_headers_row()
        widgets.probe(session, f"eye.{table.name}")
        clipper = imgui.ListClipper()
        clipper.begin(count)
        with widgets.font(FONTS.mono, SMALL - 1):
            while clipper.step():
                for index in range(clipper.display_start, clipper.display_end):
                    self._line(table, rows, index, tall=tall)
        imgui.end_table()

    def _line(self, table: ViewTable, rows: list[int], index: int, *, tall: bool) -> None:
        imgui.table_next_row()
        picked = table.values[rows, index] if tall else table.values[rows[index]]
        values = np.asarray(picked).tolist()
        if len(values) > 1:
            self._name(table, rows, index, tall=tall)
        for value in values:
            imgui.table_next_column()
            widgets.text(f"{value:+.3f}", COLOURS.text if value else COLOURS.faint)
        if len(values) == 1:
            self._name(table, rows, index, tall=tall)

    def _name(self, table: ViewTable, rows: list[int], index: int, *, tall: bool) -> None:
        imgui.table_next_column()
        if not tall:
            widgets.muted(table.rows[rows[index]])
            return
        name, unit, meaning = table.columns[index]
        widgets.muted(f"{name} [{unit}]" if unit else name)
        if meaning:
            widgets.tooltip(name, meaning)
