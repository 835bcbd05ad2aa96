"""The first seconds of the app, measured in a process of its own: `python -m` this, see `main`.

Space is pressed in the first frame; then the level is played in real time while everything else is
compiled in the background, with restarts where an episode ends.
"""

import dataclasses
import json
import os
import statistics
import subprocess
import sys
import tempfile
import time
from typing import Final

from editor.base.events import FRAME

_LONGEST: Final = 120.0
"""The measurement ends after this, however much there is to compile [s]."""
_LEAST: Final = 6.0
"""… and lasts this long where nothing is left to compile [s]."""


@dataclasses.dataclass(frozen=True, kw_only=True)
class FirstSeconds:
    """Times that a person waits after starting the app."""

    window: float
    """From the start of the process to the first frame [s]."""
    moving: float
    """From Space, pressed in that frame, to the first frame with a simulated step [s]."""
    processor: float
    """Processor time of the process until then [s]."""
    real_time: float
    """Simulated time over wall time while the rest was compiled."""
    frame_median: float
    """Median duration of a frame [ms]."""
    frame_longest: float
    """Longest duration of a frame [ms]."""
    compiling: float
    """Duration of the rest [s]."""


def main() -> None:
    """Measure once; print one JSON object. Arguments: when the process was started, the level."""
    started, level = float(sys.argv[1]), sys.argv[2]
    from editor.actions.files import file
    from editor.base.settings import Settings
    from editor.gallery.results import Results
    from editor.hosts.offscreen import OffscreenHost
    from editor.play.playback import Mode
    from editor.session import Session
    from editor.worker.jobs import PREPARATIONS, lane_of

    session = Session(settings=Settings(), results=Results(stored=False))
    session.play_quickly()
    host = OffscreenHost(session, size=(1280, 800))
    host.ui.warm_up = True
    file.open_path(session, level)
    host.step((), FRAME)
    window = time.time() - started

    walls: list[float] = []
    last = time.perf_counter()

    def frame() -> float:
        """Return a frame at its time; its wall time, the sleep left out."""
        nonlocal last
        begin = time.perf_counter()
        host.step((), begin - last)
        last = begin
        took = time.perf_counter() - begin
        time.sleep(max(FRAME - took, 0))
        return took

    pressed = time.perf_counter()
    session.queue("run.play_human")
    while session.playback.step_count < 1 and time.perf_counter() - pressed < _LONGEST:
        walls.append(frame())
    moving, processor = time.perf_counter() - pressed, time.process_time()

    begun, simulated, wall = time.perf_counter(), 0.0, 0.0
    while (spent := time.perf_counter() - begun) < _LONGEST:
        lanes = [lane_of(job.request) for job in session.worker.jobs]
        if spent > _LEAST and PREPARATIONS not in lanes:
            break
        playback = session.playback
        before, at = playback.engine_step, time.perf_counter()
        episode, going = playback.episode, session.mode is Mode.PLAYING and not playback.waiting
        walls.append(frame())
        if going and playback.episode == episode:
            simulated += (playback.engine_step - before) * FRAME
            wall += time.perf_counter() - at
        if session.mode is Mode.ENDED:
            session.queue("run.reset")
    told = FirstSeconds(
        window=window,
        moving=moving,
        processor=processor,
        real_time=simulated / wall,
        frame_median=1000 * statistics.median(walls),
        frame_longest=1000 * max(walls),
        compiling=spent,
    )
    if "--keep" in sys.argv:
        session.queue("run.stop")
        until = time.perf_counter() + _LONGEST
        while time.perf_counter() < until and not _written():
            frame()
            time.sleep(0.05)
    sys.stdout.write(json.dumps(dataclasses.asdict(told)) + "\n")
    sys.stdout.flush()
    os._exit(0)  # a compilation may be under way


def _written() -> bool:
    """Return whether both steps of the level are on disk: the quick one, and that of its size."""
    from kinetix.paths import cache_dir

    return len(list((cache_dir() / "steps").glob("*.step"))) > 1


def measure(level: str = "l/rover_ridge") -> tuple[FirstSeconds, FirstSeconds]:
    """Return the first day, with an empty cache, and the second."""
    with tempfile.TemporaryDirectory() as cache:
        variables = {"TF_CPP_MIN_LOG_LEVEL": "3", **os.environ, "XDG_CACHE_HOME": cache}
        variables.pop("JAX_COMPILATION_CACHE_DIR", None)

        def once(*more: str) -> FirstSeconds:
            command = [sys.executable, "-m", __name__, str(time.time()), level, *more]
            done = subprocess.run(
                command, capture_output=True, text=True, check=True, env=variables
            )
            return FirstSeconds(**json.loads(done.stdout.splitlines()[-1]))

        cold = once("--keep")
        return cold, once()


if __name__ == "__main__":
    main()
