"""Use the app offscreen for a while and watch its memory: drawing, playing, gallery, undo, tabs.

    python scripts/soak.py --minutes 30

Prints the resident memory every few seconds, and at the end how much it has grown since everything
had been done once, and what that makes in 30 minutes (a straight line through the measurements);
threads and open files that are left, and the frame that took the window's thread longest.
"""

import argparse
import itertools
import os
import statistics
import sys
import threading
import time
from collections.abc import Callable, Iterator
from pathlib import Path

from editor import actions
from editor.actions import file
from editor.base.events import InputEvent, KeyEvent, Pointer, PointerEvent
from editor.base.settings import Settings
from editor.gallery.results import Results
from editor.hosts.offscreen import OffscreenHost
from editor.play.playback import Mode
from editor.session import Session
from kinetix.paths import levels_dir

TARGET_MB = 50.0
"""Most growth in 30 minutes (editor.md PE10)."""
_WARM_UP_ROUNDS = 3
"""After so many rounds everything has been compiled and every cache been filled."""
_FRAME = 1 / 60
LONGEST_FRAME = 0.25
"""Most processor time of the window's thread in one frame after the warm-up [s]."""


def resident_mb() -> float:
    """Resident memory of this process [MB]."""
    pages = int(Path("/proc/self/statm").read_text().split()[1])
    return pages * os.sysconf("SC_PAGE_SIZE") / 1e6


def open_files() -> int:
    """How many files, pipes and sockets this process has open."""
    return len(os.listdir("/proc/self/fd"))


class Soak:
    """A tireless user."""

    def __init__(self, host: OffscreenHost) -> None:
        self.host = host
        self.session = host.session
        self.levels = itertools.cycle(sorted(levels_dir().glob("s/*.json")))
        self.rounds = 0
        self.slowest = 0.0
        """Processor time of the slowest frame after the warm-up [s]."""

    @property
    def warm(self) -> bool:
        """Whether everything has been done often enough to be judged."""
        return self.rounds >= _WARM_UP_ROUNDS

    def step(self, *events: InputEvent) -> None:
        """Draw a frame."""
        began = time.thread_time()
        self.host.step(events, _FRAME)
        if self.warm:
            self.slowest = max(self.slowest, time.thread_time() - began)

    def frames(self, count: int) -> Iterator[None]:
        """Draw frames; a step of the soak each."""
        for _ in range(count):
            self.step()
            yield

    def key(self, name: str) -> None:
        """Press and release a key."""
        for pressed in (True, False):
            self.step(KeyEvent(key=name, pressed=pressed))

    def drag(self, start: tuple[float, float], end: tuple[float, float]) -> None:
        """Draw with the mouse, in level metres."""
        to_screen = self.session.camera.to_screen
        for kind, at, button in (
            (Pointer.MOVE, start, 0),
            (Pointer.PRESS, start, 1),
            (Pointer.MOVE, end, 1),
            (Pointer.RELEASE, end, 1),
        ):
            event = PointerEvent(kind=kind, world=at, screen=to_screen(at), button=button)
            self.step(event)

    def run(self) -> Iterator[None]:
        """One round: open, draw, undo, play, look at the gallery, close."""
        session = self.session
        file.open_path(session, next(self.levels))
        yield from self.frames(20)
        for key, end in (("r", (3.4, 3.2)), ("c", (2.4, 3.0))):
            self.key(key)
            self.drag((2.0, 2.6), end)
            yield from self.frames(5)
        for _ in range(4):
            actions.run(session, "edit.undo")
            yield from self.frames(5)
        actions.run(session, "run.play_human")
        self.step(KeyEvent(key="left", pressed=True))
        deadline = time.monotonic() + 120
        while session.playback.step_count < 120 and time.monotonic() < deadline:
            if session.mode is Mode.ENDED:
                break
            self.step()
            time.sleep(0.004)
            yield
        self.step(KeyEvent(key="left", pressed=False))
        actions.run(session, "run.stop")
        yield from self.frames(10)
        actions.run(session, "level.gallery")
        yield from self.frames(60)
        actions.run(session, "gallery.close")
        for document in [tab.document for tab in session.tabs]:
            document.mark_saved()
        actions.run(session, "file.close_tab")
        yield from self.frames(5)
        self.rounds += 1


def slope(points: list[tuple[float, float]]) -> float:
    """The least-squares line's growth a minute."""
    if len(points) < 3:
        return 0.0
    return statistics.linear_regression(*zip(*points, strict=True)).slope


def main(write: Callable[[str], object] = sys.stdout.write) -> int:
    """Run it.

    Returns:
        0 when the growth in 30 minutes stays within the target, else 1.
    """
    parser = argparse.ArgumentParser(description=(__doc__ or "").splitlines()[0])
    parser.add_argument("--minutes", type=float, default=30.0)
    minutes = parser.parse_args().minutes
    session = Session(settings=Settings(), results=Results(stored=False))
    host = OffscreenHost(session, size=(1280, 800))
    soak = Soak(host)
    start = shown = time.monotonic()
    settled: list[tuple[float, float]] = []
    held: tuple[int, int] | None = None
    work = soak.run()
    while (elapsed := (time.monotonic() - start) / 60) < minutes:
        if next(work, soak) is soak:
            work = soak.run()
        if time.monotonic() - shown > 5.0:
            shown = time.monotonic()
            memory = resident_mb()
            write(f"{elapsed:6.2f} min  {memory:8.1f} MB  {soak.rounds} rounds\n")
            if soak.warm:
                settled.append((elapsed, memory))
                held = held or (threading.active_count(), open_files())
    textures = host._pictures.texture_count
    now = (threading.active_count(), open_files())
    session.worker.stop(5)
    session.evaluator.stop(5)
    session.library.stop(5)
    host.close()
    if len(settled) < 3:
        write("too short to say anything: give it more minutes\n")
        return 1
    grown, expected = settled[-1][1] - settled[0][1], 30 * slope(settled)
    write(
        f"grown by {grown:.1f} MB in {settled[-1][0] - settled[0][0]:.1f} min after "
        f"{_WARM_UP_ROUNDS} rounds; "
        f"a straight line makes that {expected:.0f} MB in 30 min (target {TARGET_MB:.0f}); "
        f"{textures} textures of the app's own\n"
    )
    threads, files = (after - before for after, before in zip(now, held or now, strict=True))
    write(
        f"{threads:+} threads, {files:+} open files; slowest frame {1000 * soak.slowest:.0f} ms of "
        f"processor time (at most {1000 * LONGEST_FRAME:.0f})\n"
    )
    # The gallery's thread and a worker's come and go; what leaks does so every round.
    return int(expected > TARGET_MB or max(threads, files) > 8 or soak.slowest > LONGEST_FRAME)


if __name__ == "__main__":
    sys.exit(main())
