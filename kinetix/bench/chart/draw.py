"""The picture: a facet for each class and batch size, drawn by matplotlib (extra `bench`)."""

import math
from collections.abc import Sequence
from pathlib import Path
from typing import Any, Final

from kinetix.bench.chart.figure import lay_out, new_figure, save_figure, spread_labels
from kinetix.bench.chart.front import LEAST_ERROR, pareto_front
from kinetix.bench.chart.points import OURS, Point
from kinetix.scenes import SCENE_CLASSES

COLOURS: Final = {
    OURS: "#1b7837",
    "jax2d": "#b2182b",
    "box2d": "#2166ac",
    "pymunk": "#8073ac",
    "mujoco": "#e08214",
    "mjx": "#7f3b08",
    "brax positional": "#c51b7d",
    "brax spring": "#de77ae",
    "brax generalized": "#8e0152",
}
"""By family."""
PRESETS_SHOWN: Final = ("fast", "balanced", "accurate")
"""Ours that are joined by a line and drawn larger."""
TOP: Final = 20.0
"""The top edge of the error axes: where failures are drawn."""


def draw_chart(points: Sequence[Point], file: Path, *, note: str = "") -> None:
    """Draw all points into a PNG file; a class of scenes that nobody was timed in has no row.

    Args:
        points: Of any engines, classes and batch sizes.
        file: Where to.
        note: Small print below: machine, versions, date.

    Raises:
        KinetixError: The extra `bench` is not installed.
    """
    batches = sorted({point.batch for point in points})
    measured = {point.group for point in points}
    groups = [group for group in SCENE_CLASSES if group in measured]
    figure = new_figure(4.6 * len(batches) + 2.2, 3.1 * len(groups))
    axes = figure.subplots(len(groups), len(batches), squeeze=False)
    labels = []
    for row, group in enumerate(groups):
        for column, batch in enumerate(batches):
            facet = [p for p in points if p.group == group and p.batch == batch]
            _draw_facet(axes[row][column], facet, group, batch)
            labels.append(_write_labels(axes[row][column], facet))
    _draw_legend(figure, points)
    lay_out(figure, note=note, room=(0.015, 0.97))
    for texts in labels:
        spread_labels(texts)
    save_figure(figure, file)


def _height(point: Point) -> float:
    """Return the height of a point: the top edge for what fails as a whole."""
    if point.group == "robustness":
        return 100 * point.error
    return TOP if point.error >= 1 else max(point.error, LEAST_ERROR)


def _draw_facet(axes: Any, points: Sequence[Point], group: str, batch: int) -> None:
    worlds = "1 world" if batch == 1 else f"{batch} worlds"
    axes.set_title(f"{group}, {worlds}", fontsize=10, loc="left")
    axes.set_xscale("log")
    axes.tick_params(which="minor", labelbottom=False, labelleft=False)
    axes.set_xlabel("simulated seconds per second", fontsize=8)
    axes.tick_params(labelsize=7)
    axes.grid(alpha=0.25, linewidth=0.5)
    if group == "robustness":
        axes.set_ylabel("failures [%]", fontsize=8)
        axes.set_ylim(-3, 103)
    else:
        axes.set_ylabel("class error (1 fails)", fontsize=8)
        axes.set_yscale("log")
        axes.set_ylim(LEAST_ERROR / 2, TOP * 1.6)
        axes.axhspan(1, TOP * 1.6, color="#b2182b", alpha=0.06, linewidth=0)
    if points:
        # Room for labels, and two powers of ten at least, which the axis writes out.
        speeds = [point.speed for point in points]
        low, high = 10 ** math.floor(math.log10(min(speeds) / 1.5)), max(speeds) * 4
        axes.set_xlim(low, max(high, 10 * low, 10 ** math.ceil(math.log10(max(speeds) * 1.5))))
    else:
        axes.text(0.5, 0.5, "not measured", transform=axes.transAxes, ha="center", fontsize=8)
    front = pareto_front(points)
    axes.step(
        [point.speed for point in front],
        [_height(point) for point in front],
        where="pre",
        color="#000000",
        alpha=0.35,
        linewidth=1,
    )
    for family in dict.fromkeys(point.family for point in points):
        own = [point for point in points if point.family == family]
        _draw_family(axes, own, _colour(family))


def _draw_family(axes: Any, points: Sequence[Point], colour: str) -> None:
    line = [p for p in points if p.family != OURS or p.name in PRESETS_SHOWN]
    line.sort(key=lambda point: point.speed)
    axes.plot(
        [p.speed for p in line], [_height(p) for p in line], color=colour, alpha=0.3, linewidth=1
    )
    for point in points:
        main = _is_main(point)
        fails = point.error >= 1 and point.group != "robustness"
        hollow = point.failed > 0 and not fails
        axes.plot(
            point.speed,
            _height(point),
            marker="x" if fails else "o",
            markersize=7 if main else 5,
            markerfacecolor="white" if hollow else colour,
            markeredgecolor=colour,
            markeredgewidth=1.6 if fails else 1.2,
            clip_on=False,
        )


def _write_labels(axes: Any, points: Sequence[Point]) -> list[Any]:
    """Each point's name on top of it, to be spread when the figure has its final size."""
    return [
        axes.text(
            point.speed,
            _height(point),
            point.name.removeprefix(f"{point.family} "),
            fontsize=6.5 if _is_main(point) else 5.5,
            color=_colour(point.family),
        )
        for point in points
    ]


def _colour(family: str) -> str:
    """Grey for a family that has none of its own."""
    return COLOURS.get(family, "#777777")


def _is_main(point: Point) -> bool:
    """Our presets, and others at their defaults."""
    return point.name in PRESETS_SHOWN or point.name == point.family


def _draw_legend(figure: Any, points: Sequence[Point]) -> None:
    from matplotlib.lines import Line2D

    families = dict.fromkeys(point.family for point in points)
    handles = [
        Line2D([], [], color=_colour(family), marker="o", label=family)
        for family in sorted(families, key=lambda family: (family != OURS, family))
    ]
    grey: dict[str, Any] = {"color": "#333333", "linestyle": "none"}
    handles += [
        Line2D([], [], marker="o", markerfacecolor="white", label="a counted scene fails", **grey),
        Line2D([], [], marker="x", label="fails as a whole", **grey),
        Line2D([], [], color="#000000", alpha=0.35, label="nothing is faster and more accurate"),
    ]
    figure.legend(handles=handles, loc="upper center", ncols=4, fontsize=8, frameon=False)
