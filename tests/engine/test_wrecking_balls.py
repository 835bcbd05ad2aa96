"""Heavy, uneven loads that tumble on light chains and snap them tight."""

import numpy as np
import pytest

from kinetix.bench.runner import run_trials
from kinetix.engine.presets import PRESETS
from kinetix.level.builder import LevelBuilder
from kinetix.scenes.model import GRAVITY, Trial

LINK = 0.2
"""Length of a link [m]."""
LOADS = (
    (3, 175.0, 0.9, 0.32, -4.0),
    (4, 140.0, 0.87, 0.23, -5.3),
    (5, 162.0, 0.58, 0.03, -2.5),
    (6, 15.0, 0.8, 0.3, 0.0),
    (6, 100.0, 0.8, 0.3, 0.0),
    (8, 165.0, 0.91, 0.05, 7.9),
)
"""Links; the load's density, height [m], place above the chain's end [m] and spin [rad/s]."""


def wrecking_ball(
    links: int, density: float, height: float, off_centre: float, spin: float
) -> Trial:
    b = LevelBuilder("Wrecking ball", arena=False)
    last = b.rectangle(0, 0, 0.2, 0.2, fixed=True)
    for k in range(links):
        link = b.rectangle(LINK * (k + 0.5), 0, LINK, 0.05)
        b.hinge(last, link, (LINK * k, 0))
        last = link
    end = LINK * links
    load = b.rectangle(end + 0.1, off_centre, 0.2, height, density=density, angular_velocity=spin)
    b.hinge(last, load, (end, 0))
    return Trial(level=b.build(), duration=6.0)


@pytest.mark.parametrize("physics", ["fast", "balanced"])
def test_a_chain_that_is_snapped_tight_holds(physics: str):
    trials = [wrecking_ball(*load) for load in LOADS]
    motions = run_trials(trials, PRESETS[physics])
    for load, motion in zip(LOADS, motions, strict=True):
        links, _, height, off_centre, _ = load
        reach = LINK * links + np.hypot(0.1, off_centre)
        assert np.hypot(*motion.position[:, links + 1].T).max() < reach + 0.2
        gained = motion.energy().max() - motion.energy()[0]
        assert gained < 0.3 * GRAVITY * motion.masses[:, 0].sum() * (reach + height)
