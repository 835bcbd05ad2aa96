"""A training run while it trains: its metrics as curves, and its newest agent."""

from typing import TYPE_CHECKING, Final

import numpy as np
from imgui_bundle import imgui, implot

from editor import widgets
from editor.actions import watch
from editor.look import COLOURS, Icons
from editor.panels.base import Panel
from editor.widgets import px

if TYPE_CHECKING:
    from editor.session import Session

_STEPS: Final = "timing/num_env_steps"
_FIRST: Final = (
    "episode_solved",
    "episode_return",
    "episode_length",
    "loss/entropy",
    "timing/sps",
)
"""Metrics that are shown at first, where the run has them."""
_COLUMN: Final = 270.0


class TrainingPanel(Panel):
    """Reads what the watch has read; draws one plot a metric that is switched on."""

    id, title, icon = "training", "Training", Icons.plots
    height = 290.0

    def __init__(self) -> None:
        self._on: dict[str, bool] = {}

    def draw(self, session: "Session") -> None:
        """Draw the head line and the plots."""
        run = session.viewer.run
        if not run.path:
            widgets.empty_state(
                Icons.plots,
                "No training run is watched",
                "Point at the folder of a run (kinetix train --out FOLDER), also while it trains: "
                "its curves grow here, and its newest agent can play.",
            )
            width = px(190)
            space = imgui.get_content_region_avail().x
            imgui.set_cursor_pos_x(imgui.get_cursor_pos_x() + max((space - width) / 2, 0))
            if widgets.button(session, "training.watch", "Choose a folder…", width=width):
                session.queue("agent.watch_run")
            return
        self._head(session)
        if run.error:
            widgets.wrapped(run.error, COLOURS.bad)
        if not run.rows:
            widgets.muted("No metrics yet.")
            return
        self._plots(session)

    def _head(self, session: "Session") -> None:
        viewer = session.viewer
        run = viewer.run
        imgui.align_text_to_frame_padding()
        last = run.rows[-1] if run.rows else {}
        steps = last.get(_STEPS)
        words = f"{len(run.rows)} updates"
        if steps is not None:
            words += f", {int(steps):,} environment steps".replace(",", " ")
        if run.newest is not None:
            words += f", newest agent at {run.newest:,}".replace(",", " ")
        widgets.wrapped(words)
        widgets.tooltip(run.path)
        widgets.beside(190)
        changed, on = widgets.checkbox(
            session, "training.follow", "Take the newest agent", viewer.follow_run
        )
        viewer.follow_run = on if changed else viewer.follow_run
        widgets.tooltip(
            "Take the newest agent",
            "Slot A gets every new checkpoint; the next episode is played by it.",
        )
        widgets.beside(90)
        self._choose(session)
        widgets.beside(120)
        if widgets.button(session, "training.stop", "Stop watching"):
            session.queue(lambda: watch.watch_run(session, ""))

    def _choose(self, session: "Session") -> None:
        if widgets.button(session, "training.metrics", "Metrics…"):
            imgui.open_popup("metrics")
        if imgui.begin_popup("metrics"):
            for name in session.viewer.run.metrics:
                changed, on = widgets.checkbox(
                    session, f"training.metric.{name}", name, self._shows(name)
                )
                if changed:
                    self._on[name] = on
            imgui.end_popup()

    def _shows(self, name: str) -> bool:
        by_default = name in _FIRST or name.endswith("solve_rate")
        return self._on.get(name, by_default)

    def _plots(self, session: "Session") -> None:
        run = session.viewer.run
        names = [name for name in run.metrics if self._shows(name)]
        if not names:
            widgets.muted("Choose metrics to see their curves.")
            return
        space = imgui.get_content_region_avail()
        columns = max(1, min(len(names), int(space.x / px(_COLUMN))))
        width = (space.x - (columns - 1) * px(6)) / columns
        rows = -(-len(names) // columns)
        height = max(px(120), space.y / rows - px(6))
        for index, name in enumerate(names):
            if index % columns:
                imgui.same_line(0, px(6))
            known = [row for row in run.rows if name in row]
            x = np.array([row.get(_STEPS, k) for k, row in enumerate(known)], np.float64)
            y = np.array([row[name] for row in known], np.float64)
            _plot(name, x, y, (width, height))
            widgets.probe(session, f"training.plot.{name}")


def _plot(name: str, x: np.ndarray, y: np.ndarray, size: tuple[float, float]) -> None:
    flags = implot.Flags_.no_menus.value | implot.Flags_.no_legend.value
    if implot.begin_plot(name, size, flags | implot.Flags_.no_box_select.value):
        fit = implot.AxisFlags_.auto_fit.value
        implot.setup_axes("", "", fit, fit)
        spec = implot.Spec()
        spec.line_color = imgui.ImVec4(*COLOURS.info)
        spec.line_weight = px(1.75)
        if len(x) == 1:
            spec.marker, spec.marker_size = implot.Marker_.circle.value, px(3)
        implot.plot_line(name, x, y, spec)
        implot.end_plot()
