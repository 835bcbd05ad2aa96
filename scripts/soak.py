"""Use the app for hours of its own clock and watch it: edit, play, evaluate, look around, think.

    python scripts/soak.py --hours 8

Pauses in which a person thinks pass in frames of a second, everything else in frames of 1/60 s, so
that eight hours take about half an hour; Ctrl+C ends it early. Prints memory while it goes on, and
at the end how much it has grown since everything had been done once; threads, open files, textures
and arrays of JAX that are left; and the frame that took the window's thread longest.
"""

import argparse
import collections
import gc
import itertools
import os
import statistics
import sys
import tempfile
import threading
import time
from collections.abc import Callable
from pathlib import Path

from editor import actions
from editor.actions.evaluation import measure
from editor.actions.files import file
from editor.actions.watching import agents
from editor.base.events import InputEvent, KeyEvent, Pointer, PointerEvent
from editor.base.settings import Settings
from editor.gallery.results import Results
from editor.hosts.offscreen import OffscreenHost
from editor.play.mode import Mode
from editor.session import Session
from editor.toolkit.thumbnails import SLOTS
from kinetix.paths import levels_dir

TARGET_MB = 50.0
"""Most growth after the warm-up."""
LONGEST_FRAME = 0.25
"""Most processor time of the window's thread in one frame after the warm-up [s]."""
_LEVELS = 4
"""Opened in turn."""
_WARM_UP = 3
"""Laps over the levels after which everything has been compiled and every cache been filled."""
_FRAME = 1 / 60
_THOUGHT = 60
"""Time for which a person thinks in a round [s]."""
_PICTURES = 2
"""Textures besides those of thumbnails: what is played, and what an agent sees."""
_PATIENCE = 300.0
"""Longest wait for the compiler or an evaluation [s of the wall]."""


def resident_mb() -> float:
    """Resident memory of this process [MB]."""
    pages = int(Path("/proc/self/statm").read_text().split()[1])
    return pages * os.sysconf("SC_PAGE_SIZE") / 1e6


def open_files() -> int:
    """Count the files, pipes and sockets that this process has open."""
    return len(os.listdir("/proc/self/fd"))


class Soak:
    """A tireless user."""

    def __init__(self, host: OffscreenHost) -> None:
        self.host = host
        self.session = host.session
        self.levels = itertools.cycle(sorted(levels_dir().glob("s/*.json"))[:_LEVELS])
        self.rounds = 0
        self.slowest = 0.0
        """Processor time of the slowest frame after the warm-up [s]."""

    @property
    def warm(self) -> bool:
        """True if everything has been done often enough to be judged."""
        return self.rounds >= _WARM_UP * _LEVELS

    def step(self, *events: InputEvent, seconds: float = _FRAME) -> None:
        """Draw a frame."""
        began = time.thread_time()
        self.host.step(events, seconds)
        if self.warm:
            self.slowest = max(self.slowest, time.thread_time() - began)

    def frames(self, count: int, seconds: float = _FRAME) -> None:
        """Draw frames in which nothing is done."""
        for _ in range(count):
            self.step(seconds=seconds)

    def until(self, done: Callable[[], bool]) -> None:
        """Draw frames until something is so."""
        until = time.monotonic() + _PATIENCE
        while not done() and time.monotonic() < until:
            self.step()
            time.sleep(0.004)

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

    def round(self) -> None:
        """Open, draw, undo, play, evaluate now and then, look at the gallery, think, close."""
        path = next(self.levels)
        file.open_path(self.session, path)
        self.frames(20)
        self._edit()
        self._play()
        if self.rounds % 5 == 0:
            self._evaluate(path)
        actions.run(self.session, "level.gallery")
        self.frames(60)
        actions.run(self.session, "gallery.close")
        self.frames(_THOUGHT, seconds=1.0)
        for document in [tab.document for tab in self.session.tabs]:
            document.mark_saved()
        actions.run(self.session, "file.close_tab")
        self.frames(5)
        self.rounds += 1

    def _edit(self) -> None:
        for key, end in (("r", (3.4, 3.2)), ("c", (2.4, 3.0))):
            self.key(key)
            self.drag((2.0, 2.6), end)
            self.frames(5)
        # Now and then it is another level that is played: the step is recompiled.
        for _ in range(4 if self.rounds % 3 else 1):
            actions.run(self.session, "edit.undo")
            self.frames(5)

    def _play(self) -> None:
        session, playback = self.session, self.session.playback
        actions.run(session, "run.play_human")
        self.step(KeyEvent(key="left", pressed=True))
        self.until(lambda: playback.step_count >= 120 or session.mode is not Mode.PLAYING)
        self.step(KeyEvent(key="left", pressed=False))
        actions.run(session, "run.stop")
        self.frames(10)

    def _evaluate(self, path: Path) -> None:
        session = self.session
        place = session.viewer.slots["a"]
        if place.summary is None:
            agents.load_agent(session, "random")
            self.until(lambda: not place.loading)
        with session.guard():
            measure.start_evaluation(
                session,
                (place.summary,) if place.summary else (),
                (str(path),),
                attempts=2,
                seed=self.rounds,
                physics="balanced",
                deterministic=False,
            )
        self.until(lambda: session.evaluator.idle)


def held() -> dict[str, int]:
    """Count the resources that may leak besides memory."""
    jax = sys.modules.get("jax")
    return {
        "threads": threading.active_count(),
        "open files": open_files(),
        "arrays of JAX": len(jax.live_arrays()) if jax else 0,
    }


def growth(points: list[tuple[float, float]]) -> float:
    """Return the least-squares line's growth from the first point to the last."""
    if len(points) < 3:
        return 0.0
    slope = statistics.linear_regression(*zip(*points, strict=True)).slope
    return slope * (points[-1][0] - points[0][0])


def main(write: Callable[[str], object] = sys.stdout.write) -> int:
    """Run it.

    Returns:
        0 when nothing has grown by more than its target, else 1.
    """
    parser = argparse.ArgumentParser(description=(__doc__ or "").splitlines()[0])
    parser.add_argument("--hours", type=float, default=8.0, help="of the app's own clock")
    parser.add_argument("--objects", action="store_true", help="tell which kinds became more")
    options = parser.parse_args()
    place = tempfile.TemporaryDirectory()
    os.environ["XDG_STATE_HOME"] = place.name
    session = Session(settings=Settings(), results=Results(stored=False))
    host = OffscreenHost(session, size=(1280, 800))
    soak = Soak(host)
    memory: list[tuple[float, float]] = []
    before: dict[str, int] = {}
    kinds: collections.Counter[str] = collections.Counter()
    began = time.monotonic()
    while session.time < 3600 * options.hours:
        try:
            soak.round()
        except KeyboardInterrupt:
            break
        if soak.warm:
            memory.append((session.time / 3600, resident_mb()))
            before = before or held()
            if options.objects and not kinds:
                kinds = _kinds()
        write(
            f"{session.time / 3600:5.2f} h ({(time.monotonic() - began) / 60:.1f} min)  "
            f"{resident_mb():8.1f} MB  {soak.rounds} rounds\n"
        )
        sys.stdout.flush()
    after = held()
    if options.objects:
        for kind, more in (_kinds() - kinds).most_common(25):
            write(f"{more:+9,} {kind}\n")
    textures = host._pictures.texture_count
    for worker in (session.worker, session.evaluator, session.library):
        worker.stop(5)
    session.autosaves.end()
    host.close()
    place.cleanup()
    if len(memory) < 3:
        write("too short to say anything: give it more hours\n")
        return 1
    grown = growth(memory)
    write(
        f"{soak.rounds} rounds, {memory[-1][0]:.1f} h: memory has grown by {grown:+.1f} MB "
        f"(at most {TARGET_MB:.0f}) since round {_WARM_UP * _LEVELS}; {textures} textures\n"
    )
    more = {name: after[name] - count for name, count in before.items()}
    write(", ".join(f"{count:+} {name}" for name, count in more.items()) + "\n")
    write(
        f"slowest frame {1000 * soak.slowest:.0f} ms of processor time "
        f"(at most {1000 * LONGEST_FRAME:.0f})\n"
    )
    # The gallery's thread and a worker's come and go; what leaks does so every round.
    leaks = max(more["threads"], more["open files"]) > 8 or textures > SLOTS + _PICTURES
    return int(grown > TARGET_MB or leaks or soak.slowest > LONGEST_FRAME)


def _kinds() -> collections.Counter[str]:
    """Count all objects by their types, garbage left out."""
    gc.unfreeze()
    gc.collect()
    return collections.Counter(
        f"{type(one).__module__}.{type(one).__qualname__}" for one in gc.get_objects()
    )


if __name__ == "__main__":
    sys.exit(main())
