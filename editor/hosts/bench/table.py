"""The whole table."""

import statistics
import sys

from editor.hosts.bench.core import core_rows
from editor.hosts.bench.drawing import drawing_rows
from editor.hosts.bench.gallery import gallery_rows
from editor.hosts.bench.launch import first_seconds_rows, launch_seconds
from editor.hosts.bench.playing import playing_rows
from editor.hosts.bench.rows import Row
from editor.hosts.bench.watching import watching_rows


def measure(size: tuple[int, int]) -> list[Row]:
    """Measure everything.

    Args:
        size: Size of the window of the drawing measurements [px].
    """
    launch = statistics.median(launch_seconds() for _ in range(3))
    start = Row(code="PE5", metric="launch to third frame", value=f"{launch:.2f} s", target="1.5 s")
    return [
        start,
        *first_seconds_rows(),
        *core_rows(),
        *drawing_rows(size),
        *gallery_rows(),
        *playing_rows(),
        *watching_rows(),
    ]


def print_table(size: tuple[int, int]) -> None:
    """Measure and print the table on stdout."""
    for row in measure(size):
        sys.stdout.write(f"{row.code:<5} {row.metric:<48} {row.value:>18}   target {row.target}\n")
        sys.stdout.flush()
