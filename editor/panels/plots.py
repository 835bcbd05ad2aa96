"""Plots of the episode: reward, distance, energy, momentum, penetration over time."""

from collections.abc import Callable
from typing import TYPE_CHECKING, Final

import numpy as np
from imgui_bundle import imgui, implot

from editor import widgets
from editor.look import COLOURS, Icons, Rgba
from editor.panels.base import Panel
from editor.recording import Snapshot
from editor.widgets import px

if TYPE_CHECKING:
    from editor.session import Session

_Series = tuple[str, Rgba, Callable[[Snapshot], float]]

PLOTS: Final[tuple[tuple[str, tuple[_Series, ...]], ...]] = (
    (
        "Energy [J]",
        (
            ("kinetic", COLOURS.info, lambda s: s.kinetic_energy),
            ("potential", COLOURS.warn, lambda s: s.potential_energy),
            ("total", COLOURS.text, lambda s: s.kinetic_energy + s.potential_energy),
        ),
    ),
    ("Reward", (("sum", COLOURS.good, lambda s: s.total_reward),)),
    ("Distance [m]", (("green to blue", COLOURS.accent, lambda s: s.distance),)),
    (
        "Momentum [kg m/s]",
        (
            ("x", COLOURS.info, lambda s: s.momentum[0]),
            ("y", COLOURS.warn, lambda s: s.momentum[1]),
        ),
    ),
    ("Penetration [mm]", (("deepest", COLOURS.bad, lambda s: 1000 * s.penetration),)),
)
_COLUMN: Final = 260.0


class PlotsPanel(Panel):
    """Reads the ring of snapshots; what lies further back is gone."""

    id, title, icon = "plots", "Plots", Icons.plots

    def draw(self, session: "Session") -> None:
        """Draw one plot beside the other, as many columns as fit."""
        states = session.playback.ring.snapshots
        if len(states) < 2:
            widgets.empty_state(
                Icons.plots, "Nothing simulated yet", "Press Space: the curves grow as you play."
            )
            return
        time = np.array([state.step / 30 for state in states])
        space = imgui.get_content_region_avail()
        columns = max(1, min(len(PLOTS), int(space.x / px(_COLUMN))))
        width = (space.x - (columns - 1) * px(6)) / columns
        rows = -(-len(PLOTS) // columns)
        height = max(px(110), space.y / rows - px(6))
        for index, (title, series) in enumerate(PLOTS):
            if index % columns:
                imgui.same_line(0, px(6))
            self._plot(title, series, states, time, (width, height))

    def _plot(
        self,
        title: str,
        series: tuple[_Series, ...],
        states: tuple[Snapshot, ...],
        time: np.ndarray,
        size: tuple[float, float],
    ) -> None:
        flags = implot.Flags_.no_menus.value | implot.Flags_.no_box_select.value
        if len(series) == 1:
            flags |= implot.Flags_.no_legend.value
        if not implot.begin_plot(title, size, flags):
            return
        fit = implot.AxisFlags_.auto_fit.value
        implot.setup_axes("", "", fit, fit)
        for label, colour, value in series:
            values = np.array([value(state) for state in states])
            spec = implot.Spec()
            spec.line_color = imgui.ImVec4(*colour)
            spec.line_weight = px(1.75)
            implot.plot_line(label, time, values, spec)
        implot.end_plot()
