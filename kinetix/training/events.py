"""Metrics as TensorBoard reads them: one event a row, without a thread of its own."""

import importlib
import shutil
import time
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

SECONDS = "timing/seconds"
"""Column of the time that the training has taken [s]."""


class EventFile:
    """The events of a run: rows from before, then each row as it comes.

    A kill leaves at most a cut event at the end, which TensorBoard passes over; the next start
    writes everything anew.
    """

    def __init__(self, folder: Path, rows: Sequence[Mapping[str, float]], *, axis: str) -> None:
        """Write the rows so far into a new file, which takes the place of all before it.

        Args:
            folder: TensorBoard's folder.
            rows: What is known, one row an update.
            axis: Column of the number that TensorBoard counts by.
        """
        # The package's own writer has a thread, which a full disk ends without a word.
        from tensorboardX.event_file_writer import EventsWriter

        shutil.rmtree(folder, ignore_errors=True)
        folder.mkdir(parents=True, exist_ok=True)
        self._axis = axis
        self._writer = EventsWriter(str(folder / "events"))
        elapsed = rows[-1].get(SECONDS, 0.0) if rows else 0.0
        self._began = time.time() - elapsed
        for row in rows:
            self._add(row, self._began + row.get(SECONDS, elapsed))
        self._writer.flush()

    def write(self, row: Mapping[str, float]) -> None:
        """Add a row.

        Args:
            row: By name; must have the column of the axis.
        """
        self._add(row, time.time())
        self._writer.flush()

    def close(self) -> None:
        """Close the file."""
        self._writer.close()

    def _add(self, row: Mapping[str, float], when: float) -> None:
        proto = "tensorboardX.proto"
        summaries: Any = importlib.import_module(f"{proto}.summary_pb2")  # made without types
        events: Any = importlib.import_module(f"{proto}.event_pb2")
        summary = summaries.Summary(
            value=[summaries.Summary.Value(tag=name, simple_value=x) for name, x in row.items()]
        )
        event = events.Event(wall_time=when, step=int(row[self._axis]), summary=summary)
        self._writer.write_event(event)
