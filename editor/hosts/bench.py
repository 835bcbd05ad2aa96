"""`kinetix-editor --bench`: the table of performance targets, measured on this machine."""

import dataclasses
import math
import statistics
import subprocess
import sys
import tempfile
import threading
import time
from collections.abc import Callable
from pathlib import Path
from typing import Final

from editor.actions import agents, file
from editor.base.events import Pointer, PointerEvent, WheelEvent
from editor.base.settings import Settings
from editor.documents import files
from editor.documents.commands.group import Move
from editor.documents.document import Document
from editor.editing import picking
from editor.editing.snapping import Rules, snap_shift, targets
from editor.gallery.library import Library
from editor.gallery.results import Results
from editor.hosts import first_seconds, gl
from editor.hosts.offscreen import OffscreenHost
from editor.play.mode import Mode
from editor.session import Session
from editor.worker.jobs import Worker
from kinetix.level.codec import load_level, save_level
from kinetix.level.model import Body, Circle, Joint, Level, Polygon, Thruster
from kinetix.level.validate import validate
from kinetix.paths import levels_dir

FRAME: Final = 1 / 60
_MANY: Final = 1000
"""Levels in the gallery."""
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


_AGENT: Final = """
import sys
import jax
from kinetix.agents.agent import Agent, save_agent
from kinetix.agents.card import AgentCard
from kinetix.agents.shapes import init_parameters
card = AgentCard(name="as large as the published ones")
save_agent(Agent(card, init_parameters(card, jax.random.key(0))), sys.argv[1])
"""
"""Makes an agent of 0.8 million parameters; in a process of its own, as this one has no JAX."""


@dataclasses.dataclass(frozen=True, kw_only=True)
class Row:
    """One line of the table."""

    code: str
    metric: str
    value: str
    target: str


def crowded_level() -> Level:
    """A level with 50 entities: 36 bodies, 10 joints, 4 thrusters."""
    bodies, joints, thrusters = [], [], []
    square = ((-0.15, -0.15), (0.15, -0.15), (0.15, 0.15), (-0.15, 0.15))
    for k in range(36):
        place = (0.5 + (k % 8) * 0.57, 0.8 + (k // 8) * 0.8)
        shape = Circle(radius=0.15) if k % 2 else Polygon(vertices=square)
        bodies.append(Body(id=k + 1, shape=shape, position=place))
    for k in range(10):
        a, b = 2 * k + 1, 2 * k + 2
        joint = Joint(
            id=37 + k,
            kind="revolute",
            a=a,
            b=b,
            anchor_a=(0.285, 0.0),
            anchor_b=(-0.285, 0.0),
        )
        joints.append(joint)
    for k in range(4):
        thrusters.append(Thruster(id=47 + k, body=25 + k, position=(0.0, -0.1), angle=1.5))
    return Level(
        name="Crowd", bodies=tuple(bodies), joints=tuple(joints), thrusters=tuple(thrusters)
    )


def median_ms(action: Callable[[], object], rounds: int = 60) -> float:
    times = []
    for _ in range(rounds):
        start = time.perf_counter()
        action()
        times.append(time.perf_counter() - start)
    return 1000 * statistics.median(times)


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


def launch_seconds() -> float:
    """Seconds from the start of a process to its third frame."""
    start = time.time()
    done = subprocess.run(
        [sys.executable, "-c", _LAUNCH], capture_output=True, text=True, check=True
    )
    return float(done.stdout.strip().splitlines()[-1]) - start


def drawing_rows(size: tuple[int, int]) -> list[Row]:
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
    threading.Timer(3.1, lambda: setattr(host.session, "quitting", True)).start()
    host.run()
    share = (marks[1] - marks[0]) / 2.0
    return Row(code="PE4", metric="idle processor time", value=f"{share:.1%}", target="3 %")


def core_rows() -> list[Row]:
    level = crowded_level()
    body = level.bodies[0]
    # A drag works out what it may snap to once, when it starts.
    available = targets(level, (body.id,))
    rules = Rules(smart=True, grid=0.1, catch=0.08, release=0.12)

    def hit() -> None:
        picking.stack(level, (2.5, 2.5), 0.08)
        snap_shift((body,), (0.013, 0.011), rules, available)

    document = Document(level)
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder) / "a.json"
        saving = median_ms(lambda: files.save_document(document, path, "kinetix-level"), 20)

    def undo() -> None:
        document.commit(Move(ids=(1,), shift=(0.1, 0.0)))
        document.undo()

    return [
        Row(
            code="PE2",
            metric="hit test and snap, 50 entities",
            value=f"{median_ms(hit):.2f} ms",
            target="0.3 ms",
        ),
        Row(code="PE9", metric="save a level", value=f"{saving:.1f} ms", target="20 ms"),
        Row(code="PE9", metric="edit and undo", value=f"{median_ms(undo):.2f} ms", target="5 ms"),
        Row(
            code="PE11",
            metric="validate, 50 entities",
            value=f"{median_ms(lambda: validate(level)):.2f} ms",
            target="5 ms",
        ),
    ]


def _first_frame(host: OffscreenHost, seconds: float = 300) -> float:
    """Presses Play and waits for a simulated step [s]."""
    session = host.session
    start = time.perf_counter()
    session.queue("run.play_human")
    while session.playback.step_count < 1 and time.perf_counter() - start < seconds:
        host.step((), FRAME)
    return time.perf_counter() - start


def playing_rows() -> list[Row]:
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


def watching_rows() -> list[Row]:
    """An agent of 0.8 million parameters plays a level of size l."""
    session = Session(settings=Settings(), worker=Worker(), results=Results(stored=False))
    host = OffscreenHost(session, size=(1280, 800))
    file.open_path(session, "l/rover_ridge")
    with tempfile.TemporaryDirectory() as folder:
        path = str(Path(folder) / "agent")
        subprocess.run([sys.executable, "-c", _AGENT, path], check=True)
        agents.load_agent(session, path)
        until(host, lambda: session.viewer.slots["a"].summary is not None and session.worker.idle)
    session.queue("run.play_agent")
    until(host, lambda: session.playback.step_count > 0)
    walls, steps = [], []
    before = time.perf_counter() - FRAME
    for _ in range(300):
        start = time.perf_counter()
        host.step((), start - before)
        gl.finish()
        before = start
        walls.append(1000 * (time.perf_counter() - start))
        snapshot = session.playback.snapshot
        if snapshot is not None:
            steps.append(snapshot.milliseconds)
        if session.mode is Mode.ENDED:
            session.queue("run.reset")
        time.sleep(max(FRAME - (time.perf_counter() - start), 0))
    factor = session.playback.real_time_factor
    session.worker.stop()
    host.close()
    p99 = sorted(walls)[int(0.99 * len(walls))]
    return [
        Row(
            code="PE8",
            metric="agent of 0.8 M parameters plays l: frame, median / p99",
            value=f"{statistics.median(walls):.1f} / {p99:.1f} ms",
            target="16.7 ms",
        ),
        Row(
            code="PE8",
            metric="agent of 0.8 M parameters plays l: step, real time",
            value=f"{statistics.median(steps):.1f} ms, {factor:.2f}×",
            target="1.00×",
        ),
    ]


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


def until(host: OffscreenHost, done: Callable[[], bool], seconds: float = 300) -> None:
    """Run frames until something is so."""
    start = time.perf_counter()
    while not done() and time.perf_counter() - start < seconds:
        host.step((), FRAME)
        time.sleep(0.005)


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
