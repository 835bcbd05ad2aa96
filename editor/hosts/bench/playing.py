"""Play: its start, its frames, its distance from real time."""

import statistics
import time

from editor.actions.files import file
from editor.base.events import FRAME
from editor.base.settings import Settings
from editor.gallery.results import Results
from editor.hosts.bench.rows import Row
from editor.hosts.offscreen import OffscreenHost
from editor.play.mode import Mode
from editor.session import Session
from editor.worker.jobs import Worker
from kinetix.paths import levels_dir


def _first_frame(host: OffscreenHost) -> float:
    """Presses Play and waits for a simulated step [s]."""
    session = host.session
    start = time.perf_counter()
    session.queue("run.play_human")
    while session.playback.step_count < 1 and time.perf_counter() - start < 300:
        host.step((), FRAME)
    return time.perf_counter() - start


def playing_rows() -> list[Row]:
    """Measure Play: its start, its frames, its distance from real time."""
    session = Session(settings=Settings(), worker=Worker(), results=Results(stored=False))
    session.play_quickly()
    host = OffscreenHost(session, size=(1280, 1040))
    paths = sorted((levels_dir() / "l").glob("*.json"))[:2]
    file.open_path(session, paths[0])
    cold = _first_frame(host)
    walls, steps = [], []
    last = time.perf_counter()
    for _ in range(180):
        host.step((), time.perf_counter() - last if walls else FRAME)
        now = time.perf_counter()
        walls.append(1000 * (now - last))
        last = now
        snapshot = session.playback.snapshot
        if snapshot is not None:
            steps.append(snapshot.milliseconds)
        if session.mode is Mode.ENDED:
            session.queue("run.reset")
        time.sleep(max(FRAME - (time.perf_counter() - last), 0))
    factor = session.playback.real_time_factor
    session.queue("run.stop")
    host.step((), FRAME)
    warm = _first_frame(host)
    session.queue("run.stop")
    host.step((), FRAME)
    file.open_path(session, paths[1])
    other = _first_frame(host)
    session.worker.stop()
    host.close()
    return [
        Row(code="PE6", metric="Play to first step, cold", value=f"{cold:.1f} s", target="-"),
        Row(
            code="PE6",
            metric="Play to first step, warm",
            value=f"{1000 * warm:.0f} ms",
            target="100 ms",
        ),
        Row(
            code="PE7",
            metric="Play to first step, other level of the size",
            value=f"{1000 * other:.0f} ms",
            target="no compilation",
        ),
        Row(
            code="PE8",
            metric="environment step (2 engine steps), size l",
            value=f"{statistics.median(steps):.1f} ms",
            target="8 ms",
        ),
        Row(
            code="PE8",
            metric="real-time factor / frame median while playing",
            value=f"{factor:.2f} / {statistics.median(walls):.1f} ms",
            target="1.00 / 16.7 ms",
        ),
    ]
