"""Measure the engine, the environment and the renderer on this machine."""

import contextlib
import dataclasses
import itertools
import json as json_module
import sys
from collections.abc import Callable, Iterable, Iterator
from pathlib import Path
from typing import Annotated, Any

import tyro

from kinetix.cli.shared.one_core import OneCore
from kinetix.cli.shared.terminal import Terminal, announced
from kinetix.cores import wanted_cores
from kinetix.engine.names import DEFAULT_PHYSICS
from kinetix.errors import KinetixError


@dataclasses.dataclass(frozen=True, kw_only=True)
class MeasureSpeed:
    """Steps per second of the engine and of the environment, on hand-made levels."""

    sizes: str = "s,m,l"
    """Sizes, with commas between them."""
    batches: str = "1,64,1024"
    """Worlds stepped at once, with commas between them."""
    physics: str = DEFAULT_PHYSICS
    """Physics preset or solver."""
    observation: str = "none"
    """Kind of observation, or none."""
    levels: Path | None = None
    """Folder of levels; by default the bundled ones."""
    specialised: bool = False
    """Compile each level for itself alone; the median over the levels counts."""
    scenes: bool = False
    """Time the bare step in scenes of the accuracy suite instead of levels."""
    cores: int | None = None
    """Processor cores to use (KINETIX_CORES, else all)."""
    json: bool = False
    """Print one JSON object a figure on stdout, and nothing else there."""


@dataclasses.dataclass(frozen=True, kw_only=True)
class MeasureRender(OneCore):
    """Frames per second of the renderers."""

    json: bool = False
    """Print one JSON object a figure on stdout, and nothing else there."""


@dataclasses.dataclass(frozen=True, kw_only=True)
class MeasureAccuracy(OneCore):
    """Errors of the engine in scenes with known answers."""

    scenes: str = "core"
    """core, all, classes such as built, and ids such as B1,D5, with commas between them."""
    physics: str = DEFAULT_PHYSICS
    """Physics preset or solver."""
    peer: str | None = None
    """Another engine instead of ours, such as box2d; `make bench-peers` installs them."""
    json: bool = False
    """Print one JSON object a scene on stdout, and nothing else there."""


@dataclasses.dataclass(frozen=True, kw_only=True)
class MeasureEveryday(OneCore):
    """Measure how often things that people build go wrong, in scenes that a seed determines."""

    count: int = 500
    """Number of scenes."""
    seed: int = 0
    """Of the scenes."""
    physics: str = DEFAULT_PHYSICS
    """Physics preset or solver."""
    peer: str | None = None
    """Another engine instead of ours: box2d, pymunk or jax2d; `make bench-peers` installs the first
    two."""
    classes: str = "all"
    """all, or classes such as walls,cars."""
    save: Path | None = None
    """Folder for the levels of scenes that go wrong."""
    json: bool = False
    """Print one JSON object a class on stdout, and nothing else there."""


@dataclasses.dataclass(frozen=True, kw_only=True)
class MeasurePeers(OneCore):
    """Speed of other engines and of ours, in turn, on levels; then their part of the chart."""

    sizes: str = "s,m,l"
    """Sizes, with commas between them; none leaves the levels out."""
    batch: int = 1024
    """Worlds of the environment step."""
    physics: str = DEFAULT_PHYSICS
    """Our physics preset or solver."""
    levels: Path | None = None
    """Folder of levels; by default the bundled ones."""
    chart: str = "none"
    """Peers whose errors and speeds in the suite's scenes are measured for the chart: names with
    commas between them, defaults (each engine's), all (their other settings too) or none."""
    results: Path = Path("bench")
    """Folder for the measured rows."""
    cores: int | None = None
    """Processor cores that many worlds are spread over (KINETIX_CORES, else all)."""
    json: bool = False
    """Print one JSON object a figure on stdout, and nothing else there."""


@dataclasses.dataclass(frozen=True, kw_only=True)
class MeasureScaling(OneCore):
    """Steps per second and compile time against the number of bodies and of worlds."""

    bodies: str = "8,16,32,64,128,256"
    """Numbers of bodies, with commas between them; none leaves them out."""
    worlds: str = "1,16,256,1024,4096,16384"
    """Numbers of worlds, with commas between them; none leaves them out."""
    devices: str = "1,2"
    """Numbers of host devices that the worlds are spread over."""
    size: str = "m"
    """Size of the levels of which there are many worlds."""
    physics: str = DEFAULT_PHYSICS
    """Physics preset or solver."""
    chart: Path | None = None
    """Also draw the figures into this PNG file, and keep them beside it as JSON."""
    cores: int | None = None
    """Processor cores to use at most: larger numbers of --devices are left out."""
    json: bool = False
    """Print one JSON object a figure on stdout, and nothing else there."""


@dataclasses.dataclass(frozen=True, kw_only=True)
class DrawChart(OneCore):
    """Speed against error: measure our part, and draw it with what is stored of other engines."""

    out: Path = Path("docs")
    """Folder for chart.png and chart.json."""
    results: Path = Path("bench")
    """Folder of the measured rows."""
    physics: str = "stored"
    """Presets and solvers whose speed is measured, with commas between them; or all, none, or
    stored: those whose errors are in the folder of rows already. Missing errors are measured
    first."""
    quick: bool = False
    """Measure fast, balanced and accurate only, with many worlds."""
    cores: int | None = None
    """Processor cores that many worlds are spread over (KINETIX_CORES, else all)."""
    json: bool = False
    """Print the chart's data on stdout, and nothing else there."""


Bench = (
    Annotated[MeasureSpeed, tyro.conf.subcommand("speed")]
    | Annotated[MeasureRender, tyro.conf.subcommand("render")]
    | Annotated[MeasureAccuracy, tyro.conf.subcommand("accuracy")]
    | Annotated[MeasureEveryday, tyro.conf.subcommand("everyday")]
    | Annotated[MeasurePeers, tyro.conf.subcommand("peers")]
    | Annotated[MeasureScaling, tyro.conf.subcommand("scaling")]
    | Annotated[DrawChart, tyro.conf.subcommand("chart")]
)
Command = (
    MeasureSpeed
    | MeasureRender
    | MeasureAccuracy
    | MeasureEveryday
    | MeasurePeers
    | MeasureScaling
    | DrawChart
)


def run(command: Command) -> int:
    """Measure and print one line a figure or scene.

    Raises:
        KinetixError: An option names nothing known, or is not a number.
    """
    if isinstance(command, MeasureAccuracy):
        return _accuracy(command)
    if isinstance(command, MeasureEveryday):
        return _everyday(command)
    if isinstance(command, DrawChart):
        return _chart(command)
    rows = _printed(_rows(command), _text, json=command.json)
    if isinstance(command, MeasureScaling) and command.chart is not None and rows:
        from kinetix.bench.chart.scaling import write_scaling

        write_scaling(rows, command.chart)
    return 0


def _printed(
    found: Iterable[dict[str, Any]], text: Callable[[dict[str, Any]], str], *, json: bool
) -> list[dict[str, Any]]:
    """Print a line a row as soon as it is measured, and return the rows."""
    rows = []
    for row in _watched(found):
        rows.append(row)
        print(json_module.dumps(row) if json else text(row), flush=True)
    return rows


def _watched(rows: Iterable[dict[str, Any]]) -> Iterator[dict[str, Any]]:
    """Report on stderr which line is being measured: the first may compile for a minute."""
    found = iter(rows)
    with contextlib.closing(Terminal()) as terminal:
        for number in itertools.count(1):
            with announced(f"compiling and measuring line {number}", say=terminal.status):
                row = next(found, None)
            terminal.close()
            if row is None:
                return
            yield row


def _rows(
    command: MeasureSpeed | MeasureRender | MeasurePeers | MeasureScaling,
) -> Iterable[dict[str, Any]]:
    match command:
        case MeasureSpeed():
            return _scene_speed(command) if command.scenes else _speed(command)
        case MeasurePeers():
            return _peers(command)
        case MeasureScaling():
            return _scaling(command)
    return _render()


def _scene_speed(command: MeasureSpeed) -> Iterable[dict[str, Any]]:
    batches = _integers("--batches", command.batches)
    from kinetix.bench.scene_speed import measure_scenes, scene_speed
    from kinetix.engine.presets import solver_named

    solver = solver_named(command.physics)
    return measure_scenes(batches, lambda trial, batch: scene_speed(trial, solver, batch))


def _peers(command: MeasurePeers) -> Iterable[dict[str, Any]]:
    from kinetix.bench.peers.levels import LevelSettings, measure_levels, ratios
    from kinetix.bench.peers.store import chosen_peers, measure_for_chart

    peers = chosen_peers(command.chart)
    sizes = () if command.sizes == "none" else tuple(command.sizes.split(","))
    settings = LevelSettings(
        sizes=sizes, batch=command.batch, physics=command.physics, levels=command.levels
    )
    rows = []
    for row in measure_levels(settings):
        rows.append(row)
        yield row
    yield from ratios(rows)
    for peer in peers:
        yield from measure_for_chart(peer, command.results, command.cores or wanted_cores())


def _scaling(command: MeasureScaling) -> Iterable[dict[str, Any]]:
    bodies = _integers("--bodies", command.bodies)
    worlds = _integers("--worlds", command.worlds)
    devices = _integers("--devices", command.devices)
    devices = tuple(count for count in devices if count <= (command.cores or count))
    if not (bodies or worlds or devices):
        raise KinetixError("--bodies, --worlds and --devices are none: there is nothing to measure")
    from kinetix.bench.scaling import ScalingSettings, measure_scaling

    return measure_scaling(
        ScalingSettings(
            bodies=bodies,
            worlds=worlds,
            devices=devices,
            size=command.size,
            physics=command.physics,
        )
    )


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
    from kinetix.bench.peers.accuracy import measure_peer
    from kinetix.bench.peers.catalogue import peer_named
    from kinetix.bench.report import scene_text, summary_text

    if command.peer:
        found = measure_peer(peer_named(command.peer), command.scenes)
    else:
        settings = AccuracySettings(scenes=command.scenes, physics=command.physics)
        found = measure_accuracy(settings)
    rows = _printed(found, scene_text, json=command.json)
    if not command.json:
        print(summary_text(rows))
    return 0


def _everyday(command: MeasureEveryday) -> int:
    from kinetix.bench.everyday.measure import EverydaySettings, measure_everyday, text_of
    from kinetix.scenes.everyday.catalogue import CLASSES

    names = tuple(CLASSES) if command.classes == "all" else tuple(command.classes.split(","))
    settings = EverydaySettings(
        count=command.count,
        seed=command.seed,
        physics=command.physics,
        peer=command.peer,
        classes=names,
        save=command.save,
    )
    rows = _printed(measure_everyday(settings), text_of, json=command.json)
    if not command.json:
        print(f"{sum(row['bad'] for row in rows)} of {sum(row['scenes'] for row in rows)} bad")
    return 0


def _chart(command: DrawChart) -> int:
    from kinetix.bench.chart.build import (
        BATCHES,
        QUICK,
        ChartSettings,
        build_chart,
        every_physics,
        facet_text,
        stored_physics,
    )
    from kinetix.engine.presets import solver_named

    groups = {"all": every_physics(), "stored": stored_physics(command.results), "none": ()}
    physics = groups.get(command.physics, tuple(command.physics.split(",")))
    for name in physics:
        solver_named(name)
    settings = ChartSettings(
        out=command.out,
        results=command.results,
        physics=QUICK if command.quick else physics,
        batches=BATCHES[-1:] if command.quick else BATCHES,
        cores=command.cores or wanted_cores(),
    )
    data = build_chart(settings, lambda text: print(text, file=sys.stderr, flush=True))
    if command.json:
        print(json_module.dumps(data))
    else:
        print("\n".join(facet_text(facet) for facet in data["facets"]))
        print(settings.out / "chart.png")
    return 0


def _integers(option: str, text: str) -> tuple[int, ...]:
    if text == "none":
        return ()
    try:
        numbers = tuple(int(part) for part in text.split(","))
        if min(numbers) < 1:
            raise ValueError
        return numbers
    except ValueError:
        raise KinetixError(
            f"{option} {text}: expected whole numbers from 1 with commas between them, such as 1,64"
        ) from None


def _text(row: dict[str, Any]) -> str:
    return "  ".join(
        f"{name} {value:,}" if isinstance(value, int | float) else f"{name} {value}"
        for name, value in row.items()
    )
