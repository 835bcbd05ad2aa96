"""Destinations of metrics: files in the run's own directory, and services on request."""

import contextlib
import csv
import io
import json
import math
import os
from collections.abc import Callable, Iterator, Mapping
from pathlib import Path
from typing import Any, Final, Protocol

from kinetix.files.atomic import write_atomically
from kinetix.files.regular import FileError, read_bytes
from kinetix.training.config import PpoConfig
from kinetix.training.events import EventFile
from kinetix.training.films import drop_films, stored_films
from kinetix.training.resume import DAMAGED, damaged_name
from kinetix.training.settings import as_table

JSONL: Final = "metrics.jsonl"
CSV: Final = "metrics.csv"
TENSORBOARD: Final = "tensorboard"
UPDATE: Final = "timing/num_updates"
"""Column that counts updates; a run that goes on drops the rows after its checkpoint by it."""
_LARGEST: Final = 1e300
STEPS: Final = "timing/num_env_steps"
"""Column that counts environment steps; TensorBoard's axis."""


class Sink(Protocol):
    """Something that takes metrics."""

    def write(self, metrics: Mapping[str, float]) -> None:
        """Take the metrics of one update, by name; those that count are among them."""
        ...

    def film(self, steps: int, film: Path) -> None:
        """Take a film of the agent after some environment steps: a GIF file."""
        ...

    def close(self) -> None:
        """Write out what is buffered."""
        ...


def open_sinks(run: Path, config: PpoConfig, *, updates: int = 0) -> list[Sink]:
    """Return the run's own files, and what the configuration asks for besides.

    Args:
        run: The run's directory.
        config: The configuration.
        updates: How many updates are done; the run goes on from there.

    Raises:
        KinetixError: A service was asked for whose extra is not installed.
    """
    sinks: list[Sink] = []
    if config.wandb_project:
        from kinetix.training.wandb import WandbSink

        sinks.append(WandbSink(run, config, as_table(config)))
    return [MetricsLog(run, updates=updates), *sinks]


class MetricsLog:
    """Writes one row an update.

    The JSON lines are the truth. The CSV, with a column for every metric that has occurred, and the
    events of TensorBoard are made from them, again whenever a run goes on.
    """

    def __init__(self, run: Path, *, updates: int = 0) -> None:
        """Open the log.

        Args:
            run: The run's directory.
            updates: Rows of later updates are dropped: the run goes on from there.
        """
        self._path, self._csv = run / JSONL, run / CSV
        rows = _rows_until(run, updates)
        self._columns = _columns(rows)
        text = "".join(json.dumps(row) + "\n" for row in rows)
        # In one piece: a kill in between must not cost the rows of a whole training.
        write_atomically(self._path, text.encode())
        write_atomically(self._csv, _csv_text(rows, self._columns).encode())
        if rows or not updates:
            done = rows[-1][STEPS] / rows[-1][UPDATE] * updates if rows else 0
            drop_films(run, after=round(done))
        self._events = EventFile(run / TENSORBOARD, rows, axis=STEPS, films=stored_films(run))

    def write(self, metrics: Mapping[str, float]) -> None:
        """Append a row; numbers that are not finite are left out.

        Args:
            metrics: By name; must have the two columns that count.

        Raises:
            FileError: It cannot be written.
        """
        row = {name: value for name, value in metrics.items() if math.isfinite(value)}
        _append(self._path, json.dumps(row) + "\n")
        if set(row) <= set(self._columns):
            _append(self._csv, _csv_text([row], self._columns, header=False))
        else:
            rows = read_metrics(self._path.parent)
            self._columns = _columns(rows)
            write_atomically(self._csv, _csv_text(rows, self._columns).encode())
        with _named(self._path.with_name(TENSORBOARD)):
            self._events.write(row)

    def film(self, steps: int, film: Path) -> None:
        """Show a film among TensorBoard's pictures.

        Args:
            steps: Environment steps after which it was made.
            film: A GIF, which lies in the run's directory.

        Raises:
            FileError: It cannot be written.
        """
        with _named(self._path.with_name(TENSORBOARD)):
            self._events.film(steps, film)

    def close(self) -> None:
        """Write out what is buffered."""
        self._events.close()


def _append(path: Path, text: str) -> None:
    """Add to a file, and have it on the disk before anything that builds on it."""
    with _named(path), path.open("a", encoding="utf-8", newline="") as file:
        file.write(text)
        file.flush()
        os.fsync(file.fileno())


@contextlib.contextmanager
def _named(path: Path) -> Iterator[None]:
    """Let an error of the system name the file, which writes and full disks leave out.

    Raises:
        FileError: There was one.
    """
    try:
        yield
    except OSError as error:
        why = error.strerror or str(error)
        raise FileError(
            path, f"cannot be written: {why}; once that is repaired, the same command continues"
        ) from error


def _csv_text(rows: list[dict[str, float]], columns: list[str], *, header: bool = True) -> str:
    text = io.StringIO()
    writer = csv.DictWriter(text, columns)
    if header:
        writer.writeheader()
    writer.writerows(rows)
    return text.getvalue()


def read_metrics(run: Path) -> list[dict[str, float]]:
    """Return all rows of a run, one an update; lines that are no row are left out.

    A kill or a full disk cuts the last line off; where more lines follow, they count. Of an update
    that is there twice the later row counts. They are in the order of the updates.

    Args:
        run: The run's directory.

    Raises:
        FileError: The file is there and cannot be read.
    """
    path = run / JSONL
    if not os.path.isfile(path):
        return []
    return parse_rows(read_bytes(path, "metrics"))


def parse_rows(data: bytes) -> list[dict[str, float]]:
    """Return the rows that some lines hold; see `read_metrics`.

    Args:
        data: Lines of the file.
    """
    rows: dict[float, dict[str, float]] = {}
    for line in data.decode("utf-8", errors="replace").split("\n"):
        row = _row(line)
        if row is not None:
            rows[row[UPDATE]] = row
    return [rows[update] for update in sorted(rows)]


def keep_damaged_rows(run: Path, updates: int, say: Callable[[str], None]) -> None:
    """Keep a copy of metrics of which a run that goes on would lose rows.

    Args:
        run: The run's directory.
        updates: How many updates are done.
        say: Takes a sentence where an update has no row; once, as a run may go on without.
    """
    path = run / JSONL
    own = sum(row[UPDATE] <= updates for row in read_metrics(run))
    rows = len(_rows_until(run, updates))
    there = f"has rows of {own} of {updates} updates" if os.path.isfile(path) else "is not there"
    if rows > own:
        say(f"{path}: {there}; rows of {rows - own} are taken from {CSV}")
    told_before = os.path.lexists(path.with_name(f"{path.name}{DAMAGED}"))
    if rows >= updates or (told_before and _only_rows(path)):
        return
    lost = f"{path}: {there}; rows of {updates - rows} are lost"
    if os.path.isfile(path):
        kept = damaged_name(path)
        write_atomically(kept, read_bytes(path, "metrics"))
        lost += f", and {kept.name} keeps the file as it was"
    say(lost)


def _only_rows(path: Path) -> bool:
    """Return whether a file is there and loses nothing when it is rewritten."""
    if not os.path.isfile(path):
        return False
    lines = read_bytes(path, "metrics").decode("utf-8", errors="replace").split("\n")
    return all(not line or _row(line) is not None for line in lines)


def _rows_until(run: Path, updates: int) -> list[dict[str, float]]:
    """The rows of so many updates; what the JSON lines lack is taken from the CSV."""
    rows = {row[UPDATE]: row for row in (*_csv_rows(run), *read_metrics(run))}
    return [rows[update] for update in sorted(rows) if update <= updates]


def _csv_rows(run: Path) -> Iterator[dict[str, float]]:
    """Yield the complete rows of the CSV."""
    path = run / CSV
    if not os.path.isfile(path):
        return
    lines = read_bytes(path, "metrics").decode("utf-8", errors="replace").splitlines(keepends=True)
    whole = [line for line in lines if line.endswith("\n")]
    with contextlib.suppress(csv.Error):  # a field without an end
        for cells in csv.DictReader(whole):
            row = _cells(cells)
            if row is not None:
                yield row


def _cells(cells: Mapping[str, Any]) -> dict[str, float] | None:
    """The numbers of a row of the CSV; None where one is none, or there are too few or too many."""
    try:
        return _checked({name: json.loads(text) for name, text in cells.items() if text != ""})
    except (ValueError, TypeError):
        return None


def _row(line: str) -> dict[str, float] | None:
    try:
        return _checked(json.loads(line))
    except (ValueError, RecursionError):
        return None


def _checked(row: Any) -> dict[str, float] | None:
    """The numbers of a row; None where it is none."""
    if not isinstance(row, dict):
        return None
    numbers = {name: x for name, x in row.items() if type(x) in (int, float) and abs(x) <= _LARGEST}
    return numbers if UPDATE in numbers and STEPS in numbers else None


def _columns(rows: list[dict[str, float]]) -> list[str]:
    """Return names in the order of their first occurrence."""
    return list(dict.fromkeys(name for row in rows for name in row))
