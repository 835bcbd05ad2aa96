"""Known answers: closed forms, and fine Runge–Kutta solutions of equations in minimal coordinates.

Everything is numpy in binary64; nothing here knows an engine. What takes seconds to solve is kept
in references.json, which scripts/accuracy_references.py makes with the functions of this file.
"""

import functools
import json
import math
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
from jaxtyping import Float

from kinetix.scenes.model import GRAVITY

FINE_STEP = 1 / 60_000
"""Longest step of the Runge–Kutta solutions [s]: a thousandth of an engine's."""


def rk4(
    derivative: Callable[[np.ndarray], np.ndarray], start: list[float], dt: float, steps: int
) -> Float[np.ndarray, "k n"]:
    """Solve y' = f(y) by the classical fourth-order method.

    Args:
        derivative: f.
        start: y at time 0.
        dt: Time between the rows of the result [s]; divided into steps of at most `FINE_STEP`.
        steps: How many rows after the first.
    """
    parts = math.ceil(dt / FINE_STEP - 1e-9)
    h, y = dt / parts, np.array(start)
    rows = [y]
    for _ in range(steps):
        for _ in range(parts):
            k1 = derivative(y)
            k2 = derivative(y + h / 2 * k1)
            k3 = derivative(y + h / 2 * k2)
            k4 = derivative(y + h * k3)
            y = y + h / 6 * (k1 + 2 * k2 + 2 * k3 + k4)
        rows.append(y)
    return np.array(rows)


def rod_stiffness(length: float, width: float) -> float:
    """g·(L/2)/(I_p/m) of a rod pinned at its end [1/s²]: θ'' = −this·sin θ."""
    pivot = (length**2 + width**2) / 12 + length**2 / 4
    return GRAVITY * length / 2 / pivot


@functools.cache
def stored() -> dict[str, Any]:
    """Return the solutions that are kept.

    `pendulum`: angle after 5 s by the angle of release in degrees [rad]; `double_pendulum` and
    `offset_thrust`: places of the tip at 60 a second [m]; `car`: place and speed after 3 s.
    """
    return json.loads(Path(__file__).with_name("references.json").read_text())


def pendulum_angle(angle: float, dt: float, steps: int) -> Float[np.ndarray, " k"]:
    """Return the angle from hanging of a rod of 1×.1 m that is released at rest [rad]."""
    stiffness = rod_stiffness(1.0, 0.1)

    def derivative(y: np.ndarray) -> np.ndarray:
        return np.array((y[1], -stiffness * math.sin(y[0])))

    return rk4(derivative, [angle, 0.0], dt, steps)[:, 0]


def small_swing_period(angle: float) -> float:
    """Period of the rod of 1×.1 m [s], to second order in its amplitude [rad]."""
    return 2 * math.pi / math.sqrt(rod_stiffness(1.0, 0.1)) * (1 + angle**2 / 16)


def double_pendulum_tip(dt: float, steps: int) -> Float[np.ndarray, "k 2"]:
    """Tip of two rods of .5×.05 m that are released level and at rest [m].

    Source: Lagrange's equations with the angles from hanging as coordinates, mass divided out.
    """
    length, width = 0.5, 0.05
    half, inertia = length / 2, (length**2 + width**2) / 12
    m11, m22 = inertia + half**2 + length**2, inertia + half**2

    def derivative(y: np.ndarray) -> np.ndarray:
        first, second, speed1, speed2 = y.tolist()
        m12 = length * half * math.cos(first - second)
        turn = length * half * math.sin(first - second)
        f1 = -turn * speed2**2 - (half + length) * GRAVITY * math.sin(first)
        f2 = turn * speed1**2 - half * GRAVITY * math.sin(second)
        determinant = m11 * m22 - m12**2
        return np.array(
            (
                speed1,
                speed2,
                (m22 * f1 - m12 * f2) / determinant,
                (m11 * f2 - m12 * f1) / determinant,
            )
        )

    y = rk4(derivative, [math.pi / 2, math.pi / 2, 0.0, 0.0], dt, steps)
    return length * np.stack(
        [np.sin(y[:, 0]) + np.sin(y[:, 1]), -np.cos(y[:, 0]) - np.cos(y[:, 1])], axis=1
    )


def offset_thrust_tip(dt: float, steps: int) -> Float[np.ndarray, "k 2"]:
    """Tip (.3, 0) of a box of .6×.2 m that is pushed sideways at (−.3, 0) with .2 N [m]."""
    force, mass, inertia, arm = 0.2, 0.12, 0.12 * (0.6**2 + 0.2**2) / 12, -0.3

    def derivative(y: np.ndarray) -> np.ndarray:
        _, _, angle, vx, vy, spin = y.tolist()
        push = force / mass
        return np.array(
            (vx, vy, spin, -push * math.sin(angle), push * math.cos(angle), arm * force / inertia)
        )

    y = rk4(derivative, [0.0] * 6, dt, steps)
    return y[:, :2] + 0.3 * np.stack([np.cos(y[:, 2]), np.sin(y[:, 2])], axis=1)


def stalled_arm_angle(power: float) -> float:
    """Return the angle at which a motor of power 1 holds a rod of .8×.1 m against its weight [rad].

    The motor gives 900·power·tanh(.1·6) of angular acceleration times the rod's own inertia, as its
    axle is fixed.
    """
    length, width = 0.8, 0.1
    inertia = (length**2 + width**2) / 12
    return math.asin(900 * power * inertia * math.tanh(0.6) / (GRAVITY * length / 2))


def bounce_off(
    velocity: tuple[float, float], spin: float, radius: float, restitution: float, friction: float
) -> tuple[float, float, float]:
    """Velocity and spin of a disc after hitting a floor: one impulse within the friction cone."""
    vx, vy = velocity
    normal = (1 + restitution) * abs(vy)
    slip = vx + spin * radius
    # Per unit of mass; a solid disc has I = ½mr², so 1/m + r²/I = 3/m.
    tangent = -math.copysign(min(friction * normal, abs(slip) / 3), slip)
    return vx + tangent, vy + normal, spin + tangent * radius / (radius**2 / 2)
