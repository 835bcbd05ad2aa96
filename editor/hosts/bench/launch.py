"""From the command to the first frames."""

import subprocess
import sys
import time
from typing import Final

from editor.hosts import first_seconds
from editor.hosts.bench.rows import Row

_LAUNCH: Final = """
import sys, time
from editor.hosts import gl
from editor.hosts.offscreen import OffscreenHost
from editor.session import Session
from editor.actions import agents, file
host = OffscreenHost(Session(), size=(1280, 800))
file.open_path(host.session, "l/rover_ridge")
for _ in range(3):
    host.step((), 1 / 60)
assert "jax" not in sys.modules
print(time.time())
"""


def launch_seconds() -> float:
    """Seconds from the start of a process to its third frame."""
    start = time.time()
    done = subprocess.run(
        [sys.executable, "-c", _LAUNCH], capture_output=True, text=True, check=True
    )
    return float(done.stdout.strip().splitlines()[-1]) - start


def first_seconds_rows() -> list[Row]:
    """Measure the first seconds with an empty cache, and those of the second start."""
    rows = []
    days = first_seconds.measure()
    for day, told, space in zip(("cold", "warm"), days, ("8 s", "1 s"), strict=True):
        rows += [
            Row(
                code="FS1",
                metric=f"{day}: launch to first frame",
                value=f"{told.window:.2f} s",
                target="1 s",
            ),
            Row(
                code="FS1",
                metric=f"{day}: Space to first moving frame (processor)",
                value=f"{told.moving:.1f} s ({told.processor:.1f} s)",
                target=space,
            ),
            Row(
                code="FS2",
                metric=f"{day}: share of real time while compiling",
                value=f"{told.real_time:.2f}",
                target="0.95",
            ),
            Row(
                code="FS2",
                metric=f"{day}: frame meanwhile, median / longest",
                value=f"{told.frame_median:.1f} / {told.frame_longest:.0f} ms",
                target="16.7 / 100 ms",
            ),
        ]
    return rows
