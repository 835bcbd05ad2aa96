"""Scenes about hits: restitution, energy, momentum passed on."""

import math

import numpy as np

from kinetix.scenes.model import GRAVITY, PHASES, STEP, SuiteScene, Trial
from kinetix.scenes.stage import Stage


def drop_speed(height: float) -> float:
    """Return the speed after falling from rest [m/s]."""
    return math.sqrt(2 * GRAVITY * height)


def phase_shift(phase: int, speed: float, phases: int = PHASES) -> float:
    """Return the head start of a body that shifts its impact by a part of a step [m]."""
    return phase * speed * STEP / phases


def bouncing_disc(
    restitution: float, duration: float, phase: int = 0, dt: float = STEP, name: str = ""
) -> Trial:
    """B1: a disc without friction dropped from about 1 m."""
    height = 1 + phase_shift(phase, drop_speed(1.0))
    stage = Stage("Bouncing disc", friction=0.0, restitution=restitution, floor=True)
    stage.disc(0.2, 0.0, 0.2 + height)
    return Trial(
        level=stage.level(),
        duration=duration,
        phase=phase,
        dt=dt,
        name=name,
        values={"restitution": restitution, "height": height},
    )


def _elastic() -> tuple[Trial, ...]:
    return tuple(bouncing_disc(1.0, 10.0, phase) for phase in range(PHASES))


def _restitution() -> tuple[Trial, ...]:
    return tuple(
        bouncing_disc(value, 4.0, phase, name=f"e {value}")
        for value in (0.2, 0.5, 0.8)
        for phase in range(PHASES)
    )


def _settle() -> tuple[Trial, ...]:
    return tuple(bouncing_disc(0.5, 4.0, phase) for phase in range(PHASES))


def _oblique() -> tuple[Trial, ...]:
    def trial(phase: int) -> Trial:
        stage = Stage("Oblique hit", friction=0.0, restitution=1.0, gravity=0.0)
        stage.disc(0.15, -1 - phase_shift(phase, 2.0), -0.15, velocity=(2.0, 0.0))
        stage.disc(0.15, 0.0, 0.0)
        return Trial(level=stage.level(), duration=1.0, phase=phase)

    return tuple(trial(phase) for phase in range(PHASES))


def _cradle() -> tuple[Trial, ...]:
    def trial(phase: int) -> Trial:
        stage = Stage("Cradle", friction=0.0, restitution=1.0, gravity=0.0)
        stage.disc(0.2, -phase_shift(phase, 2.0), 0.0, velocity=(2.0, 0.0))
        for index in range(1, 5):
            stage.disc(0.2, 0.401 * index, 0.0)
        return Trial(level=stage.level(), duration=0.5, phase=phase)

    return tuple(trial(phase) for phase in range(PHASES))


def _gas() -> tuple[Trial, ...]:
    stage = Stage("Gas", friction=0.0, restitution=1.0, gravity=0.0)
    for x, y, length, height in (
        (2.5, -0.5, 7.0, 1.0),
        (2.5, 5.5, 7.0, 1.0),
        (-0.5, 2.5, 1.0, 5.0),
        (5.5, 2.5, 1.0, 5.0),
    ):
        stage.box(length, height, x, y, fixed=True)
    for index, (first, second) in enumerate(np.random.default_rng(0).random((8, 2)).tolist()):
        speed, angle = 3 * math.sqrt(first), 2 * math.pi * second
        stage.disc(
            0.15,
            0.625 + 1.25 * (index % 4),
            1.25 + 2.5 * (index // 4),
            velocity=(speed * math.cos(angle), speed * math.sin(angle)),
        )
    return (Trial(level=stage.level(), duration=30.0),)


def _spin_bounce() -> tuple[Trial, ...]:
    def trial(phase: int) -> Trial:
        stage = Stage("Spin bounce", friction=0.3, restitution=0.5, gravity=0.0, floor=True)
        y = 0.4 + phase_shift(phase, 4.0)
        stage.disc(0.2, 0.0, y, velocity=(1.0, -4.0), angular_velocity=-20.0)
        return Trial(level=stage.level(), duration=0.25, phase=phase)

    return tuple(trial(phase) for phase in range(PHASES))


def _box_drop() -> tuple[Trial, ...]:
    def trial(name: str, angle: float, reach: float, phase: int) -> Trial:
        stage = Stage("Box drop", friction=0.5, floor=True)
        stage.box(0.4, 0.4, 0.0, reach + 0.5 + phase_shift(phase, drop_speed(0.5)), angle)
        return Trial(level=stage.level(), duration=2.0, name=name, phase=phase)

    poses = (("flat", 0.0, 0.2), ("45°", math.pi / 4, 0.2 * math.sqrt(2)))
    return tuple(trial(*pose, phase) for pose in poses for phase in range(PHASES))


IMPACTS = (
    SuiteScene(
        id="B1",
        name="elastic",
        group="impacts",
        core=True,
        make_trials=_elastic,
        note="A disc that loses nothing: its energy must not drift over ten seconds of bounces.",
    ),
    SuiteScene(
        id="B2",
        name="restitution",
        group="impacts",
        core=True,
        make_trials=_restitution,
        note="Three kinds of bounciness: each apex is e² of the one before.",
    ),
    SuiteScene(
        id="B3",
        name="settle",
        group="impacts",
        core=False,
        make_trials=_settle,
        note="Infinitely many bounces end after a known time; then it must be quiet.",
    ),
    SuiteScene(
        id="B4",
        name="oblique",
        group="impacts",
        core=True,
        make_trials=_oblique,
        note="A disc hits another off its centre: the normal is that of the moment of touching.",
    ),
    SuiteScene(
        id="B5",
        name="cradle",
        group="impacts",
        core=True,
        make_trials=_cradle,
        note="Five discs in a row: the last one takes all the speed.",
    ),
    SuiteScene(
        id="B6",
        name="gas",
        group="impacts",
        core=True,
        make_trials=_gas,
        note="Eight elastic discs in a closed box keep their kinetic energy.",
    ),
    SuiteScene(
        id="B7",
        name="spin bounce",
        group="impacts",
        core=False,
        make_trials=_spin_bounce,
        note="Friction during a hit turns spin into speed, within its cone.",
    ),
    SuiteScene(
        id="B8",
        name="box drop",
        group="impacts",
        core=False,
        make_trials=_box_drop,
        note="A box that does not bounce must not pop up again.",
    ),
)
"""In the order of their ids."""
