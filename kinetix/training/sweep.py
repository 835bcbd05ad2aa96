"""Sweeps: many trainings from one TOML table, each in a directory of its own. Free of JAX.

The table `[grid]` has lists of values, all combinations of which are trained; `[random]` has
`samples` and spreads to draw from, as a list or as `{ low = 1e-4, high = 1e-1, log = true }`; each
`[[run]]` has values of its own, and a name. Where there are several of them, all go with all.
"""

import csv
import dataclasses
import hashlib
import io
import itertools
import json
import math
import os
import random
import re
import statistics
import tomllib
from collections.abc import Iterator, Mapping, Sequence, Set
from pathlib import Path
from typing import Any, Final

from kinetix.errors import KinetixError
from kinetix.files.regular import FileError, read_bytes, read_text
from kinetix.lazy import hint
from kinetix.wording import thousands

TABLE: Final = "sweep.csv"
"""File in the sweep's directory: a row per run, its values and results."""
RESULTS: Final = {
    "solve_rate": ("eval/hand_designed_episode_solve_rate", "average/episode_solved"),
    "return": ("eval/hand_designed_episode_return", "average/episode_return"),
    "steps": ("timing/num_env_steps",),
}
"""Columns of the table: the first of these metrics that a run has, the newest of its rows."""
_SEEDS: Final = "seeds"
"""Column of the number of trainings that the results are means over."""
_PARTS: Final = ("grid", "random", "run")
_IN_VAIN: Final = 1000
"""Draws one after the other that are there already, after which no other is expected."""
_LONGEST_NAME: Final = 120
"""Letters of a directory's name."""


@dataclasses.dataclass(frozen=True)
class SweepRun:
    """One training of a sweep."""

    name: str
    """Name of its directory."""
    values: Mapping[str, Any]
    """Hyper-parameters by name."""


def read_sweep(path: Path) -> list[SweepRun]:
    """Return the runs that a file describes; the same file always gives the same ones.

    Args:
        path: A TOML file.

    Raises:
        KinetixError: It cannot be read, or a table is not as expected; the message says where.
    """
    try:
        content = tomllib.loads(read_text(path, "run"))
    except FileError as error:
        raise KinetixError(str(error)) from None
    except (ValueError, RecursionError) as error:
        raise KinetixError(f"{path}: not valid TOML: {error}") from None
    for part in content:
        if part not in _PARTS:
            raise KinetixError(f"{path}: {part}: {hint(part, _PARTS)}")
    grid = _table(content, "grid", path)
    combinations = [
        dict(zip(grid, values, strict=True))
        for values in itertools.product(*(_choices(grid[name], name, path) for name in grid))
    ]
    listed = content.get("run", [{}])
    if not isinstance(listed, list) or not all(isinstance(run, dict) for run in listed):
        raise KinetixError(f"{path}: run: expected tables that begin with [[run]]")
    drawn = _draws(_table(content, "random", path), path)
    runs = [
        _run(dict(run), values, draw)
        for run, values, draw in itertools.product(listed, combinations, drawn)
    ]
    names = [run.name for run in runs]
    for name in names:
        if names.count(name) > 1:
            raise KinetixError(f"{path}: two runs are called {name!r}: give [[run]] tables a name")
    if not any(run.values for run in runs):
        raise KinetixError(f"{path}: expected a table [grid], [random] or [[run]] with values")
    return runs


def _table(content: Mapping[str, Any], part: str, path: Path) -> dict[str, Any]:
    table = content.get(part, {})
    if not isinstance(table, dict):
        raise KinetixError(f"{path}: {part}: expected a table")
    return dict(table)


def _choices(values: Any, name: str, path: Path) -> list[Any]:
    if not isinstance(values, list) or not values:
        raise KinetixError(f"{path}: grid.{name}: expected a list of values")
    return values


def _draws(table: dict[str, Any], path: Path) -> list[dict[str, Any]]:
    """The draws of a table `random`, all different; one without values where there is none."""
    if not table:
        return [{}]
    samples = table.pop("samples", None)
    if type(samples) is not int or samples < 1:
        raise KinetixError(f"{path}: random.samples: expected a number of draws, at least 1")
    numbers = random.Random(0)
    draws: list[dict[str, Any]] = []
    in_vain = 0
    while len(draws) < samples:
        draw = {
            name: _draw(numbers, spread, f"{path}: random.{name}") for name, spread in table.items()
        }
        in_vain = in_vain + 1 if draw in draws else 0
        if in_vain == 0:
            draws.append(draw)
        elif in_vain == _IN_VAIN:
            raise KinetixError(
                f"{path}: random.samples: expected fewer: only {len(draws)} different draws "
                f"were found, got {samples}"
            )
    return draws


def _draw(numbers: random.Random, spread: Any, where: str) -> Any:
    if isinstance(spread, list) and spread:
        return numbers.choice(spread)
    expected = f"{where}: expected a list, or {{ low = …, high = …, log = true or false }}"
    if not isinstance(spread, dict) or not {"low", "high"} <= set(spread) <= {"low", "high", "log"}:
        raise KinetixError(expected)
    low, high, log = spread["low"], spread["high"], spread.get("log", False)
    if not all(type(x) in (int, float) for x in (low, high)) or type(log) is not bool:
        raise KinetixError(expected)
    if not low < high or (log and low <= 0):
        raise KinetixError(f"{where}: expected {'0 < ' if log else ''}low < high")
    whole = type(low) is type(high) is int
    if log:
        number = math.exp(numbers.uniform(math.log(low), math.log(high)))
        return min(max(round(number), low), high) if whole else _short(number)
    return numbers.randint(low, high) if whole else _short(numbers.uniform(low, high))


def _short(number: float) -> float:
    """Return four digits, so that names and tables stay readable."""
    return float(f"{number:.4g}")


def _run(run: dict[str, Any], *more: Mapping[str, Any]) -> SweepRun:
    name = run.pop("name", "")
    changing = {key: value for values in more for key, value in values.items()}
    told = changing if name else run | changing
    words = [name] if name else []
    words += [f"{key}={_word(value)}" for key, value in told.items()]
    return SweepRun(_directory(",".join(words)), run | changing)


def _word(value: Any) -> str:
    return "+".join(map(_word, value)) if isinstance(value, list) else str(value)


def _directory(name: str) -> str:
    plain = re.sub(r"[^\w.,=+-]+", "_", name).strip(".")
    if len(plain) <= _LONGEST_NAME:
        return plain
    # What tells runs apart may stand at the end of a long name.
    mark = hashlib.sha256(name.encode()).hexdigest()[:8]
    return f"{plain[: _LONGEST_NAME - len(mark) - 1]}-{mark}"


def results(out: Path, run: SweepRun) -> dict[str, float]:
    """Return the results of a run so far: means over its seeds.

    Args:
        out: The sweep's directory.
        run: One of its runs.
    """
    from kinetix.training.logging import read_metrics

    folder = out / run.name
    rows = [
        row for path in (folder, *folder.glob("seed_*")) if (row := _newest(read_metrics(path)))
    ]
    found: dict[str, float] = {}
    for column, metrics in RESULTS.items():
        values = [next((row[name] for name in metrics if name in row), None) for row in rows]
        known = [value for value in values if value is not None]
        if known:
            found[column] = statistics.fmean(known)
    return found | {_SEEDS: len(rows)} if rows else {}


def _newest(rows: Sequence[Mapping[str, float]]) -> dict[str, float]:
    """Return the newest value of every metric."""
    return {name: value for row in rows for name, value in row.items()}


def table(out: Path, runs: Sequence[SweepRun]) -> list[dict[str, Any]]:
    """Return a row per run, the best one first: name, values, results.

    Args:
        out: The sweep's directory.
        runs: Its runs.
    """
    rows = [{"run": run.name, **run.values, **results(out, run)} for run in runs]
    return sorted(rows, key=lambda row: (-row.get("solve_rate", -1.0), -row.get("return", -1e9)))


def write_table(out: Path, runs: Sequence[SweepRun]) -> None:
    """Write the table into the sweep's directory.

    Runs of the table that is there, of a sweep that was changed since, stay in it while their
    directories are there.

    Args:
        out: The sweep's directory.
        runs: Its runs.
    """
    from kinetix.files.atomic import write_atomically
    from kinetix.files.folders import made_folder

    every = [*runs, *_earlier(out, {run.name for run in runs})]
    values = dict.fromkeys(name for run in every for name in run.values)
    text = io.StringIO()
    writer = csv.DictWriter(text, ["run", *values, *RESULTS, _SEEDS])
    writer.writeheader()
    for row in table(out, every):
        writer.writerow({name: _cell(name, value) for name, value in row.items()})
    made_folder(out)
    write_atomically(out / TABLE, text.getvalue().encode())


def _earlier(out: Path, names: Set[str]) -> list[SweepRun]:
    """The runs of the table that is there, besides those of now, whose directories are there."""
    if not os.path.isfile(out / TABLE):
        return []
    text = read_bytes(out / TABLE, "run").decode("utf-8", errors="replace")
    found: dict[str, SweepRun] = {}
    for row in csv.DictReader(io.StringIO(text)):
        name = row.pop("run", None)
        if name and name not in names and os.path.isdir(out / name):
            values = {key: cell for key, cell in row.items() if key and cell}
            own = {key: values[key] for key in values if key not in (*RESULTS, _SEEDS)}
            found[name] = SweepRun(name, own)
    return list(found.values())


def _cell(name: str, value: Any) -> Any:
    if name == "steps":
        return round(value)
    return json.dumps(value) if isinstance(value, list) else value


def lines(rows: Sequence[Mapping[str, Any]]) -> Iterator[str]:
    """Yield the table as text for people.

    Args:
        rows: From `table`.
    """
    yield f"{'solved':>7} {'return':>8} {'steps':>13}  run"
    for row in rows:
        solved, gained = (
            f"{row[name]:.3f}" if name in row else "–" for name in ("solve_rate", "return")
        )
        steps = thousands(round(row["steps"])) if "steps" in row else "–"
        yield f"{solved:>7} {gained:>8} {steps:>13}  {row['run']}"
