"""Seams between boxes that lie side by side: what slides over them does not feel them."""

import dataclasses
import random

import numpy as np
import pytest

from kinetix.bench.runner import run_trials
from kinetix.engine.presets import PRESETS
from kinetix.scenes.built.surfaces import over_tiles


@pytest.mark.usefixtures("optimised")
def test_a_corner_that_leaves_a_tile_does_not_meet_its_end():
    dice = random.Random(1)
    speeds = [round(dice.uniform(0.5, 2), 3) for _ in range(48)]
    trials = [over_tiles("box", speed, f"{speed}", free=True) for speed in speeds]
    short = [dataclasses.replace(trial, duration=1.5) for trial in trials]
    for speed, motion in zip(speeds, run_trials(short, PRESETS["accurate"]), strict=True):
        np.testing.assert_allclose(motion.velocity[:, -1, 0], speed, rtol=1e-3)
