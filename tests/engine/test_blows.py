"""A fast ball hits a row of touching bodies: all go on together, whenever in a step it arrives."""

import numpy as np
import pytest

from kinetix.bench.runner import run_trials
from kinetix.engine.presets import PRESETS
from kinetix.level.builder import LevelBuilder
from kinetix.scenes.model import Trial

SPEED = 25.0


def row(count: int, distance: float) -> Trial:
    """Boxes in a row, nothing bouncy, and a ball twelve times as heavy as one of them."""
    b = LevelBuilder("Row", arena=False, gravity=(0, 0))
    for k in range(count):
        b.rectangle(0.4 * k, 0, 0.4, 0.2)
    b.circle(-distance, 0, 0.2, density=8, velocity=(SPEED, 0))
    return Trial(level=b.build(), duration=0.5)


@pytest.mark.parametrize("preset", ["fast", "balanced"])
def test_a_row_goes_on_as_one(preset: str):
    for count in (3, 5, 8):
        trials = [row(count, distance) for distance in np.linspace(4.0, 4.4, 12)]
        for motion in run_trials(trials, PRESETS[preset]):
            masses, velocity = motion.masses[:, 0], motion.velocity[-1, :, 0]
            together = SPEED * masses[-1] / masses.sum()
            assert velocity == pytest.approx(together, rel=0.03), (count, preset)
            assert motion.kinetic_energy()[-1] < 1.005 * masses.sum() * together**2 / 2
