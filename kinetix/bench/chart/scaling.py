"""The picture of speed and compile time against the numbers of bodies and of worlds."""

import datetime
import json
import math
from collections.abc import Sequence
from pathlib import Path
from typing import Any, Final

from kinetix.bench.chart.figure import lay_out, machine, new_figure, save_figure
from kinetix.files.atomic import write_atomically

_COLOURS: Final = ("#1b7837", "#2166ac", "#e08214", "#8073ac")


def write_scaling(rows: Sequence[dict[str, Any]], file: Path) -> None:
    """Draw the rows of `measure_scaling`, and keep them beside the picture as JSON.

    Args:
        rows: Of bodies, of worlds or of both.
        file: The PNG file; the JSON has the same name with its own ending.

    Raises:
        KinetixError: The extra `bench` is not installed.
    """
    note = f"{machine()}, {datetime.date.today().isoformat()}, {rows[0]['physics']}"
    figure = new_figure(10, 6)
    axes = figure.subplots(2, 2, squeeze=False)
    bodies = [row for row in rows if "bodies" in row]
    worlds = [row for row in rows if "size" in row]
    _column(axes[:, 0], bodies, "bodies", "one world, towers of four boxes")
    sizes = {row["size"]: None for row in worlds}
    _column(axes[:, 1], worlds, "worlds", f"levels of size {', '.join(sizes)}")
    lay_out(figure, note=note, room=(0.02, 1))
    save_figure(figure, file)
    text = json.dumps({"note": note, "rows": list(rows)}, indent=1) + "\n"
    write_atomically(file.with_suffix(".json"), text.encode())


def _column(axes: Any, rows: Sequence[dict[str, Any]], across: str, title: str) -> None:
    """Speed above, compile time below; a line for each number of devices."""
    speed, compiling = axes
    speed.set_title(title, fontsize=10, loc="left")
    speed.set_ylabel("steps per second, all worlds", fontsize=8)
    compiling.set_ylabel("compiling [s]", fontsize=8)
    counts = sorted({row["devices"] for row in rows})
    for colour, devices in zip(_COLOURS, counts, strict=False):
        own = sorted((r for r in rows if r["devices"] == devices), key=lambda row: row[across])
        label = f"{devices} device{'s' if devices > 1 else ''}"
        for each, what in ((speed, "steps_per_s"), (compiling, "compile_s")):
            places = [row[across] for row in own]
            each.plot(places, [row[what] for row in own], "o-", color=colour, label=label)
    if rows:
        speeds = [row["steps_per_s"] for row in rows]
        low, high = (math.log10(speed) for speed in (min(speeds) / 1.5, max(speeds) * 1.5))
        speed.set_yscale("log")
        speed.set_ylim(10 ** math.floor(low), 10 ** math.ceil(high))
        compiling.set_ylim(0, 1.1 * max(row["compile_s"] for row in rows))
    ticks = sorted({row[across] for row in rows})
    for each in (speed, compiling):
        each.set_xlabel(across, fontsize=8)
        each.set_xscale("log", base=2)
        each.set_xticks(ticks, [f"{tick:,}" for tick in ticks])
        each.tick_params(labelsize=7)
        each.grid(alpha=0.25, linewidth=0.5)
    if len(counts) > 1:
        speed.legend(fontsize=8, frameon=False)
