"""Measure the engine, the environment and the renderer on this machine."""

import dataclasses
import json as json_module
from collections.abc import Iterable
from pathlib import Path
from typing import Annotated, Any

import tyro

from kinetix.errors import KinetixError


@dataclasses.dataclass(frozen=True, kw_only=True)
class MeasureSpeed:
    """Steps per second of the engine and of the environment, on hand-made levels."""

    sizes: str = "s,m,l"
    """Sizes, with commas between them."""
    batches: str = "1,64,1024"
    """Worlds stepped at once, with commas between them."""
    physics: str = "balanced"
    """Physics preset or solver."""
    observation: str = "none"
    """Kind of observation, or none."""
    levels: Path | None = None
    """Folder of levels; by default the bundled ones."""
    specialised: bool = False
    """Compile each level for itself alone; the median over the levels counts."""
    json: bool = False
    """Print one JSON object a figure on stdout, and nothing else there."""


@dataclasses.dataclass(frozen=True, kw_only=True)
class MeasureRender:
    """Frames per second of the renderers."""

    json: bool = False
    """Print one JSON object a figure on stdout, and nothing else there."""


@dataclasses.dataclass(frozen=True, kw_only=True)
class MeasureAccuracy:
    """Errors of the engine in scenes with known answers."""

    scenes: str = "core"
    """core, all, or ids such as B1,D5."""
    physics: str = "balanced"
    """Physics preset or solver."""
    json: bool = False
    """Print one JSON object a scene on stdout, and nothing else there."""


Bench = (
    Annotated[MeasureSpeed, tyro.conf.subcommand("speed")]
    | Annotated[MeasureRender, tyro.conf.subcommand("render")]
    | Annotated[MeasureAccuracy, tyro.conf.subcommand("accuracy")]
)


def run(command: MeasureSpeed | MeasureRender | MeasureAccuracy) -> int:
    """Measure and print one line a figure or scene.

    Raises:
        KinetixError: An option names nothing known, or is not a number.
    """
    if isinstance(command, MeasureAccuracy):
        return _accuracy(command)
    rows = _speed(command) if isinstance(command, MeasureSpeed) else _render()
    for row in rows:
        print(json_module.dumps(row) if command.json else _text(row), flush=True)
    return 0


def _speed(command: MeasureSpeed) -> Iterable[dict[str, Any]]:
    # Imported here, so that a wrong command line fails before JAX loads.
    batches = _integers("--batches", command.batches)
    from kinetix.bench.speed import SpeedSettings, measure_speed

    return measure_speed(
        SpeedSettings(
            sizes=tuple(command.sizes.split(",")),
            batches=batches,
            physics=command.physics,
            observation=command.observation,
            levels=command.levels,
            specialised=command.specialised,
        )
    )


def _render() -> Iterable[dict[str, Any]]:
    from kinetix.bench.render import RenderSettings
    from kinetix.bench.render import run as measure

    return measure(RenderSettings())


def _accuracy(command: MeasureAccuracy) -> int:
    from kinetix.bench.accuracy import AccuracySettings, measure_accuracy
    from kinetix.bench.report import scene_text, summary_text

    rows = []
    for row in measure_accuracy(AccuracySettings(scenes=command.scenes, physics=command.physics)):
        rows.append(row)
        print(json_module.dumps(row) if command.json else scene_text(row), flush=True)
    if not command.json:
        print(summary_text(rows))
    return 0


def _integers(option: str, text: str) -> tuple[int, ...]:
    try:
        return tuple(int(part) for part in text.split(","))
    except ValueError:
        raise KinetixError(
            f"{option} {text}: expected whole numbers with commas between them, such as 1,64"
        ) from None


def _text(row: dict[str, Any]) -> str:
    return "  ".join(
        f"{name} {value:,}" if isinstance(value, int | float) else f"{name} {value}"
        for name, value in row.items()
    )
