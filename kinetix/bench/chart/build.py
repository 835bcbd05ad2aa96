"""Puts the chart together: what has to be measured, the JSON beside the picture, the picture."""

import dataclasses
import datetime
import json
import platform
from collections.abc import Callable, Sequence
from pathlib import Path
from typing import Any, Final

from kinetix.bench.chart.draw import draw_chart
from kinetix.bench.chart.figure import machine
from kinetix.bench.chart.front import scalars
from kinetix.bench.chart.points import (
    ACCURACY,
    OURS,
    Point,
    append_rows,
    file_name,
    missing_scenes,
    read_points,
    write_speeds,
)
from kinetix.bench.processes import measured_apart
from kinetix.engine.presets import PRESETS, SOLVERS
from kinetix.errors import KinetixError
from kinetix.scenes import SCENE_CLASSES

QUICK: Final = ("fast", "balanced", "accurate")
"""Presets that `--quick` measures, with many worlds only."""
UNTIMED: Final = ("reference",)
"""Presets that only judge others."""
QUIET: Final = 3.0
"""Up to this load the machine counts as left alone: our own process with a thread a core."""
BATCHES: Final = (1, 1024)
"""Worlds stepped at once in the chart's columns."""


@dataclasses.dataclass(frozen=True, kw_only=True)
class ChartSettings:
    """Settings of the chart."""

    out: Path
    """Folder of chart.png and chart.json."""
    results: Path
    """Folder of the measured rows; what is missing there is measured."""
    physics: tuple[str, ...] = ()
    """Presets whose speed is measured again. Their errors are measured where missing."""
    batches: tuple[int, ...] = BATCHES
    cores: int = 1
    """Processor cores that many worlds are spread over."""


def every_physics() -> tuple[str, ...]:
    """Return all presets and solvers that the chart shows, each method once."""
    named = {**PRESETS, **SOLVERS}
    found: dict[Any, str] = {}
    for name, solver in named.items():
        if name not in UNTIMED:
            found.setdefault(solver, name)
    return tuple(found.values())


def stored_physics(results: Path) -> tuple[str, ...]:
    """Those of `every_physics` whose errors have been measured; the quick ones where none has."""
    stored = {file.stem for file in (results / ACCURACY).glob("*.jsonl")}
    found = tuple(name for name in every_physics() if file_name(name) in stored)
    return found or QUICK


def build_chart(settings: ChartSettings, say: Callable[[str], None]) -> dict[str, Any]:
    """Measure what was asked for, then write chart.json and chart.png from all stored rows.

    Returns:
        The contents of chart.json.

    Raises:
        KinetixError: Nothing has been measured, or matplotlib is missing.
    """
    for physics in settings.physics:
        _measure(physics, settings, say)
    points = read_points(settings.results)
    if not points:
        raise KinetixError(f"{settings.results}: there is nothing to draw; measure something first")
    data = chart_data(points)
    settings.out.mkdir(parents=True, exist_ok=True)
    (settings.out / "chart.json").write_text(json.dumps(data, indent=1) + "\n")
    draw_chart(points, settings.out / "chart.png", note=data["note"])
    return data


def chart_data(points: Sequence[Point]) -> dict[str, Any]:
    """Return points and scalars as JSON."""
    batches = sorted({point.batch for point in points})
    place, today = machine(), datetime.date.today().isoformat()
    facets = [
        {"class": group, "batch": batch, **scalars(_facet(points, group, batch))}
        for group in SCENE_CLASSES
        for batch in batches
    ]
    load = max(point.load for point in points)
    busy = f" The machine was busy (load {load:g}): speeds are too low." if load > QUIET else ""
    return {
        "note": f"{place}, drawn {today}. Engines called from Python have one world only.{busy}",
        "machine": place,
        "python": platform.python_version(),
        "facets": facets,
        "points": [dataclasses.asdict(point) for point in points],
    }


def facet_text(facet: dict[str, Any]) -> str:
    """Return the scalars of a facet for people."""

    def ratio(value: float | None) -> str:
        return "   none" if value is None else f"{value:7.3g}"

    ahead = ", ".join(facet["ahead_of_us"]) or "nobody"
    return (
        f"{facet['class']:11} {facet['batch']:5} worlds: "
        f"speed at equal error ×{ratio(facet['speed_ratio'])}, "
        f"error at equal speed ÷{ratio(facet['error_ratio'])}, on the front besides us: {ahead}"
    )


def _facet(points: Sequence[Point], group: str, batch: int) -> list[Point]:
    return [point for point in points if point.group == group and point.batch == batch]


def _measure(physics: str, settings: ChartSettings, say: Callable[[str], None]) -> None:
    """Errors where there are none yet, speeds again; in processes of their own."""
    accuracy = settings.results / ACCURACY / f"{file_name(physics)}.jsonl"
    if missing := missing_scenes(accuracy, "core,built"):
        say(f"{physics}: errors in {missing}")
        rows = measured_apart(
            *("accuracy", "--physics", physics, "--scenes", missing), devices=1, cached=True
        )
        append_rows(accuracy, rows)
    say(f"{physics}: speed")
    batches = ",".join(str(batch) for batch in settings.batches)
    rows = measured_apart(
        *("speed", "--scenes", "--physics", physics, "--batches", batches),
        devices=settings.cores,
        cached=True,
    )
    write_speeds(settings.results, physics, OURS, rows)
