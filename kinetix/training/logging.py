"""Where metrics go: files in the run's own directory, and services where they are asked for."""

import csv
import json
import math
from collections.abc import Mapping
from pathlib import Path
from typing import Any, Final, Protocol

from kinetix.level.atomic import write_atomically
from kinetix.training.config import PpoConfig
from kinetix.training.settings import as_table

JSONL: Final = "metrics.jsonl"
CSV: Final = "metrics.csv"
TENSORBOARD: Final = "tensorboard"
UPDATE: Final = "timing/num_updates"
"""Column that counts updates; a run that goes on drops the rows after its checkpoint by it."""
STEPS: Final = "timing/num_env_steps"
"""Column that counts environment steps; TensorBoard's axis."""


class Sink(Protocol):
    """Something that takes metrics."""

    def write(self, metrics: Mapping[str, float]) -> None:
        """Take the metrics of one update, by name; those that count are among them."""
        ...

    def close(self) -> None:
        """Write out what is buffered."""
        ...


def open_sinks(run: Path, config: PpoConfig, *, updates: int = 0) -> list[Sink]:
    """The run's own files, and what the configuration asks for besides.

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

        sinks.append(WandbSink(run, config.wandb_project, as_table(config)))
    return [MetricsLog(run, updates=updates), *sinks]


class MetricsLog:
    """Writes one row an update.

    The JSON lines are the truth; the CSV is made from them, with a column for every metric that has
    occurred, and TensorBoard gets the same numbers.
    """

    def __init__(self, run: Path, *, updates: int = 0) -> None:
        """Open the log.

        Args:
            run: The run's directory.
            updates: Rows of later updates are dropped: the run goes on from there.
        """
        # Its import takes half a second and is of no use to those who only read configurations.
        from tensorboardX import SummaryWriter

        self._path, self._csv = run / JSONL, run / CSV
        rows = [row for row in read_metrics(run) if row.get(UPDATE, 0) <= updates]
        self._columns = _columns(rows)
        text = "".join(json.dumps(row) + "\n" for row in rows)
        # In one piece: a kill in between must not cost the rows of a whole training.
        write_atomically(self._path, text.encode())
        self._rewrite_csv(rows)
        purge = int(rows[-1][STEPS]) + 1 if rows else 0
        self._board = SummaryWriter(str(run / TENSORBOARD), purge_step=purge)

    def write(self, metrics: Mapping[str, float]) -> None:
        """Append a row; numbers that are not finite are left out.

        Args:
            metrics: By name; must have the two columns that count.
        """
        row = {name: value for name, value in metrics.items() if math.isfinite(value)}
        with self._path.open("a", encoding="utf-8") as file:
            file.write(json.dumps(row) + "\n")
        if set(row) <= set(self._columns):
            with self._csv.open("a", newline="", encoding="utf-8") as file:
                csv.DictWriter(file, self._columns).writerow(row)
        else:
            rows = read_metrics(self._path.parent)
            self._columns = _columns(rows)
            self._rewrite_csv(rows)
        for name, value in row.items():
            self._board.add_scalar(name, value, int(row[STEPS]))

    def close(self) -> None:
        """Write out what is buffered."""
        self._board.close()

    def _rewrite_csv(self, rows: list[dict[str, Any]]) -> None:
        with self._csv.open("w", newline="", encoding="utf-8") as file:
            writer = csv.DictWriter(file, self._columns)
            writer.writeheader()
            writer.writerows(rows)


def read_metrics(run: Path) -> list[dict[str, Any]]:
    """All rows of a run; a last line that was cut off by a kill is left out.

    Args:
        run: The run's directory.
    """
    path = run / JSONL
    if not path.is_file():
        return []
    rows = []
    for line in path.read_text(encoding="utf-8", errors="replace").splitlines():
        try:
            rows.append(json.loads(line))
        except json.JSONDecodeError:
            break
    return rows


def _columns(rows: list[dict[str, Any]]) -> list[str]:
    """Names in the order of their first occurrence."""
    return list(dict.fromkeys(name for row in rows for name in row))
