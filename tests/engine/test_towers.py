"""Towers that become heavier upwards: neighbours are alike, yet the lowest bears all."""

import random

import numpy as np
import pytest

from kinetix.bench.runner import run_trials
from kinetix.engine.presets import PRESETS
from kinetix.level.builder import LevelBuilder
from kinetix.scenes.model import Trial


def tower(sizes: list[float], densities: list[float], aside: list[float]) -> Trial:
    """Boxes one on the other, each with its middle aside by a share of its own width or 3 cm."""
    b = LevelBuilder("Tower", arena=False)
    b.rectangle(0, -0.5, 40, 1, fixed=True)
    y = 0.0
    for size, density, shift in zip(sizes, densities, aside, strict=True):
        b.rectangle(shift * min(size, 0.1), y + size / 2, size, size, density=density)
        y += size
    return Trial(level=b.build(), duration=8.0)


def towers() -> list[Trial]:
    """One large box on four small ones, densities that grow, sizes that grow; then random ones."""
    straight = [0.0] * 5
    found = [
        tower([0.1] * 4 + [0.8], [1.0] * 5, straight),
        tower([0.3] * 5, [1.0, 3.0, 9.0, 27.0, 81.0], straight),
        tower([0.2 * 1.5**k for k in range(5)], [1.0] * 5, straight),
    ]
    dice = random.Random(7)
    for _ in range(9):
        aside = [dice.uniform(-0.3, 0.3) for _ in range(5)]
        densities = [dice.uniform(1.5, 4.0) ** k for k in range(5)]
        found.append(tower([0.25] * 5, densities, aside))
    return found


@pytest.mark.parametrize("preset", ["fast", "balanced"])
def test_what_bears_much_bears_it(preset):
    moved = [
        np.abs(motion.position[-1] - motion.position[0]).max()
        for motion in run_trials(towers(), PRESETS[preset])
    ]
    assert max(moved) < 0.02
