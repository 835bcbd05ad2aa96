"""Metrics as TensorBoard reads them: one event a row, without a thread of its own."""

import importlib
import shutil
import time
from collections.abc import Iterable, Mapping, Sequence
from pathlib import Path
from typing import Any

from PIL import Image

SECONDS = "timing/seconds"
"""Column of the time that the training has taken [s]."""


class EventFile:
    """The events of a run: rows from before, then each row as it comes.

    A kill leaves at most a cut event at the end, which TensorBoard passes over; the next start
    rewrites everything.
    """

    def __init__(
        self,
        folder: Path,
        rows: Sequence[Mapping[str, float]],
        *,
        axis: str,
        films: Iterable[tuple[int, Path]] = (),
    ) -> None:
        """Write the rows so far into a new file, which takes the place of all before it.

        Args:
            folder: TensorBoard's folder.
            rows: What is known, one row an update.
            axis: Column of the number that TensorBoard counts by.
            films: What was filmed so far, each with its number on the axis.
        """
        # The package's own writer has a thread, which a full disk ends without a word.
        from tensorboardX.event_file_writer import EventsWriter

        shutil.rmtree(folder, ignore_errors=True)
        folder.mkdir(parents=True, exist_ok=True)
        self._axis = axis
        self._summaries, self._events = (
            importlib.import_module(f"tensorboardX.proto.{name}_pb2")  # made without types
            for name in ("summary", "event")
        )
        self._writer = EventsWriter(str(folder / "events"))
        elapsed = rows[-1].get(SECONDS, 0.0) if rows else 0.0
        self._began = time.time() - elapsed
        times = {int(row[axis]): self._began + row.get(SECONDS, elapsed) for row in rows}
        for row in rows:
            self._add(row, times[int(row[axis])])
        for steps, film in films:
            self._add_film(steps, film, times.get(steps, self._began))
        self._writer.flush()

    def write(self, row: Mapping[str, float]) -> None:
        """Add a row.

        Args:
            row: By name; must have the column of the axis.
        """
        self._add(row, time.time())
        self._writer.flush()

    def film(self, steps: int, film: Path) -> None:
        """Add a film.

        Args:
            steps: Where it stands on the axis.
            film: A GIF; its tag is `film/` and its name.
        """
        self._add_film(steps, film, time.time())
        self._writer.flush()

    def close(self) -> None:
        """Close the file."""
        self._writer.close()

    def _add(self, row: Mapping[str, float], when: float) -> None:
        value = self._summaries.Summary.Value
        values = [value(tag=name, simple_value=x) for name, x in row.items()]
        self._put(values, int(row[self._axis]), when)

    def _add_film(self, steps: int, film: Path, when: float) -> None:
        with Image.open(film) as picture:
            width, height = picture.size
        summary = self._summaries.Summary
        image = summary.Image(
            height=height, width=width, colorspace=3, encoded_image_string=film.read_bytes()
        )
        self._put([summary.Value(tag=f"film/{film.stem}", image=image)], steps, when)

    def _put(self, values: list[Any], steps: int, when: float) -> None:
        summary = self._summaries.Summary(value=values)
        self._writer.write_event(self._events.Event(wall_time=when, step=steps, summary=summary))
