"""Points of the chart: one per engine, class and batch size, from stored measurements."""

import dataclasses
import datetime
import json
import os
import re
from collections.abc import Iterable, Mapping, Sequence
from pathlib import Path
from statistics import geometric_mean
from typing import Any, Final

from kinetix.bench.report import class_errors, scene_error
from kinetix.scenes import SCENE_CLASSES, SCENES, scenes_named
from kinetix.scenes.model import STEP

OURS: Final = "kinetix"
"""The family of our own engine."""
ACCURACY: Final = "accuracy"
"""Folder of results: rows of the suite, one file a physics of ours."""
PEER_ACCURACY: Final = "peers"
"""Folder of results: the same for other engines."""
SPEED: Final = "scene_speed"
"""Folder of results: speeds in the scenes of `kinetix.bench.scene_speed`, one file a physics."""
PEER_SPEED: Final = "peer_speed"
"""Folder of results: the same for other engines."""


@dataclasses.dataclass(frozen=True, kw_only=True)
class Point:
    """An engine with its settings, in one class and with one number of worlds."""

    family: str
    """The engine; `OURS` for ours."""
    name: str
    """Engine and settings; of ours the physics."""
    group: str
    """The class of scenes."""
    batch: int
    """Worlds stepped at once."""
    speed: float
    """Simulated seconds per second, of all worlds together."""
    error: float
    """Class error; of the class `robustness` the share of verdicts that are failures."""
    failed: int
    """Core scenes that fail."""
    scenes: int
    """Core scenes that have a verdict."""
    devices: int = 1
    measured: str = ""
    """Day of the measurement of speed."""
    load: float = 0.0
    """Processes that wanted to run then: well above 1, and the speed is too low."""


def file_name(name: str) -> str:
    """Return an engine's name as the stem of a file."""
    return re.sub(r"[^a-z0-9+_]+", "-", name.lower()).strip("-")


def read_points(results: Path) -> list[Point]:
    """Return all points for which both error and speed have been measured.

    Args:
        results: The folder with the folders `ACCURACY`, `SPEED` and those of other engines.
    """
    return [
        point
        for speeds, errors in ((SPEED, ACCURACY), (PEER_SPEED, PEER_ACCURACY))
        for file in sorted((results / speeds).glob("*.jsonl"))
        if os.path.exists(rows := results / errors / file.name)
        for point in points_of(read_rows(file), read_rows(rows))
    ]


def read_rows(file: Path) -> list[dict[str, Any]]:
    """Return a file of one JSON object a line."""
    return [json.loads(line) for line in file.read_text().splitlines() if line]


def write_rows(file: Path, rows: Iterable[Mapping[str, Any]]) -> None:
    """Write one JSON object a line, as far as they come."""
    file.parent.mkdir(parents=True, exist_ok=True)
    with file.open("w") as stream:
        for row in rows:
            stream.write(json.dumps(row) + "\n")
            stream.flush()


def missing_scenes(file: Path, scenes: str) -> str:
    """The ids among `scenes` (as on a command line) of which a file has no row, with commas."""
    stored = {row["scene"] for row in read_rows(file)} if os.path.exists(file) else set()
    return ",".join(scene.id for scene in scenes_named(scenes) if scene.id not in stored)


def append_rows(file: Path, rows: Iterable[Mapping[str, Any]]) -> None:
    """Add rows of the suite to a file, which keeps the order of the catalogue."""
    every = [*(read_rows(file) if os.path.exists(file) else []), *rows]
    write_rows(file, sorted(every, key=lambda row: list(SCENES).index(row["scene"])))


def write_speeds(results: Path, name: str, family: str, rows: Iterable[Mapping[str, Any]]) -> None:
    """Store the speeds of one engine; those in `rows` replace older ones of their batch sizes."""
    folder = SPEED if family == OURS else PEER_SPEED
    file = results / folder / f"{file_name(name)}.jsonl"
    head = {
        "family": family,
        "name": name,
        "measured": datetime.date.today().isoformat(),
        "load": round(os.getloadavg()[0], 1),
    }
    # Programs may come from a cache.
    fresh = [{**head, **row, "compile_s": None} for row in rows]
    batches = {row["batch"] for row in fresh}
    stored = read_rows(file) if os.path.exists(file) else []
    kept = [row for row in stored if row["batch"] not in batches]
    write_rows(file, [*kept, *fresh])


def points_of(
    speeds: Sequence[Mapping[str, Any]], rows: Sequence[Mapping[str, Any]]
) -> list[Point]:
    """Return the points of one engine.

    The class `robustness` has no scene of its own to be timed in: its speed is the geometric mean
    of the others', its error the share of failures among the verdicts of all counted scenes.
    """
    errors = class_errors(rows)
    core = [row for row in rows if SCENES[row["scene"]].counted and scene_error(row) is not None]
    verdicts = [each["verdict"] for row in core for each in row["metrics"] if each["verdict"]]
    errors["robustness"] = verdicts.count("fail") / len(verdicts)
    batches = dict.fromkeys(row["batch"] for row in speeds)
    return [
        Point(
            family=speeds[0]["family"],
            name=speeds[0]["name"],
            group=group,
            batch=batch,
            speed=STEP * geometric_mean([row["steps_per_s"] for row in timed]),
            error=errors[group],
            failed=sum(row["verdict"] == "fail" for row in _within(core, group)),
            scenes=len(_within(core, group)),
            devices=max(row["devices"] for row in timed),
            measured=speeds[0]["measured"],
            load=max(row.get("load", 0.0) for row in timed),
        )
        for group in SCENE_CLASSES
        for batch in batches
        if group in errors and (timed := _timed(speeds, group, batch))
    ]


def _within(rows: Sequence[Mapping[str, Any]], group: str) -> list[Mapping[str, Any]]:
    return [row for row in rows if group in (row["class"], "robustness")]


def _timed(speeds: Sequence[Mapping[str, Any]], group: str, batch: int) -> list[Mapping[str, Any]]:
    return [
        row for row in speeds if row["batch"] == batch and group in (row["class"], "robustness")
    ]
