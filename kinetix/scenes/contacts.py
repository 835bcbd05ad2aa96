"""Scenes about resting contact: stacks, arches, fast and overlapping bodies."""

import math

from kinetix.level.model import Motor
from kinetix.scenes.impacts import drop_speed, phase_shift
from kinetix.scenes.model import PHASES, STEP, SuiteScene, Trial
from kinetix.scenes.stage import Stage

BULLET_PHASES = 64
"""Number of places within a step at which a bullet is tried."""


def stack(count: int, *, dt: float = STEP, name: str = "", offset: float = 0.0) -> Trial:
    """S1: a tower of exactly touching boxes of .2 m."""
    stage = Stage("Stack", floor=True, offset=offset)
    for index in range(count):
        stage.box(0.2, 0.2, 0.0, 0.1 + 0.2 * index)
    values = {"offset": offset}
    return Trial(level=stage.level(), duration=10.0, dt=dt, name=name, values=values)


def _pyramid() -> tuple[Trial, ...]:
    stage = Stage("Pyramid", floor=True)
    for row in range(5):
        for column in range(5 - row):
            stage.box(0.2, 0.2, 0.22 * (column - (4 - row) / 2), 0.1 + 0.2 * row)
    return (Trial(level=stage.level(), duration=10.0),)


def heavy_on_light(ratio: int, *, dt: float = STEP, name: str = "") -> Trial:
    """S3: a box on a box `ratio` times lighter."""
    stage = Stage("Heavy on light", floor=True)
    stage.box(0.3, 0.3, 0.0, 0.15)
    stage.box(0.3, 0.3, 0.0, 0.45, density=float(ratio))
    return Trial(level=stage.level(), duration=10.0, dt=dt, name=name)


def _plank_bridge() -> tuple[Trial, ...]:
    stage = Stage("Plank bridge", floor=True)
    for x in (-0.9, 0.9):
        stage.box(0.2, 0.2, x, 0.1)
    stage.box(2.0, 2.0, 0.0, 1.2)
    return (Trial(level=stage.level(), duration=10.0),)


def _arch() -> tuple[Trial, ...]:
    stage = Stage("Arch", friction=0.6, floor=True)

    def corner(radius: float, index: int) -> tuple[float, float]:
        angle = index * math.pi / 17
        return radius * math.cos(angle), radius * math.sin(angle)

    for index in range(17):
        stage.polygon(
            (
                corner(0.85, index),
                corner(1.15, index),
                corner(1.15, index + 1),
                corner(0.85, index + 1),
            )
        )
    return (Trial(level=stage.level(), duration=10.0),)


def _card_house() -> tuple[Trial, ...]:
    stage = Stage("House of cards", friction=0.7, floor=True)
    lean = math.radians(25)

    def frame(x: float, y: float) -> None:
        stage.box(0.02, 0.4, x - 0.09359, y + 0.18549, -lean)
        stage.box(0.02, 0.4, x + 0.09359, y + 0.18549, lean)

    # A frame is .374 m wide at its feet, so at ±.18 m the inner cards would overlap by 13 mm.
    frame(-0.19, 0.0)
    frame(0.19, 0.0)
    stage.box(0.4, 0.02, 0.0, 0.38098)
    frame(0.0, 0.39098)
    return (Trial(level=stage.level(), duration=5.0),)


def _resting() -> tuple[Trial, ...]:
    stage = Stage("Resting", floor=True)
    stage.box(0.2, 0.2, 0.0, 0.1)
    return (Trial(level=stage.level(), duration=20.0),)


def _spinner() -> tuple[Trial, ...]:
    def trial(phase: int) -> Trial:
        stage = Stage("Spinner", floor=True)
        y = 0.783 + phase_shift(phase, drop_speed(0.5))
        stage.box(0.4, 0.4, 0.0, y, angular_velocity=40.0)
        return Trial(level=stage.level(), duration=10.0, phase=phase)

    return tuple(trial(phase) for phase in range(PHASES))


def _bullet() -> tuple[Trial, ...]:
    def trial(kind: str, speed: float, wall: float, phase: int) -> Trial:
        stage = Stage("Bullet", gravity=0.0)
        stage.box(wall, 2.0, wall / 2, 0.0, fixed=True)
        x = -2 - phase_shift(phase, speed, BULLET_PHASES)
        if kind == "disc":
            stage.disc(0.05, x, 0.0, velocity=(speed, 0.0))
        else:
            stage.box(0.1, 0.1, x, 0.0, velocity=(speed, 0.0))
        return Trial(
            level=stage.level(),
            duration=-x / speed + 0.5,
            name=f"{kind}, {speed:g} m/s, wall {wall:g} m",
            phase=phase,
            values={"wall": wall},
        )

    return tuple(
        trial(kind, speed, wall, phase)
        for kind in ("disc", "box")
        for speed in (20.0, 50.0, 100.0)
        for wall in (0.05, 0.1, 0.2)
        for phase in range(BULLET_PHASES)
    )


def _overlap() -> tuple[Trial, ...]:
    rows = Stage("Overlapping pyramid", floor=True)
    for row in range(4):
        for column in range(4 - row):
            rows.box(0.4, 0.4, 0.3 * (column - (3 - row) / 2), 0.2 + 0.3 * row)
    sunk = Stage("Sunk box", floor=True)
    sunk.box(0.1, 0.1, 0.0, 0.0)
    # Four rows of .4 m resolve to a height of at most 1.6 m; the sunk box to .1 m.
    return (
        Trial(level=rows.level(), duration=3.0, name="pyramid", values={"rest": 1.4}),
        Trial(level=sunk.level(), duration=3.0, name="sunk box", values={"rest": 0.05}),
    )


def _press() -> tuple[Trial, ...]:
    stage = Stage("Press", gravity=0.0)
    post = stage.post(0.0, 0.0)
    arm = stage.box(0.1, 0.8, 0.0, 0.4)
    stage.join("revolute", post, arm, (0.0, 0.0), motor=Motor(speed=1.0, power=3.0))
    stage.disc(0.15, 0.2, 0.6)
    stage.box(1.0, 2.0, 0.85, 0.6, fixed=True)
    return (Trial(level=stage.level(), duration=5.0, motor=-1.0),)


CONTACTS = (
    SuiteScene(
        id="S1",
        name="stack",
        group="contacts",
        core=True,
        make_trials=lambda: tuple(stack(count, name=f"N {count}") for count in (5, 10, 20)),
        note="Towers of five, ten and twenty boxes must stand.",
    ),
    SuiteScene(
        id="S2",
        name="pyramid",
        group="contacts",
        core=False,
        make_trials=_pyramid,
        note="Fifteen boxes, each row on two of the row below.",
    ),
    SuiteScene(
        id="S3",
        name="heavy on light",
        group="contacts",
        core=True,
        make_trials=lambda: tuple(
            heavy_on_light(ratio, name=f"{ratio}:1") for ratio in (10, 100, 1000)
        ),
        note="A box carries one that is up to a thousand times heavier.",
    ),
    SuiteScene(
        id="S4",
        name="plank bridge",
        group="contacts",
        core=False,
        make_trials=_plank_bridge,
        note="A large box on two small feet.",
    ),
    SuiteScene(
        id="S5",
        name="arch",
        group="contacts",
        core=False,
        make_trials=_arch,
        note="Seventeen stones stand by friction alone.",
    ),
    SuiteScene(
        id="S6",
        name="card house",
        group="contacts",
        core=True,
        make_trials=_card_house,
        note="Leaning cards hold each other and a second storey.",
    ),
    SuiteScene(
        id="S7",
        name="resting",
        group="contacts",
        core=False,
        make_trials=_resting,
        note="A box at rest must be quiet.",
    ),
    SuiteScene(
        id="S8",
        name="spinner",
        group="contacts",
        core=True,
        make_trials=_spinner,
        note="A fast spinning box lands: it may tumble, but gain no energy.",
    ),
    SuiteScene(
        id="S9",
        name="bullet",
        group="contacts",
        core=True,
        make_trials=_bullet,
        note="Fast bodies against thin walls: none may pass.",
    ),
    SuiteScene(
        id="S10",
        name="overlap",
        group="contacts",
        core=True,
        make_trials=_overlap,
        note="Bodies that start inside each other part without a bang.",
    ),
    SuiteScene(
        id="S11",
        name="press",
        group="contacts",
        core=False,
        make_trials=_press,
        note="A strong motor presses a disc against a wall.",
    ),
)
"""In the order of their ids."""
