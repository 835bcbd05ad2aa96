"""Where metrics go: JSON lines, CSV and TensorBoard events in the run's own directory."""

import csv
import json
import math
from collections.abc import Mapping
from pathlib import Path
from typing import Any, Final

JSONL: Final = "metrics.jsonl"
CSV: Final = "metrics.csv"
TENSORBOARD: Final = "tensorboard"
UPDATE: Final = "timing/num_updates"
"""Column that counts updates; a run that goes on drops the rows after its checkpoint by it."""
STEPS: Final = "timing/num_env_steps"
"""Column that counts environment steps; TensorBoard's axis."""


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
        self._path.write_text(text, encoding="utf-8")
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
