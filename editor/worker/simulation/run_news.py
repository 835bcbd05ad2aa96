"""Training runs looked at while they train: a reading goes on where the one before ended."""

import os
from pathlib import Path

from editor.worker.requests import Place, ReadRun, RunNews
from kinetix.agents.checkpoint import steps_of_run
from kinetix.errors import KinetixError
from kinetix.files.regular import open_regular
from kinetix.training.logging import JSONL, UPDATE, parse_rows


def read_run(request: ReadRun) -> RunNews:
    """Return the news of a training run.

    Raises:
        KinetixError: The folder does not exist, or its metrics cannot be read.
    """
    run = Path(request.path)
    if not os.path.isdir(run):
        raise KinetixError(f"{run}: expected the folder of a training run, found none")
    rows, place = _read_on(run / JSONL, request.after)
    steps = steps_of_run(run)
    total = len(rows) if place is None else place.rows
    return RunNews(rows=tuple(rows), total=total, newest=steps[-1] if steps else None, place=place)


def _read_on(path: Path, after: Place | None) -> tuple[list[dict[str, float]], Place | None]:
    """Return the rows after a place, or all where the file does not go on from there."""
    if not os.path.isfile(path):
        return [], None
    if after is not None:
        lines = _lines(path, after)
        rows = parse_rows(lines.removeprefix(after.last_line))
        going_on = all(row[UPDATE] > after.update for row in rows)
        if lines.startswith(after.last_line) and going_on:
            return rows, _place(lines, rows, after)
    rows = parse_rows(lines := _lines(path, None))
    return rows, _place(lines, rows, None)


def _lines(path: Path, after: Place | None) -> bytes:
    """Return the whole lines from the one before a place on, or all."""
    start = 0 if after is None else after.offset - len(after.last_line)
    with open_regular(path, "metrics") as file:
        file.seek(start)
        data = file.read(max(os.fstat(file.fileno()).st_size - start, 0))
    return data[: data.rfind(b"\n") + 1]


def _place(lines: bytes, rows: list[dict[str, float]], after: Place | None) -> Place | None:
    """Return the place at the end of some lines, which begin with the one before `after`."""
    if after is not None and not rows:
        return after
    if not rows:
        return None
    last_line = lines[lines.rfind(b"\n", 0, -1) + 1 :]
    before = 0 if after is None else after.offset - len(after.last_line)
    return Place(
        rows=len(rows) + (0 if after is None else after.rows),
        offset=before + len(lines),
        last_line=last_line,
        update=max(row[UPDATE] for row in rows),
    )
