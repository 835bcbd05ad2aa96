"""Summary of the accuracy suite: class errors, counts, tables."""

import collections
import math
from collections.abc import Iterable, Mapping, Sequence
from typing import Any, Final

from kinetix.bench.judges.base import normalised_error
from kinetix.scenes import SCENE_CLASSES, SCENES

ERROR_RANGE: Final = (1e-6, 10.0)
"""To which a scene's error is clipped before classes are averaged."""
MARKS: Final = {"good": "✓", "ok": "○", "fail": "✗", None: "–"}
"""Verdicts in tables."""

Row = Mapping[str, Any]


def scene_error(row: Row) -> float | None:
    """e_norm of a scene, its worst metric; None where it is only reported."""
    if row["verdict"] is None:
        return None
    return normalised_error(row["value"], row["good"], row["fail"])


def class_errors(rows: Iterable[Row]) -> dict[str, float]:
    """Geometric mean of the errors of each class's counted scenes among the rows."""
    found = collections.defaultdict(list)
    low, high = ERROR_RANGE
    for row in rows:
        error = scene_error(row)
        if error is not None and SCENES[row["scene"]].counted:
            found[row["class"]].append(math.log(min(max(error, low), high)))
    return {
        name: math.exp(sum(found[name]) / len(found[name])) for name in SCENE_CLASSES if found[name]
    }


def verdict_counts(rows: Iterable[Row]) -> dict[str, int]:
    """Count the good, ok and failed scenes."""
    counts = collections.Counter(row["verdict"] for row in rows)
    return {verdict: counts[verdict] for verdict in ("good", "ok", "fail")}


def value_text(value: float | None, unit: str) -> str:
    """Return a value with its unit, in three digits."""
    if value is None:
        return "failed"
    return f"{value:.3g}" if unit == "1" else f"{value:.3g} {unit}"


def scene_text(row: Row) -> str:
    """Return a row as one line of text."""
    limits = "" if row["good"] is None else f"  (good {row['good']:g}, fail {row['fail']:g})"
    verdict = row["verdict"] or "reported"
    head = f"{row['scene']:4}{SCENES[row['scene']].name:22}"
    if row["verdict"] is None and row["value"] is None:
        return f"{head}{MARKS[None]:9}{row['metric']}"
    value = value_text(row["value"], row["unit"])
    return f"{head}{verdict:9}{row['metric']}: {value}{limits}"


def summary_text(rows: Sequence[Row]) -> str:
    """Counts and class errors in two lines."""
    counts = ", ".join(f"{count} {name}" for name, count in verdict_counts(rows).items())
    errors = ", ".join(f"{name} {error:.2g}" for name, error in class_errors(rows).items())
    return f"{counts}\nclass errors (1 fails): {errors or 'no core scene'}"


def markdown_table(results: Mapping[str, Sequence[Row]]) -> str:
    """Return a line a scene and a column a physics: its worst value and verdict.

    Args:
        results: Rows by the name of the physics.
    """
    columns = {physics: {row["scene"]: row for row in rows} for physics, rows in results.items()}
    lines = [
        "| scene | " + " | ".join(f"`{physics}`" for physics in columns) + " |",
        "| --- |" + " --- |" * len(columns),
    ]
    for scene in SCENES.values():
        if not any(scene.id in rows for rows in columns.values()):
            continue
        name = f"{scene.id} {scene.name}{' ●' if scene.core else ''}"
        cells = [_cell(rows.get(scene.id)) for rows in columns.values()]
        lines.append(f"| {name} | " + " | ".join(cells) + " |")
    return "\n".join(lines)


def _cell(row: Row | None) -> str:
    if row is None:
        return ""
    if row["verdict"] is None and row["value"] is None:
        return MARKS[None]
    return f"{MARKS[row['verdict']]} {value_text(row['value'], row['unit'])} {row['metric']}"
