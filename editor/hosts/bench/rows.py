"""A line of the table, and how its number is taken."""

import dataclasses
import statistics
import time
from collections.abc import Callable

from editor.base.events import FRAME
from editor.hosts.offscreen import OffscreenHost
from kinetix.level.model import Body, Circle, Joint, Level, Polygon, Thruster


@dataclasses.dataclass(frozen=True, kw_only=True)
class Row:
    """One line of the table."""

    code: str
    metric: str
    value: str
    target: str


def crowded_level() -> Level:
    """Return a level with 50 entities: 36 bodies, 10 joints, 4 thrusters."""
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
    """Return the median time of an action [ms]."""
    times = []
    for _ in range(rounds):
        start = time.perf_counter()
        action()
        times.append(time.perf_counter() - start)
    return 1000 * statistics.median(times)


def until(host: OffscreenHost, done: Callable[[], bool], seconds: float = 300) -> None:
    """Run frames until something is so."""
    start = time.perf_counter()
    while not done() and time.perf_counter() - start < seconds:
        host.step((), FRAME)
        time.sleep(0.005)
