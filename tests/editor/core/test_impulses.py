"""Impulses from momentum: nothing in free fall or under thrust, weight times time at rest."""

import dataclasses

import numpy as np
import pytest

from editor.play.impulses import received_impulses
from editor.worker.snapshots import Snapshot
from kinetix.level.geometry import body_mass
from kinetix.level.model import Body, Circle, Level, Thruster

STEP = 2 / 60
LEVEL = Level(
    name="Two",
    bodies=(
        Body(id=1, shape=Circle(radius=0.5), position=(1.0, 2.0), density=2.0),
        Body(id=2, shape=Circle(radius=0.5), position=(3.0, 2.0), fixed=True),
    ),
    thrusters=(Thruster(id=3, body=1, position=(0.0, 0.0), angle=0.0, power=0.5),),
)
MASS = body_mass(LEVEL.bodies[0], LEVEL.inertia_model)[0]


def moment(step, velocity, thrust=0.0, angle=0.0):
    return Snapshot(
        step=step,
        position=np.zeros((2, 2), np.float32),
        angle=np.array([angle, 0.0], np.float32),
        velocity=np.array([velocity, (0.0, 0.0)], np.float32),
        angular_velocity=np.zeros(2, np.float32),
        motor=np.zeros(0, np.float32),
        thruster=np.array([thrust], np.float32),
    )


def received(before, after):
    return received_impulses(LEVEL, moment(0, before), after)


def test_free_fall_gives_nothing():
    first, second = received((0.0, 0.0), moment(1, (0.0, -9.81 * STEP)))
    assert first == pytest.approx((0.0, 0.0), abs=1e-5)
    assert second is None


def test_resting_takes_the_weight():
    first, _ = received((0.0, 0.0), moment(1, (0.0, 0.0)))
    assert first == pytest.approx((0.0, MASS * 9.81 * STEP), rel=1e-5)


def test_thrust_is_not_counted():
    gained = 10 * 0.5 / MASS * STEP
    after = moment(1, (0.0, gained - 9.81 * STEP), thrust=1.0, angle=np.pi / 2)
    first, _ = received((0.0, 0.0), after)
    assert first == pytest.approx((0.0, 0.0), abs=1e-5)


def test_a_bounce_is_twice_the_momentum():
    free = dataclasses.replace(moment(1, (2.0, 0.0)), frame_skip=2)
    level = LEVEL.replace(gravity=(0.0, 0.0))
    first, _ = received_impulses(level, moment(0, (-2.0, 0.0)), free)
    assert first == pytest.approx((4.0 * MASS, 0.0), rel=1e-6)
