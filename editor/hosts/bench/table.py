"""The whole table."""

import statistics
import sys
from collections.abc import Iterator

from editor.hosts.bench.core import core_rows
from editor.hosts.bench.drawing import drawing_rows
from editor.hosts.bench.gallery import gallery_rows
from editor.hosts.bench.launch import first_seconds_rows, launch_seconds
from editor.hosts.bench.playing import playing_rows
from editor.hosts.bench.rows import Row
from editor.hosts.bench.watching import watching_rows


def measure(size: tuple[int, int]) -> Iterator[Row]:
    """Measure everything, and yield each row when it is known.

    Args:
        size: Size of the window of the drawing measurements [px].
    """
    launch = statistics.median(launch_seconds() for _ in range(3))
    yield Row(code="PE5", metric="launch to third frame", value=f"{launch:.2f} s", target="1.5 s")
    yield from first_seconds_rows()
    yield from core_rows()
    yield from drawing_rows(size)
    yield from gallery_rows()
    yield from playing_rows()
    yield from watching_rows()


def print_table(size: tuple[int, int]) -> None:
    """Measure, and print the table on stdout as it grows."""
    for row in measure(size):
        sys.stdout.write(f"{row.code:<5} {row.metric:<48} {row.value:>18}   target {row.target}\n")
        sys.stdout.flush()
