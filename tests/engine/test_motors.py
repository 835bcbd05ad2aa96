"""Motors at the limits of their joints, and motors in the mirror."""

import numpy as np

from kinetix.bench.runner import run_trials
from kinetix.engine.presets import PRESETS
from kinetix.level.builder import LevelBuilder
from kinetix.level.mirror import mirrored_level
from kinetix.level.model import Level, Motor
from kinetix.scenes.model import Trial


def arm(speed: float, limits: tuple[float, float]) -> Level:
    b = LevelBuilder("Arm", arena=False, gravity=(0, 0))
    post = b.rectangle(0, 0, 0.1, 0.1, fixed=True)
    rod = b.rectangle(0.5, 0, 1, 0.1)
    b.hinge(post, rod, (0, 0), motor=Motor(speed=speed), limits=limits)
    return b.build()


def test_a_motor_leaves_the_limit_that_it_stands_at_whatever_the_sign_of_its_speed():
    levels = [arm(1, (0, 1.5)), arm(-1, (-1.5, 0)), mirrored_level(arm(1, (0, 1.5)))]
    trials = [Trial(level=level, duration=1.0, motor=1.0) for level in levels]
    for physics in ("fast", "balanced"):
        angles = [motion.rotation[-1, 1] for motion in run_trials(trials, PRESETS[physics])]
        np.testing.assert_allclose(angles, [1.5, -1.5, -1.5], atol=0.02)
