"""Scenes about sliding, sticking and rolling. Slopes are gravity turned over a flat floor."""

import math

from kinetix.scenes.model import SuiteScene, Trial
from kinetix.scenes.stage import FLOOR, Stage


def _box(
    name: str,
    friction: float,
    duration: float,
    *,
    slope: float = 0.0,
    speed: float = 0.0,
    variant: str = "",
) -> Trial:
    stage = Stage(name, friction=friction, slope=slope, floor=True)
    stage.box(0.4, 0.2, 0.0, 0.1, velocity=(speed, 0.0))
    values = {"friction": friction, "slope": slope}
    return Trial(level=stage.level(), duration=duration, name=variant, values=values)


def _along(slope: float, along: float, above: float) -> tuple[float, float]:
    """Return a point by its place along and above a surface that falls towards +x."""
    c, s = math.cos(slope), math.sin(slope)
    return along * c + above * s, -along * s + above * c


def _slide() -> tuple[Trial, ...]:
    slope = math.radians(30)
    stage = Stage("Slide on a tilted floor", friction=0.3)
    stage.box(*FLOOR, *_along(slope, 0.0, -FLOOR[1] / 2), angle=-slope, fixed=True)
    stage.box(0.4, 0.2, *_along(slope, 0.0, 0.1), angle=-slope)
    tilted = Trial(level=stage.level(), duration=1.0, name="tilted floor", values={"slope": slope})
    return (_box("Slide", 0.3, 1.0, slope=slope), tilted)


def _stick_map() -> tuple[Trial, ...]:
    return tuple(
        _box("Stick or slip", friction, 2.0, slope=math.radians(degrees), variant=f"μ {friction}")
        for friction in (0.2, 0.4, 0.566, 0.8)
        for degrees in range(5, 46)
    )


def _roll() -> tuple[Trial, ...]:
    slope = math.radians(15)
    stage = Stage("Roll", friction=0.6, slope=slope, floor=True)
    stage.disc(0.25, 0.0, 0.25)
    tilted = Stage("Roll on a tilted floor", friction=0.6)
    tilted.box(*FLOOR, *_along(slope, 0.0, -FLOOR[1] / 2), angle=-slope, fixed=True)
    tilted.disc(0.25, *_along(slope, 0.0, 0.25))
    values = {"slope": slope}
    return (
        Trial(level=stage.level(), duration=1.5, values=values),
        Trial(level=tilted.level(), duration=1.5, name="tilted floor", values=values),
    )


def _slip_roll() -> tuple[Trial, ...]:
    stage = Stage("From slipping to rolling", friction=0.2, floor=True)
    stage.disc(0.25, 0.0, 0.25, velocity=(3.0, 0.0))
    return (Trial(level=stage.level(), duration=2.0),)


FRICTION = (
    SuiteScene(
        id="F1",
        name="slide",
        group="friction",
        core=True,
        make_trials=_slide,
        note="A box slides down: a = g(sin θ − μ cos θ).",
    ),
    SuiteScene(
        id="F2",
        name="stick map",
        group="friction",
        core=True,
        make_trials=_stick_map,
        note="At which angle a box begins to slip, for four coefficients.",
    ),
    SuiteScene(
        id="F3",
        name="stop",
        group="friction",
        core=False,
        make_trials=lambda: (_box("Stop", 0.4, 2.0, speed=3.0),),
        note="Braking distance v²/2μg.",
    ),
    SuiteScene(
        id="F4",
        name="creep",
        group="friction",
        core=True,
        make_trials=lambda: (_box("Creep", 0.5, 60.0, slope=math.atan(0.45)),),
        note="A box below the slipping angle must not move in a minute.",
    ),
    SuiteScene(
        id="F5",
        name="roll",
        group="friction",
        core=True,
        make_trials=_roll,
        note="A disc rolls down without slipping: its inertia shows.",
    ),
    SuiteScene(
        id="F6",
        name="slip to roll",
        group="friction",
        core=False,
        make_trials=_slip_roll,
        note="A sliding disc begins to roll at a known time with a known speed.",
    ),
)
"""In the order of their ids."""
