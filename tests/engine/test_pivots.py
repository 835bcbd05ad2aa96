"""Joints and contacts at once: arms over a floor, bobs of pendulums, a chain round a post."""

import math

import numpy as np
import pytest

from kinetix.bench.accuracy import metrics_of
from kinetix.bench.motion import Motion
from kinetix.bench.runner import run_trials
from kinetix.engine.presets import PRESETS
from kinetix.level.builder import LevelBuilder
from kinetix.level.model import Motor
from kinetix.scenes import SCENES
from kinetix.scenes.model import GRAVITY, Trial

PIVOT = np.array([2.5, 1.0])
WIDTH, HEIGHT = 0.8, 0.4
OFFSET = np.array([0.2, -0.05])
"""Of the box's centre from its pivot, before it is turned [m]."""
FIRST, LAST = 0.3, 2.7
"""Angles at which the box does not lie in the floor yet [rad]."""
SPIN = 8.0


def arm(angle: float, clearance: float, *, driven: bool, welded: bool = False) -> Trial:
    """A box on a pivot, whose corner passes above the floor with some clearance [m].

    The pivot is on a fixed disc, or on one that is welded to a fixed one.
    """
    reach = np.hypot(WIDTH / 2 - OFFSET[0], HEIGHT / 2 - OFFSET[1])
    b = LevelBuilder("Arm above a floor", arena=False)
    b.rectangle(2.5, PIVOT[1] - reach - clearance - 0.5, 10, 1, fixed=True)
    post = b.circle(*PIVOT, 0.05, fixed=True, collision="ghost")
    if welded:
        ground, post = post, b.circle(*PIVOT, 0.05, collision="ghost")
        b.weld(ground, post, tuple(PIVOT))
    cos, sin = math.cos(angle), math.sin(angle)
    x, y = PIVOT + np.array([[cos, -sin], [sin, cos]]) @ OFFSET
    spin = 0.0 if driven else SPIN
    box = b.rectangle(x, y, WIDTH, HEIGHT, angle=angle, angular_velocity=spin)
    motor = Motor(speed=-2) if driven else None
    b.hinge(box, post, tuple(PIVOT), motor=motor)
    return Trial(level=b.build(), duration=4.0, motor=1.0)


@pytest.fixture(scope="module", params=["fast", "balanced", "accurate"])
def arms(request: pytest.FixtureRequest) -> list[Motion]:
    """Arms whose corner passes the point right below the pivot, driven and thrown."""
    return run_trials(
        [
            arm(angle, clearance, driven=driven, welded=welded)
            for angle in np.linspace(FIRST, LAST, 8)
            for clearance, driven in ((0.002, True), (0.001, False))
            for welded in (False, True)
        ],
        PRESETS[request.param],
    )


def test_an_arm_that_all_but_grazes_the_floor_is_not_thrown(arms: list[Motion]):
    for motion in arms:
        box = motion.position.shape[1] - 1
        assert np.abs(motion.angular_velocity[:, box]).max() < 2.5 * SPIN
        reach = np.linalg.norm(motion.position[:, box] - PIVOT, axis=-1)
        assert np.abs(reach - np.linalg.norm(OFFSET)).max() < 2e-3


@pytest.mark.parametrize("physics", ["fast", "balanced"])
def test_a_small_bob_swings_as_long_as_a_rod(physics: str):
    radius, length = 0.1, 1.0
    b = LevelBuilder("Pendulum", arena=False)
    post = b.rectangle(0, 0, 0.1, 0.1, fixed=True)
    bob = b.circle(length, 0, radius)
    b.hinge(post, bob, (0, 0))
    (motion,) = run_trials([Trial(level=b.build(), duration=20.0)], PRESETS[physics])
    lost = motion.energy()[0] - motion.energy()
    assert np.abs(lost).max() < 0.005 * motion.masses[1, 0] * GRAVITY * length


@pytest.mark.parametrize("physics", ["balanced", "accurate"])
def test_a_loaded_chain_round_a_post_gets_no_energy_from_it(physics: str):
    found = metrics_of(SCENES["U22"], PRESETS[physics], physics)
    verdicts = {metric.verdict for metric in found} - {None}
    assert verdicts and verdicts <= {"good", "ok"}
