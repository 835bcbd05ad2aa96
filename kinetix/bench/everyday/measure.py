"""Share of everyday scenes that go wrong, one row per class."""

import dataclasses
from collections.abc import Iterator, Mapping, Sequence
from pathlib import Path
from typing import Any, Final

import numpy as np

from kinetix.bench.everyday.judge import LIMITS, Recorded, bad, excess, judge
from kinetix.bench.everyday.ours import record
from kinetix.bench.everyday.peers import record_peer
from kinetix.bench.peers.catalogue import peer_named
from kinetix.engine.names import DEFAULT_PHYSICS
from kinetix.engine.presets import solver_named
from kinetix.errors import KinetixError, LevelError
from kinetix.level.codec import save_level
from kinetix.scenes.everyday.catalogue import CLASSES, draw_all

PEERS: Final = ("box2d", "pymunk", "jax2d")
"""Engines to compare with; jax2d is our preset of that name."""


@dataclasses.dataclass(frozen=True, kw_only=True)
class EverydaySettings:
    """Settings of the everyday measurement."""

    count: int = 500
    seed: int = 0
    physics: str = DEFAULT_PHYSICS
    peer: str | None = None
    """One of `PEERS`; None: our engine."""
    classes: tuple[str, ...] = tuple(CLASSES)
    save: Path | None = None
    """Folder for the levels of bad scenes."""


def measure_everyday(settings: EverydaySettings) -> Iterator[dict[str, Any]]:
    """Yield a row per class as soon as it is known.

    Raises:
        KinetixError: A name is unknown, a number makes no sense, or the engine is not
            installed.
    """
    _check(settings)
    engine = settings.peer or settings.physics
    for name, scenes in draw_all(settings.count, settings.seed, settings.classes).items():
        if not scenes:
            continue
        if settings.peer in (None, "jax2d"):
            recorded = record(scenes, engine)
        else:
            recorded = record_peer(scenes, peer_named(engine))
        judged = [judge(each) for each in recorded]
        row = row_of(name, engine, recorded, judged)
        unsaved = [] if settings.save is None else _save(settings.save, name, recorded, judged)
        yield row | ({"unsaved": unsaved} if unsaved else {})


def row_of(
    name: str,
    engine: str,
    recorded: Sequence[Recorded],
    judged: Sequence[Mapping[str, float | None]],
) -> dict[str, Any]:
    """Return a class's result as the command prints it.

    `bad` counts the scenes with any number beyond its limit; `worst` is the number farthest beyond;
    `metrics` has for each number how many scenes have it, how many are bad, the median, and the
    worst with its scene. Where levels are saved, `measure_everyday` adds `unsaved`, a sentence for
    each that a level file cannot hold.
    """
    values = [
        (number, metric, value)
        for number, numbers in enumerate(judged)
        for metric, value in numbers.items()
    ]
    return {
        "class": name,
        "physics": engine,
        "scenes": len(recorded),
        "bad": sum(bool(bad(numbers)) for numbers in judged),
        "worst": _worst(values, recorded),
        "metrics": {
            metric: _metric(metric, [value for value in values if value[1] == metric], recorded)
            for metric in LIMITS
            if any(value[1] == metric for value in values)
        },
    }


_Value = tuple[int, str, float | None]


def _worst(values: Sequence[_Value], recorded: Sequence[Recorded]) -> dict[str, Any] | None:
    if not values:
        return None
    number, metric, value = max(values, key=lambda each: excess(each[1], each[2]))
    return {
        "metric": metric,
        "value": value,
        "unit": LIMITS[metric].unit,
        "scene": number,
        "size": recorded[number].scene.room,
    }


def _metric(name: str, values: Sequence[_Value], recorded: Sequence[Recorded]) -> dict[str, Any]:
    numbers = [np.inf if value is None else value for _, _, value in values]
    median = float(np.median(numbers))
    worst = _worst(values, recorded)
    assert worst is not None
    return {
        "unit": LIMITS[name].unit,
        "limit": LIMITS[name].limit,
        "scenes": len(values),
        "bad": sum(bool(bad({name: value})) for _, _, value in values),
        "median": median if np.isfinite(median) else None,
        "worst": worst["value"],
        "scene": worst["scene"],
    }


def _check(settings: EverydaySettings) -> None:
    solver_named(settings.physics)
    if settings.count < 1:
        raise KinetixError(f"--count {settings.count}: expected at least 1")
    if settings.peer not in (None, *PEERS):
        raise KinetixError(f"--peer {settings.peer}: expected one of {', '.join(PEERS)}")
    unknown = [name for name in settings.classes if name not in CLASSES]
    if unknown:
        raise KinetixError(f"--classes {unknown[0]}: expected some of {','.join(CLASSES)}")


def _save(
    folder: Path,
    name: str,
    recorded: Sequence[Recorded],
    judged: Sequence[Mapping[str, float | None]],
) -> list[str]:
    """Write the levels of bad scenes; a sentence for each that a level file cannot hold."""
    unsaved = []
    for number, (each, numbers) in enumerate(zip(recorded, judged, strict=True)):
        found = bad(numbers)
        if found:
            level = each.scene.trial.level
            text = ", ".join(f"{metric} {numbers[metric]}" for metric in found)
            folder.mkdir(parents=True, exist_ok=True)
            try:
                save_level(level.replace(description=text), folder / f"{name}-{number}.json")
            except LevelError as error:  # faster, or farther away, than a level may be
                unsaved.append(str(error))
    return unsaved


def text_of(row: Mapping[str, Any]) -> str:
    """Return a row for people."""
    worst = row["worst"]
    head = f"{row['class']:12}{row['scenes']:4} scenes{row['bad']:5} bad"
    parts = [
        f"{name} {metric['bad']}/{metric['scenes']}"
        for name, metric in row["metrics"].items()
        if metric["bad"]
    ]
    if not parts:
        return head
    value = "broken" if worst["value"] is None else f"{worst['value']:.3g} {worst['unit']}"
    place = f"scene {worst['scene']}, {worst['size']}"
    unsaved = "".join(f"\n  not saved: {sentence}" for sentence in row.get("unsaved", ()))
    return f"{head}   {', '.join(parts)}; worst {worst['metric']} {value} ({place}){unsaved}"
