"""A training run while it trains: its metrics as curves, and its newest agent."""

from collections.abc import Sequence
from typing import TYPE_CHECKING, Final

import numpy as np
from imgui_bundle import imgui, implot

from editor.actions.watching import watch
from editor.agents.curves import Curve, Curves, band_of, run_names
from editor.base.language import tr
from editor.toolkit import widgets
from editor.toolkit.appearance import COLOURS, Icons, Rgba
from editor.toolkit.widgets import px
from editor.window.panels.base import Panel
from editor.window.panels.results_table import end_of
from kinetix.wording import plural, thousands

if TYPE_CHECKING:
    from editor.session import Session

_LEVEL_RATE: Final = "eval_avg/hand_designed_episode_solve_rate_"
_RATES: Final = (-0.05, 1.05)
"""The axis of a rate goes no farther: what happens always or never is at its ends."""
_MOST_LEVELS: Final = 6
"""Levels whose own curves are shown at first."""
_COLOURS: Final = ("info", "warn", "good", "accent", "bad")
"""Names of the colours of the runs, in their order."""
_FIRST: Final = (
    "episode_solved",
    "episode_return",
    "episode_length",
    "loss/entropy",
    "timing/sps",
)
"""Metrics that are shown at first, where the run has them."""
_COLUMN: Final = 270.0
_STARTING: Final = "Starting: where no solution is recorded, a win to begin from is looked for …"


def _colour(index: int) -> Rgba:
    """Return the colour of a run."""
    return COLOURS.of(_COLOURS[index % len(_COLOURS)])


class TrainingPanel(Panel):
    """Reads what the watch has read; draws one plot a metric that is switched on."""

    id, title, icon = "training", "Training", Icons.training
    height = 290.0
    measures = True

    def __init__(self) -> None:
        self._on: dict[str, bool] = {}
        self._smoothing = 0.0
        self._log = False
        self._band = False
        self._levels: frozenset[str] = frozenset()
        self._curves = Curves()

    def draw(self, session: "Session") -> None:
        """Draw the training under way, the head line and the plots."""
        run = session.viewer.run
        if session.training.running:
            self._local(session)
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
        if not run.metrics:
            widgets.muted("No metrics yet.")
            return
        self._plots(session)

    def _head(self, session: "Session") -> None:
        viewer = session.viewer
        run = viewer.run
        imgui.align_text_to_frame_padding()
        words = plural(len(run.metrics), "update")
        if run.metrics.steps is not None:
            words += f", {thousands(run.metrics.steps)} environment steps"
        if run.newest is not None:
            words += f", newest agent at {thousands(run.newest)}"
        widgets.wrapped(words)
        widgets.tooltip(run.path, own=True)
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
        widgets.beside(90)
        if widgets.button(session, "training.beside", "Add a run…"):
            session.queue(lambda: watch.ask_beside(session))
        widgets.tooltip("Add a run", "Its curves are drawn beside these, also while it trains.")
        widgets.beside(120)
        if widgets.button(session, "training.stop", "Stop watching"):
            viewer.other_runs = ()
            session.queue(lambda: watch.watch_run(session, ""))
        self._looks(session)

    def _local(self, session: "Session") -> None:
        """Show the training that the app has begun, watched or not: its last words, and its end."""
        training = session.training
        assert training.run is not None
        run = str(training.run)
        widgets.spinner(7, framed=True)
        imgui.same_line(0, px(8))
        imgui.align_text_to_frame_padding()
        if training.words and not training.stopping:
            # Of an update it is numbers, else a stage.
            show = widgets.raw if training.words[0].isdigit() else widgets.text
            show(training.words, COLOURS.muted)
        else:
            widgets.muted("Ending …" if training.stopping else _STARTING)
        if run != session.viewer.run.path:
            widgets.beside_words("Watch it")
            if widgets.button(session, "training.watch_own", "Watch it"):
                session.queue(lambda: watch.watch_run(session, run))
            widgets.tooltip("Watch it", f"The curves of {run}.")
        widgets.beside_words("Stop Training")
        with widgets.disabled(training.stopping):
            if widgets.button(session, "training.end", "Stop Training"):
                session.queue("agent.stop_training")

    def _looks(self, session: "Session") -> None:
        """Smoothing, a logarithmic axis, and of several runs one band."""
        imgui.set_next_item_width(px(110))
        _, self._smoothing = imgui.slider_float("###smoothing", self._smoothing, 0.0, 0.99, "%.2f")
        widgets.probe(session, "training.smoothing")
        widgets.tooltip("Smoothing", "How much of each value is that of the update before.")
        imgui.same_line(0, px(6))
        widgets.muted("Smoothing")
        widgets.beside(90)
        _, self._log = widgets.checkbox(session, "training.log", "Log axis", self._log)
        others = session.viewer.other_runs
        if others:
            widgets.beside(150)
            _, self._band = widgets.checkbox(session, "training.band", "Mean and range", self._band)
            widgets.tooltip("Mean and range", "Of all these runs, where all of them have values.")
        names = run_names([session.viewer.run.path, *(other.path for other in others)])
        if others:
            widgets.beside(140)
            widgets.text(names[0], _colour(0))
            widgets.tooltip(session.viewer.run.path, own=True)
        for index, other in enumerate(others, start=1):
            widgets.beside(140)
            widgets.text(names[index], _colour(index))
            widgets.tooltip(other.path, tr(other.error), own=True)
            imgui.same_line(0, px(2))
            if widgets.icon_button(session, f"training.drop.{index}", Icons.close):
                session.viewer.other_runs = tuple(run for run in others if run is not other)

    def _choose(self, session: "Session") -> None:
        if widgets.button(session, "training.metrics", "Metrics…"):
            imgui.open_popup("metrics")
        names = session.viewer.run.metrics.names
        # Boxes break their words where they have no room, and a popup begins without any.
        widest = max((imgui.calc_text_size(name).x for name in names), default=0.0)
        room = (widest + imgui.get_frame_height() + px(60), imgui.FLT_MAX)
        imgui.set_next_window_size_constraints((room[0], 0), room)
        if imgui.begin_popup("metrics"):
            for name in names:
                changed, on = widgets.checkbox(
                    session, f"training.metric.{name}", name, self._shows(name)
                )
                if changed:
                    self._on[name] = on
            imgui.end_popup()

    def _shows(self, name: str) -> bool:
        by_default = name in _FIRST or name.endswith("solve_rate") or name in self._levels
        return self._on.get(name, by_default)

    def _plots(self, session: "Session") -> None:
        run = session.viewer.run
        metrics = run.metrics.names
        self._levels = level_rates(metrics)
        names = [name for name in metrics if self._shows(name)]
        if not names:
            widgets.muted("Choose metrics to see their curves.")
            return
        space = imgui.get_content_region_avail()
        columns = max(1, min(len(names), int(space.x / px(_COLUMN))))
        width = (space.x - (columns - 1) * px(6)) / columns
        rows = -(-len(names) // columns)
        height = max(px(120), space.y / rows - px(6))
        # Else a curve at its highest lies on the frame; below zero a logarithmic axis has no end.
        padding = imgui.ImVec2(0.0, 0.0 if self._log else 0.06)
        implot.push_style_var(implot.StyleVar_.fit_padding, padding)
        for index, name in enumerate(names):
            if index % columns:
                imgui.same_line(0, px(6))
            runs = (run, *session.viewer.other_runs)
            curves = [self._curves.of(one.metrics, name, self._smoothing) for one in runs]
            _plot(name, curves, (width, height), log=self._log, band=self._band)
            widgets.probe(session, f"training.plot.{name}")
        implot.pop_style_var()


def level_rates(metrics: Sequence[str]) -> frozenset[str]:
    """Return the solve rates of single levels, where so few are evaluated that all can be shown."""
    found = [name for name in metrics if name.startswith(_LEVEL_RATE)]
    return frozenset(found if len(found) <= _MOST_LEVELS else ())


def title_of(metric: str) -> str:
    """Return what stands over a metric's plot."""
    if metric.startswith(_LEVEL_RATE):
        return f"{tr('Solved')} {metric.removeprefix(_LEVEL_RATE)}"
    return tr(metric)


def _plot(
    name: str,
    curves: Sequence[tuple[Curve, Curve]],
    size: tuple[float, float],
    *,
    log: bool,
    band: bool,
) -> None:
    """One metric of all runs: their curves whole, and thinned."""
    flags = implot.Flags_.no_menus.value | implot.Flags_.no_box_select.value
    # The names of the runs stand in their colours over the plots.
    flags |= implot.Flags_.no_legend.value
    if not implot.begin_plot(f"{end_of(title_of(name), size[0] - px(30))}###{name}", size, flags):
        return
    fit = implot.AxisFlags_.auto_fit.value
    implot.setup_axes("", "", fit, fit)
    ends = [curve.x[[0, -1]] for curve, _ in curves if len(curve.x)]
    places = set(np.concatenate(ends).tolist()) if ends else set()
    if len(places) == 1:
        # Else the same number would stand at every tick.
        implot.setup_axis_ticks(implot.ImAxis_.x1, list(places), [f"{min(places):g}"])
    if name.endswith(("solved", "solve_rate")) or name.startswith(_LEVEL_RATE):
        implot.setup_axis_limits_constraints(implot.ImAxis_.y1.value, *_RATES)
    if log:
        implot.setup_axis_scale(implot.ImAxis_.y1.value, implot.Scale_.log10.value)
    spread = band_of([curve for curve, _ in curves]) if band else None
    if spread is not None:
        spec = implot.Spec()
        spec.fill_color = imgui.ImVec4(*COLOURS.info[:3], 1.0)
        spec.fill_alpha = 0.25
        implot.plot_shaded("range", spread.x, spread.low, spread.high, spec)
        _line("mean", Curve(x=spread.x, y=spread.mean), COLOURS.info)
    else:
        for index, (_, curve) in enumerate(curves):
            _line(str(index), curve, _colour(index))
    implot.end_plot()


def _line(name: str, curve: Curve, colour: Rgba) -> None:
    spec = implot.Spec()
    spec.line_color = imgui.ImVec4(*colour)
    spec.line_weight = px(1.75)
    if len(curve.x) == 1:
        spec.marker, spec.marker_size = implot.Marker_.circle.value, px(3)
    implot.plot_line(name, curve.x, curve.y, spec)
