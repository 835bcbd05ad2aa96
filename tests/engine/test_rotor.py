import math

import numpy as np

from kinetix.bench.accuracy import metrics_of
from kinetix.bench.runner import run_trials
from kinetix.engine.presets import PRESETS, solver_named
from kinetix.level.builder import LevelBuilder
from kinetix.scenes import SCENES
from kinetix.scenes.model import GRAVITY, Trial


def test_a_rotor_with_a_bob_stays_closed_and_keeps_its_speed():
    """At 25 rad/s and one substep the bob turns by .4 rad in each."""
    gap, spin = metrics_of(SCENES["U26"], solver_named("fast"), "fast")
    assert (gap.name, spin.name) == ("joint gap", "spin error")
    assert gap.value is not None and gap.value < 1e-3
    assert spin.value is not None and spin.value < 0.03


def dumbbell() -> Trial:
    """A rod with a heavy disc welded to its end that spins freely at 40 rad/s."""
    spin, rod_mass, disc_mass = 40.0, 0.05, 30 * math.pi * 0.2**2
    centre = 0.5 * disc_mass / (rod_mass + disc_mass)
    b = LevelBuilder("Dumbbell", arena=False, gravity=(0, 0))
    rod = b.rectangle(0, 0, 1, 0.05, velocity=(0, -spin * centre), angular_velocity=spin)
    moving = (0, spin * (0.5 - centre))
    disc = b.circle(0.5, 0, 0.2, density=30, velocity=moving, angular_velocity=spin)
    b.weld(rod, disc, (0.5, 0))
    return Trial(level=b.build(), duration=3.0)


def hammer() -> Trial:
    """A disc of 16 times the mass of the rod that it is welded to, let go from the horizontal."""
    b = LevelBuilder("Hammer", arena=False)
    post = b.rectangle(0, 0, 0.1, 0.1, fixed=True)
    rod = b.rectangle(0.5, 0, 1, 0.1)
    b.hinge(post, rod, (0, 0))
    b.weld(rod, b.circle(1, 0, 0.2, density=12.5), (1, 0))
    return Trial(level=b.build(), duration=5.0)


def test_what_is_welded_spins_and_swings_as_one_body():
    spinning, swinging = run_trials([dumbbell(), hammer()], PRESETS["balanced"])
    mass, inertia = spinning.masses.T
    velocity = spinning.velocity - (mass @ spinning.velocity / mass.sum())[:, None]
    x, y = np.moveaxis(spinning.position, -1, 0)
    about_centre = x * velocity[..., 1] - y * velocity[..., 0]
    turning = about_centre @ mass + spinning.angular_velocity @ inertia
    assert turning.min() > 0.99 * turning[0]
    height = GRAVITY * swinging.masses[:, 0] @ (0, 0.5, 1)
    assert np.ptp(swinging.energy()) < 0.003 * height
