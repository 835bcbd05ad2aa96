"""Scenes about joints, limits and motors."""

import math

from kinetix.level.model import Level, Limits, Motor
from kinetix.scenes.model import STEP, SuiteScene, Trial
from kinetix.scenes.stage import Stage


def pendulum(
    degrees: float, *, dt: float = STEP, name: str = "", duration: float = 5.0, offset: float = 0.0
) -> Trial:
    """D2: a rod of 1×.1 m pinned at its end; its angle is that from hanging."""
    angle = math.radians(degrees)
    stage = Stage("Pendulum", offset=offset)
    post = stage.post(0.0, 0.0)
    rod = stage.box(0.1, 1.0, 0.5 * math.sin(angle), -0.5 * math.cos(angle), angle)
    stage.join("revolute", post, rod, (0.0, 0.0))
    return Trial(
        level=stage.level(),
        duration=duration,
        dt=dt,
        name=name,
        values={"angle": angle, "offset": offset},
    )


def _period() -> tuple[Trial, ...]:
    # Ten periods of 1.64077 s and the start of the next.
    return (pendulum(5, duration=17.0),)


def _pendulum() -> tuple[Trial, ...]:
    return (pendulum(45, name="45°"), pendulum(90, name="90°"))


def _double_pendulum() -> tuple[Trial, ...]:
    stage = Stage("Double pendulum")
    post = stage.post(0.0, 0.0)
    first = stage.box(0.05, 0.5, 0.25, 0.0, math.pi / 2)
    second = stage.box(0.05, 0.5, 0.75, 0.0, math.pi / 2)
    stage.join("revolute", post, first, (0.0, 0.0))
    stage.join("revolute", first, second, (0.5, 0.0))
    return (Trial(level=stage.level(), duration=1.5),)


def _cantilever() -> tuple[Trial, ...]:
    def trial(count: int) -> Trial:
        stage = Stage("Cantilever")
        last = stage.post(0.0, 0.0)
        for index in range(count):
            box = stage.box(0.4, 0.2, 0.4 * index + 0.2, 0.0)
            stage.join("fixed", last, box, (0.4 * index, 0.0))
            last = box
        return Trial(level=stage.level(), duration=10.0, name=f"n {count}")

    return tuple(trial(count) for count in (3, 5, 10))


def hanging_chain(ratio: int, *, dt: float = STEP, name: str = "", straight: bool = True) -> Trial:
    """D5: links of 10 g with a disc of `ratio` times their mass at the end.

    Ten links hanging straight, or five held out level and released.
    """
    stage = Stage("Heavy chain")
    last, x, y = stage.post(0.0, 0.0), 0.0, 0.0
    down = (0.0, -1.0) if straight else (1.0, 0.0)
    length, height = (0.05, 0.2) if straight else (0.2, 0.05)
    for _ in range(10 if straight else 5):
        link = stage.box(length, height, x + 0.1 * down[0], y + 0.1 * down[1])
        stage.join("revolute", last, link, (x, y))
        last, x, y = link, x + 0.2 * down[0], y + 0.2 * down[1]
    mass = ratio * 0.2 * 0.05
    load = stage.disc(0.3, x + 0.3 * down[0], y + 0.3 * down[1], density=mass / (math.pi * 0.3**2))
    stage.join("revolute", last, load, (x, y))
    return Trial(level=stage.level(), duration=5.0, dt=dt, name=name, values={"mass": mass})


def _chain() -> tuple[Trial, ...]:
    return tuple(
        hanging_chain(ratio, name=f"{word} {ratio}:1", straight=word == "hanging")
        for word in ("hanging", "swinging")
        for ratio in (10, 100, 1000)
    )


def _bridge() -> tuple[Trial, ...]:
    stage = Stage("Bridge")
    last = stage.post(-2.0, 2.0)
    for index in range(8):
        x = -2 + 0.5 * index
        plank = stage.box(0.5, 0.1, x + 0.25, 2.0)
        stage.join("revolute", last, plank, (x, 2.0))
        last = plank
    stage.join("revolute", last, stage.post(2.0, 2.0), (2.0, 2.0))
    stage.box(0.6, 0.6, 0.0, 2.35, density=6.944)
    return (Trial(level=stage.level(), duration=5.0),)


def _limit() -> tuple[Trial, ...]:
    reach = math.radians(30)

    def arm(angle: float, gravity: float, motor: Motor | None) -> Level:
        stage = Stage("Limit", gravity=gravity)
        post = stage.post(0.0, 0.0)
        rod = stage.box(0.8, 0.1, 0.4 * math.cos(angle), 0.4 * math.sin(angle), angle)
        limits = Limits(min=-reach, max=reach)
        stage.join("revolute", post, rod, (0.0, 0.0), motor=motor, limits=limits)
        return stage.level()

    values = {"limit": reach}
    return (
        Trial(level=arm(reach, 9.81, None), duration=5.0, name="falls", values=values),
        Trial(
            level=arm(0.0, 0.0, Motor(speed=3.0, power=1.0)),
            duration=5.0,
            name="driven",
            motor=1.0,
            values=values,
        ),
    )


def _motor() -> tuple[Trial, ...]:
    def wheel(power: float) -> Trial:
        stage = Stage("Wheel on an axle")
        disc = stage.disc(0.2, 0.0, 0.0)
        motor = Motor(speed=1.0, power=power)
        stage.join("revolute", stage.post(0.0, 0.0), disc, (0.0, 0.0), motor=motor)
        return Trial(level=stage.level(), duration=3.0, name=f"wheel, power {power:g}", motor=1.0)

    stage = Stage("Stalled arm")
    post, rod = stage.post(0.0, 0.0), stage.box(0.1, 0.8, 0.0, -0.4)
    stage.join("revolute", post, rod, (0.0, 0.0), motor=Motor(speed=1.0, power=0.05))
    arm = Trial(level=stage.level(), duration=20.0, name="stalled arm", motor=1.0)
    return (*(wheel(power) for power in (0.5, 1.0, 1.5, 2.0, 3.0)), arm)


def _loop() -> tuple[Trial, ...]:
    def trial(name: str, extra: int) -> Trial:
        stage = Stage("Four bars")
        base = stage.box(1.0, 0.05, 0.5, 0.0, fixed=True)
        crank = stage.box(0.05, 1.0, 0.0, 0.5)
        coupler = stage.box(1.0, 0.05, 0.5, 1.0)
        rocker = stage.box(0.05, 1.0, 1.0, 0.5)
        stage.join("revolute", base, crank, (0.0, 0.0), motor=Motor(speed=1 / 3, power=1.0))
        stage.join("revolute", crank, coupler, (0.0, 1.0))
        stage.join("revolute", base, rocker, (1.0, 0.0))
        for _ in range(1 + extra):
            stage.join("revolute", coupler, rocker, (1.0, 1.0))
        return Trial(level=stage.level(), duration=10.0, name=name, motor=1.0)

    return (trial("four joints", 0), trial("one joint twice", 1))


def _car() -> tuple[Trial, ...]:
    stage = Stage("Car", floor=True)
    chassis = stage.box(1.24, 0.284, 0.0, 0.342)
    for x in (-0.37, 0.37):
        wheel = stage.disc(0.2, x, 0.2)
        stage.join("revolute", chassis, wheel, (x, 0.2), motor=Motor(speed=1.0, power=1.0))
    return (Trial(level=stage.level(), duration=3.0, motor=1.0),)


JOINTS = (
    SuiteScene(
        id="D1",
        name="period",
        group="joints",
        core=False,
        make_trials=_period,
        note="The period of a small swing over ten of them.",
    ),
    SuiteScene(
        id="D2",
        name="pendulum",
        group="joints",
        core=True,
        make_trials=_pendulum,
        note="A rod released at 45° and 90°: angle after five seconds, energy on the way.",
    ),
    SuiteScene(
        id="D3",
        name="double pendulum",
        group="joints",
        core=True,
        make_trials=_double_pendulum,
        note="Two rods released level, against a fine Runge–Kutta solution.",
    ),
    SuiteScene(
        id="D4",
        name="cantilever",
        group="joints",
        core=True,
        make_trials=_cantilever,
        note="Boxes welded end to end must stay straight.",
    ),
    SuiteScene(
        id="D5",
        name="chain",
        group="joints",
        core=True,
        make_trials=_chain,
        note="A light chain holds a load of up to a thousand links.",
    ),
    SuiteScene(
        id="D6",
        name="bridge",
        group="joints",
        core=False,
        make_trials=_bridge,
        note="A taut row of planks under a heavy box: there is no slack, so it cannot sag.",
    ),
    SuiteScene(
        id="D7",
        name="limit",
        group="joints",
        core=True,
        make_trials=_limit,
        note="An arm stops at its limit, falling or driven, and stays there.",
    ),
    SuiteScene(
        id="D8",
        name="motor",
        group="joints",
        core=True,
        make_trials=_motor,
        note="Wheels reach their speed at any power; an arm stalls where torque meets weight.",
    ),
    SuiteScene(
        id="D9",
        name="loop",
        group="joints",
        core=False,
        make_trials=_loop,
        note="A closed loop with one joint too many, through its change points.",
    ),
    SuiteScene(
        id="D10",
        name="car",
        group="joints",
        core=True,
        make_trials=_car,
        note="A motor car starts from rest and cruises at 1.2 m/s.",
    ),
)
"""In the order of their ids."""
