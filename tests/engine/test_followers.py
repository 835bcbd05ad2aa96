"""Bodies that fly behind each other run into the first one where it is stopped."""

import numpy as np
import pytest

from kinetix.bench.runner import run_trials
from kinetix.engine.presets import PRESETS
from kinetix.level.builder import LevelBuilder
from kinetix.level.model import Level
from kinetix.scenes.model import Trial


def column(side: float, gap: float) -> Level:
    """Four boxes above each other, which fall five metres."""
    b = LevelBuilder("Column", arena=False)
    b.rectangle(0, -0.5, 8, 1, fixed=True)
    for k in range(4):
        b.rectangle(0, 5 + side / 2 + k * (side + gap), side, side)
    return b.build()


def train(radius: float, speed: float) -> Level:
    """Four discs that fly behind each other against a wall, and do not bounce."""
    b = LevelBuilder("Train", arena=False, gravity=(0, 0))
    b.rectangle(5, 0, 1, 4, fixed=True, restitution=0)
    for k in range(4):
        b.circle(-k * (2 * radius + 0.1), 0, radius, velocity=(speed, 0), restitution=0)
    return b.build()


@pytest.mark.slow(seconds=15)
@pytest.mark.parametrize("physics", ["fast", "balanced"])
def test_they_do_not_pass_into_or_through_each_other(physics):
    sides, radii = (0.1, 0.1, 0.4), (0.1, 0.05, 0.05)
    columns = [column(side, gap) for side, gap in zip(sides, (0.1, 0.05, 0.05), strict=True)]
    trains = [train(radius, speed) for radius, speed in zip(radii, (30, 30, 20), strict=True)]
    trials = [Trial(level=level, duration=2.0) for level in (*columns, *trains)]
    found = run_trials(trials, PRESETS[physics])
    for side, motion in zip(sides, found[:3], strict=True):
        height = motion.position[:, 1:, 1]
        assert np.diff(height, axis=1).min() > 0.9 * side
        np.testing.assert_allclose(motion.position[-1, 1:, 0], 0, atol=0.02)
    for radius, motion in zip(radii, found[3:], strict=True):
        assert np.diff(motion.position[:, 1:, 0], axis=1).max() < -2 * 0.9 * radius
