"""The metrics of a training run in columns. Plain numpy."""

from array import array
from collections.abc import Iterable, Mapping

import numpy as np
from jaxtyping import Float

STEPS = "timing/num_env_steps"
"""Horizontal axis of the metrics."""


class Metrics:
    """Grows by a row an update; a metric may be missing in some rows."""

    def __init__(self, rows: Iterable[Mapping[str, float]] = ()) -> None:
        self._columns: dict[str, tuple[array[float], array[float]]] = {}
        self._count = 0
        self.steps: int | None = None
        """Environment steps of the last row, if it has them."""
        self.extend(rows)

    def __len__(self) -> int:
        """Return the number of rows."""
        return self._count

    @property
    def names(self) -> tuple[str, ...]:
        """Names of all metrics, in the order of their first occurrence."""
        return tuple(self._columns)

    def extend(self, rows: Iterable[Mapping[str, float]]) -> None:
        """Add rows at the end."""
        for row in rows:
            self._count += 1
            steps = row.get(STEPS)
            self.steps = None if steps is None else int(steps)
            for name, value in row.items():
                x, y = self._columns.setdefault(name, (array("d"), array("d")))
                x.append(len(x) if steps is None else steps)
                y.append(value)

    def column(self, name: str) -> tuple[Float[np.ndarray, " k"], Float[np.ndarray, " k"]]:
        """Return environment steps and values of a metric in the rows that have it.

        Without environment steps a row has its number among those.
        """
        x, y = self._columns.get(name, (array("d"), array("d")))
        return np.array(x, np.float64), np.array(y, np.float64)
