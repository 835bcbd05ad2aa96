"""The gallery with many levels."""

import statistics
import tempfile
import time
from pathlib import Path
from typing import Final

from editor.base.events import FRAME, WheelEvent
from editor.base.settings import Settings
from editor.gallery.library import Library
from editor.gallery.results import Results
from editor.hosts import gl
from editor.hosts.bench.rows import Row
from editor.hosts.offscreen import OffscreenHost
from editor.session import Session
from kinetix.level.codec import load_level, save_level
from kinetix.paths import levels_dir

_MANY: Final = 1000
"""Levels in the gallery."""


def gallery_rows() -> list[Row]:
    """A thousand levels: the first page with everything cached, and scrolling through them."""
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        (folder / "levels").mkdir()
        base = load_level("s/first_flight")
        for k in range(_MANY):
            level = base.replace(name=f"Level {k}", max_timesteps=k + 1)
            save_level(level, folder / "levels" / f"level_{k:04d}.json")
        first = Library(folder / "cache")
        first.look([levels_dir(), folder / "levels"])
        first.wait(300)
        first.stop()
        settings = Settings(gallery_folders=[str(folder / "levels")])
        session = Session(
            settings=settings,
            library=Library(folder / "cache"),
            results=Results(stored=False),
        )
        host = OffscreenHost(session, size=(1280, 800))
        for _ in range(10):
            host.step((), FRAME)
        start = time.perf_counter()
        session.queue("level.gallery")
        while len(session.library.cards) < _MANY:
            host.step((), FRAME)
        gl.finish()
        painted = time.perf_counter() - start
        walls = []
        for _ in range(180):
            wheel = WheelEvent(dy=-0.5, screen=(500.0, 400.0))
            start = time.perf_counter()
            host.step([wheel], FRAME)
            gl.finish()
            walls.append(1000 * (time.perf_counter() - start))
            time.sleep(max(FRAME - (time.perf_counter() - start), 0))
        session.library.stop()
        session.worker.stop()
        host.close()
    p99 = sorted(walls)[int(0.99 * len(walls))]
    return [
        Row(
            code="GA1",
            metric="gallery of 1000 levels: first page, cached",
            value=f"{1000 * painted:.0f} ms",
            target="300 ms",
        ),
        Row(
            code="GA1",
            metric="gallery of 1000 levels: scrolling, median / p99",
            value=f"{statistics.median(walls):.1f} / {p99:.1f} ms",
            target="16.7 ms",
        ),
    ]
