"""Frames of Edit."""

import math
import statistics
import threading
import time

from editor.base.events import FRAME, Pointer, PointerEvent
from editor.base.settings import Settings
from editor.hosts import gl
from editor.hosts.bench.rows import Row, crowded_level
from editor.hosts.offscreen import OffscreenHost
from editor.session import Session


def _moves(host: OffscreenHost, count: int) -> list[float]:
    """Frames with a moving mouse, drawn to the end: wall times [ms]."""
    walls = []
    for k in range(count):
        at = (640 + 200 * math.cos(k / 20), 380 + 150 * math.sin(k / 20))
        event = PointerEvent(kind=Pointer.MOVE, world=(0, 0), screen=at, button=0)
        start = time.perf_counter()
        host.step([event], FRAME)
        # Software OpenGL draws in a thread of its own and would fall behind unnoticed.
        gl.finish()
        walls.append(1000 * (time.perf_counter() - start))
    return walls


def drawing_rows(size: tuple[int, int]) -> list[Row]:
    """Measure frames of Edit in a window of this size [px], and an idle app."""
    session = Session(settings=Settings(), level=crowded_level())
    host = OffscreenHost(session, size=size)
    ui_only = host.ui.frame
    ui_times: list[float] = []

    def timed(dt: float) -> None:
        start = time.thread_time()
        ui_only(dt)
        ui_times.append(1000 * (time.thread_time() - start))

    host.ui.frame = timed
    _moves(host, 30)
    ui_times.clear()
    walls = _moves(host, 180)
    p99 = sorted(walls)[int(0.99 * len(walls))]
    rows = [
        Row(
            code="PE1",
            metric="edit frame, 50 entities: interface",
            value=f"{statistics.median(ui_times):.2f} ms",
            target="4 ms",
        ),
        Row(
            code="PE1",
            metric="edit frame with software OpenGL, median / p99",
            value=f"{statistics.median(walls):.1f} / {p99:.1f} ms",
            target="16.7 / 33 ms",
        ),
        _idle(host),
    ]
    session.worker.stop()
    host.close()
    return rows


def _idle(host: OffscreenHost) -> Row:
    """Processor time of the loop while nothing happens."""
    marks: list[float] = []
    for delay in (1.0, 3.0):
        threading.Timer(delay, lambda: marks.append(time.process_time())).start()

    def leave() -> None:
        host.session.closing.done = True

    threading.Timer(3.1, leave).start()
    host.run()
    share = (marks[1] - marks[0]) / 2.0
    return Row(code="PE4", metric="idle processor time", value=f"{share:.1%}", target="3 %")
