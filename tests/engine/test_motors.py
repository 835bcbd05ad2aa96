"""Motors at the limits of their joints, and motors in the mirror."""

import numpy as np

from kinetix.bench.runner import run_trials
from kinetix.engine.presets import PRESETS
from kinetix.level.builder import LevelBuilder
from kinetix.level.mirror import mirrored_level
from kinetix.level.model import Level, Motor
from kinetix.scenes.model import Trial


def arm(
    speed: float, limits: tuple[float, float], *, power: float = 1, gravity: float = 0
) -> Level:
    b = LevelBuilder("Arm", arena=False, gravity=(0, gravity))
    post = b.rectangle(0, 0, 0.1, 0.1, fixed=True)
    rod = b.rectangle(0.5, 0, 1, 0.1)
    b.hinge(post, rod, (0, 0), motor=Motor(speed=speed, power=power), limits=limits)
    return b.build()


def test_a_motor_leaves_the_limit_that_it_stands_at_whatever_the_sign_of_its_speed():
    levels = [arm(1, (0, 1.5)), arm(-1, (-1.5, 0)), mirrored_level(arm(1, (0, 1.5)))]
    trials = [Trial(level=level, duration=1.0, motor=1.0) for level in levels]
    for physics in ("fast", "balanced"):
        angles = [motion.rotation[-1, 1] for motion in run_trials(trials, PRESETS[physics])]
        np.testing.assert_allclose(angles, [1.5, -1.5, -1.5], atol=0.02)


def test_between_narrow_limits_a_motor_is_as_strong_in_both_directions():
    """A latch that lifts an arm against its weight, and the same latch in the mirror."""
    latch = arm(1, (-0.05, 0.05), power=0.2, gravity=-9.81)
    trials = [
        Trial(level=level, duration=2.0, motor=1.0) for level in (latch, mirrored_level(latch))
    ]
    for physics in ("fast", "balanced"):
        right, left = (m.rotation[-1, 1] for m in run_trials(trials, PRESETS[physics]))
        np.testing.assert_allclose(right, -left, atol=1e-5)
        assert 0.03 < right < 0.051


def test_a_limit_stops_an_arm_that_a_strong_motor_drives_into_it():
    """The arm stays there: a limit that stopped it for another motor would throw it back."""
    levels = [
        arm(speed, (-0.1, 1.6), power=power, gravity=-9.81)
        for speed in (1, 3, 5)
        for power in (1, 5, 10, 20)
    ]
    trials = [Trial(level=level, duration=1.5, motor=1.0) for level in levels]
    for physics in ("fast", "balanced"):
        for motion in run_trials(trials, PRESETS[physics]):
            spin = motion.angular_velocity[:, 1]
            fastest = np.argmax(spin)
            assert spin[fastest] > 5
            assert spin[fastest:].min() > -0.5
