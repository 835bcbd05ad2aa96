"""A slender block that rocks: what it keeps between impacts, and what an impact takes."""

import math

import numpy as np
import pytest

from kinetix.bench.motion import Motion
from kinetix.bench.runner import run_trials
from kinetix.engine.presets import PRESETS
from kinetix.level.builder import LevelBuilder
from kinetix.scenes.model import GRAVITY, Trial

WIDTH, HEIGHT = 0.4, 1.2
ALPHA = math.atan(WIDTH / HEIGHT)


def rocking(share: float) -> Trial:
    """The block on its left corner, leaning by a share of the angle at which it would fall."""
    lean = share * ALPHA
    reach = math.hypot(WIDTH, HEIGHT) / 2
    b = LevelBuilder("Rocking block", arena=False)
    b.rectangle(0, -0.5, 10, 1, fixed=True, friction=2.0)
    centre = (reach * math.sin(ALPHA - lean), reach * math.cos(ALPHA - lean))
    b.rectangle(*centre, WIDTH, HEIGHT, angle=lean, friction=2.0)
    return Trial(level=b.build(), duration=2.0)


@pytest.fixture(scope="module", params=["fast", "balanced"])
def motions(request: pytest.FixtureRequest) -> list[Motion]:
    """Impacts at twelve moments of a step."""
    return run_trials(
        [rocking(share) for share in np.linspace(0.3, 0.8, 12)], PRESETS[request.param]
    )


def energies(motion: Motion) -> np.ndarray:
    """Energy of every frame above that of the block at rest [J]."""
    return motion.energy() - motion.masses[1, 0] * GRAVITY * HEIGHT / 2


def impact(motion: Motion) -> int:
    """The first frame after the first impact."""
    return int(np.argmax(motion.rotation[:, 1] <= 0))


def test_a_block_that_tips_over_its_corner_keeps_its_energy(motions: list[Motion]):
    for motion in motions:
        energy = energies(motion)
        assert energy[impact(motion) - 1] == pytest.approx(energy[0], rel=3e-3)


def test_an_impact_takes_the_share_that_housner_gives(motions: list[Motion]):
    wanted = 1 - (1 - 1.5 * math.sin(ALPHA) ** 2) ** 2
    for motion in motions:
        energy, at = energies(motion), impact(motion)
        assert 1 - energy[at + 2] / energy[at - 2] == pytest.approx(wanted, rel=0.06)


def test_a_disc_on_a_plank_that_swings_gets_no_energy_from_it():
    b = LevelBuilder("Swinging plank", arena=False)
    post = b.rectangle(0, 0, 0.1, 0.1, fixed=True, collision="ghost")
    tilt, along, radius = -0.3, -1.0, 0.2
    plank = b.rectangle(0, 0, 4, 0.1, angle=tilt, friction=3.0)
    b.hinge(post, plank, (0, 0))
    away = 0.05 + radius
    x = along * math.cos(tilt) - away * math.sin(tilt)
    b.circle(x, along * math.sin(tilt) + away * math.cos(tilt), radius, friction=3.0)
    (motion,) = run_trials([Trial(level=b.build(), duration=0.8)], PRESETS["balanced"])
    assert motion.energy().max() - motion.energy()[0] < 1e-4
