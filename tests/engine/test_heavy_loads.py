"""Heavy bodies on bodies hundreds and thousands of times lighter are held, and never thrown."""

import numpy as np
import pytest

from kinetix.bench.runner import run_trials
from kinetix.engine.presets import PRESETS
from kinetix.level.builder import LevelBuilder
from kinetix.scenes.model import Trial


def bridge(density: float) -> Trial:
    """A disc, laid on a taut bridge of five planks. At density 60 it weighs 256 planks."""
    b = LevelBuilder("Bridge", arena=False)
    before = b.rectangle(-1.55, 0, 0.6, 0.4, fixed=True)
    after = b.rectangle(1.55, 0, 0.6, 0.4, fixed=True)
    for k in range(5):
        x = -1.25 + 0.5 * k
        plank = b.rectangle(x + 0.25, 0.15, 0.49, 0.06)
        b.hinge(before, plank, (x, 0.15))
        before = plank
    b.hinge(before, after, (1.25, 0.15))
    b.circle(0.1, 0.4, 0.2, density=density)
    return Trial(level=b.build(), duration=3.0)


def crate(density: float) -> Trial:
    """A crate of 2 m on three feet of .1 m. At density 50 it weighs 20 000 feet."""
    b = LevelBuilder("Crate", arena=False)
    b.rectangle(0, -0.5, 28, 1, fixed=True)
    for x in (-0.6, 0.0, 0.6):
        b.rectangle(x, 0.05, 0.1, 0.1)
    b.rectangle(0, 1.1, 2, 2, density=density)
    return Trial(level=b.build(), duration=3.0)


@pytest.mark.parametrize("preset", ["fast", "balanced"])
def test_light_bodies_hold_what_is_heavy(preset):
    trials = [bridge(60), bridge(300), crate(20), crate(50)]
    for motion in run_trials(trials, PRESETS[preset]):
        energy = motion.energy()
        assert energy.max() <= energy[0] * (1 + 1e-4)
        assert np.abs(motion.velocity).max() < 5
        assert motion.penetration().max() < 0.05
        assert abs(motion.position[-1, -1, 1] - motion.position[0, -1, 1]) < 0.08
