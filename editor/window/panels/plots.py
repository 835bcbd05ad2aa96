"""Plots of the episode over time, with one cursor that is the timeline's."""

import dataclasses
from collections.abc import Callable, Sequence
from typing import TYPE_CHECKING, Final

import numpy as np
from imgui_bundle import imgui, implot

from editor.base.controls import CHANNEL_NAMES, channel_name
from editor.base.language import tr
from editor.toolkit import widgets
from editor.toolkit.appearance import COLOURS, Icons
from editor.toolkit.widgets import px
from editor.window.panels.base import Panel
from editor.worker.snapshots import ENGINE_STEPS_PER_SECOND, Snapshot
from kinetix.level.controls import channels_in_use

if TYPE_CHECKING:
    from editor.session import Session

_Value = Callable[[Snapshot], float]


@dataclasses.dataclass(frozen=True, kw_only=True)
class Series:
    """One curve."""

    label: str
    colour: str
    """Name of a colour of the theme."""
    value: _Value


@dataclasses.dataclass(frozen=True, kw_only=True)
class Plot:
    """One diagram."""

    title: str
    series: tuple[Series, ...]
    steps: bool = False
    """True if values hold until the next one."""
    agent: bool = False
    """True if it needs an agent with a network."""


def _series(label: str, colour: str, value: _Value) -> Series:
    return Series(label=label, colour=colour, value=value)


def _mind(name: str) -> _Value:
    def value(snapshot: Snapshot) -> float:
        mind = snapshot.mind
        return float("nan") if mind is None or mind.scripted else getattr(mind, name)

    return value


def _channel(index: int) -> _Value:
    """Return an entry of the action, shifted so that the channels lie one above the other."""

    def value(snapshot: Snapshot) -> float:
        played = snapshot.action[index] if index < len(snapshot.action) else 0.0
        return 0.4 * played - index

    return value


_CHANNELS: Final = (
    "info",
    "warn",
    "good",
    "accent",
    "bad",
    "text",
)
"""Colours of the entries of an action."""

PLOTS: Final[tuple[Plot, ...]] = (
    Plot(
        title="Reward",
        series=(
            _series("sum", "good", lambda s: s.total_reward),
            _series("step", "warn", lambda s: s.reward),
        ),
    ),
    Plot(title="Value", series=(_series("value", "info", _mind("value")),), agent=True),
    Plot(
        title="Entropy [nat]",
        series=(_series("entropy", "accent", _mind("entropy")),),
        agent=True,
    ),
    Plot(
        title="Actions",
        series=tuple(
            _series(label, colour, _channel(k))
            for k, (label, colour) in enumerate(zip(CHANNEL_NAMES, _CHANNELS, strict=True))
        ),
        steps=True,
    ),
    Plot(
        title="Distance [m]",
        series=(_series("green to blue", "accent", lambda s: s.distance),),
    ),
    Plot(
        title="Energy [J]",
        series=(
            _series("kinetic", "info", lambda s: s.kinetic_energy),
            _series("potential", "warn", lambda s: s.potential_energy),
            _series("total", "text", lambda s: s.kinetic_energy + s.potential_energy),
        ),
    ),
    Plot(
        title="Momentum [kg m/s]",
        series=(
            _series("x", "info", lambda s: s.momentum[0]),
            _series("y", "warn", lambda s: s.momentum[1]),
        ),
    ),
    Plot(
        title="Penetration [mm]",
        series=(_series("deepest", "bad", lambda s: 1000 * s.penetration),),
    ),
)
_COLUMN: Final = 196.0
_RIVAL_OPACITY: Final = 0.45


class _Curve:
    """The values of a curve, worked out once for each moment."""

    def __init__(self) -> None:
        self._values: list[float] = []
        self._first: Snapshot | None = None
        self._last: Snapshot | None = None

    def values(self, value: _Value, moments: Sequence[Snapshot]) -> np.ndarray:
        """Return a value a moment; only moments that came since the last call are asked."""
        count = len(self._values)
        goes_on = (
            0 < count <= len(moments)
            and moments[0] is self._first
            and moments[count - 1] is self._last
        )
        if not goes_on:
            self._values, count = [], 0
        self._values += [value(moment) for moment in moments[count:]]
        self._first, self._last = moments[0], moments[-1]
        return np.array(self._values)


class PlotsPanel(Panel):
    """Reads the moments that can be looked at; a click or drag in a plot goes to that time."""

    id, title, icon = "plots", "Plots", Icons.plots
    height = 300.0

    def __init__(self) -> None:
        self._curves: dict[tuple[str, str, str], _Curve] = {}

    def draw(self, session: "Session") -> None:
        """Draw one plot beside the other, as many columns as fit."""
        playback = session.playback
        states = playback.moments if playback.active else ()
        if len(states) < 2:
            widgets.empty_state(
                Icons.plots, "Nothing simulated yet", "The curves grow as you play."
            )
            return
        agent = any(state.mind is not None and not state.mind.scripted for state in states[-2:])
        plots = [plot for plot in PLOTS if agent or not plot.agent]
        space = imgui.get_content_region_avail()
        columns = max(1, min(len(plots), int(space.x / px(_COLUMN))))
        width = (space.x - (columns - 1) * px(6)) / columns
        rows = -(-len(plots) // columns)
        height = max(px(110), space.y / rows - px(6))
        rival = session.viewer.rival.snapshots
        for index, plot in enumerate(plots):
            if index % columns:
                imgui.same_line(0, px(6))
            self._plot(session, plot, states, rival, (width, height))

    def _plot(
        self,
        session: "Session",
        plot: Plot,
        states: Sequence[Snapshot],
        rival: Sequence[Snapshot],
        size: tuple[float, float],
    ) -> None:
        flags = implot.Flags_.no_menus.value | implot.Flags_.no_box_select.value
        flags |= implot.Flags_.no_inputs.value
        level = session.playback.level
        shown = plot.series
        if plot.steps and level is not None:
            shown = tuple(
                dataclasses.replace(shown[k], label=channel_name(level, k))
                for k in channels_in_use(level)
            )
        if len(shown) < 2:
            flags |= implot.Flags_.no_legend.value
        if not implot.begin_plot(f"{tr(plot.title)}###{plot.title}", size, flags):
            return
        fit = implot.AxisFlags_.auto_fit.value
        bare = implot.AxisFlags_.no_tick_labels.value if plot.steps else 0
        implot.setup_axes("", "", fit, fit | bare)
        for owner, moments, opacity in (("b", rival, _RIVAL_OPACITY), ("a", states, 1.0)):
            if len(moments) < 2:
                continue
            time = _times(moments)
            for series in shown:
                key = (owner, plot.title, series.colour)
                values = self._curves.setdefault(key, _Curve()).values(series.value, moments)
                spec = implot.Spec()
                spec.line_color = imgui.ImVec4(*COLOURS.of(series.colour)[:3], opacity)
                spec.line_weight = px(1.75)
                if owner == "b":
                    spec.flags = implot.ItemFlags_.no_legend.value
                drawing = implot.plot_stairs if plot.steps else implot.plot_line
                drawing(f"{tr(series.label)}###{owner}{series.colour}", time, values, spec)
        self._cursor(session, states)
        implot.end_plot()
        widgets.probe(session, f"plots.{plot.title}")

    def _cursor(self, session: "Session", states: Sequence[Snapshot]) -> None:
        """The timeline's moment as an upright line; the mouse moves it."""
        playback = session.playback
        moment = states[min(playback.replay_index, len(states) - 1)]
        spec = implot.Spec()
        spec.line_color = imgui.ImVec4(*COLOURS.text[:3], 0.7)
        spec.line_weight = px(1.25)
        implot.plot_inf_lines("###cursor", np.array([_time(moment)]), spec)
        # The plots take no input of their own: a drag would pan them away from the cursor.
        low, size, mouse = implot.get_plot_pos(), implot.get_plot_size(), imgui.get_mouse_pos()
        inside = 0 <= mouse.x - low.x <= size.x and 0 <= mouse.y - low.y <= size.y
        if inside and imgui.is_window_hovered() and imgui.is_mouse_down(0):
            wanted = implot.get_plot_mouse_pos().x
            nearest = int(np.argmin(np.abs(_times(states) - wanted)))
            session.queue(lambda: playback.scrub(nearest))


def _time(moment: Snapshot) -> float:
    return moment.step * moment.frame_skip / ENGINE_STEPS_PER_SECOND


def _times(moments: Sequence[Snapshot]) -> np.ndarray:
    return np.array([_time(moment) for moment in moments])
