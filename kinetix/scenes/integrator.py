"""Scenes whose answer is a formula of free motion: gravity, spin and thrust."""

import math

from kinetix.scenes.joints import pendulum
from kinetix.scenes.model import GRAVITY, STEP, SuiteScene, Trial
from kinetix.scenes.stage import Stage


def _free_fall() -> tuple[Trial, ...]:
    stage = Stage("Free fall")
    stage.disc(0.2, 0.0, 4.0)
    return (Trial(level=stage.level(), duration=0.8),)


def _projectile(duration: float = 1.0, dt: float = STEP, name: str = "") -> Trial:
    stage = Stage("Projectile")
    stage.disc(0.2, 0.0, 0.0, velocity=(3.0, 6.0))
    return Trial(level=stage.level(), duration=duration, dt=dt, name=name)


def _spin() -> tuple[Trial, ...]:
    stage = Stage("Spin", gravity=0.0)
    stage.box(0.6, 0.2, 0.0, 0.0, velocity=(1.0, 0.0), angular_velocity=10.0)
    return (Trial(level=stage.level(), duration=10.0),)


def _thrust() -> tuple[Trial, ...]:
    stage = Stage("Thrust", gravity=0.0)
    disc = stage.disc(0.3, 0.0, 0.0)
    stage.thruster(disc, (0.0, 0.0), 0.0, 0.5)
    return (Trial(level=stage.level(), duration=1.0, thruster=1.0),)


def _thrust_offset() -> tuple[Trial, ...]:
    stage = Stage("Thrust off the centre", gravity=0.0)
    box = stage.box(0.6, 0.2, 0.0, 0.0)
    stage.thruster(box, (-0.3, 0.0), math.pi / 2, 0.02)
    return (Trial(level=stage.level(), duration=2.0, thruster=1.0),)


def _hover() -> tuple[Trial, ...]:
    power, mass = 0.5, math.pi * 0.3**2
    stage = Stage("Hover")
    disc = stage.disc(0.3, 0.0, 2.0)
    stage.thruster(disc, (0.0, 2.0), math.pi / 2, power)
    action = mass * GRAVITY / (10 * power)
    return (Trial(level=stage.level(), duration=10.0, thruster=action),)


def _order() -> tuple[Trial, ...]:
    rates = (30, 60, 120, 240, 480)
    return tuple(_projectile(dt=1 / rate, name="I2") for rate in rates) + tuple(
        pendulum(45, dt=1 / rate, name="D2") for rate in rates
    )


INTEGRATOR = (
    SuiteScene(
        id="I1",
        name="free fall",
        group="integrator",
        core=False,
        make_trials=_free_fall,
        note="A disc falls from rest: every Euler step lags behind by ½gT·dt.",
    ),
    SuiteScene(
        id="I2",
        name="projectile",
        group="integrator",
        core=True,
        make_trials=lambda: (_projectile(),),
        note="A thrown disc follows a parabola.",
    ),
    SuiteScene(
        id="I3",
        name="spin",
        group="integrator",
        core=True,
        make_trials=_spin,
        note="A box spins and drifts without forces: momenta, angle and place stay on the line.",
    ),
    SuiteScene(
        id="I4",
        name="thrust",
        group="integrator",
        core=True,
        make_trials=_thrust,
        note="A constant push through the centre: v = FT/m, x = FT²/2m.",
    ),
    SuiteScene(
        id="I5",
        name="thrust off the centre",
        group="integrator",
        core=False,
        make_trials=_thrust_offset,
        note="A push that turns with the body, against a fine Runge–Kutta solution.",
    ),
    SuiteScene(
        id="I6",
        name="hover",
        group="integrator",
        core=True,
        make_trials=_hover,
        note="Thrust equal to weight: nothing may move.",
    ),
    SuiteScene(
        id="I7",
        name="order",
        group="integrator",
        core=False,
        make_trials=_order,
        note="Projectile and pendulum at five time steps: with which power the error falls.",
        precise=True,
    ),
)
"""In the order of their ids."""
