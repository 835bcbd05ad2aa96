"""Requirements of every solver, and of ours above the rest. One compilation per solver."""

import json
import math
import sys
from pathlib import Path

import numpy as np
import pytest

from kinetix.engine.presets import PRESETS, solver_named
from kinetix.engine.solvers import SOLVERS
from kinetix.errors import KinetixError
from tests.engine import scenes
from tests.isolated import run_with

FIRST = 5
"""Slot of the first polygon after the floor."""
DISC = 10
"""Slot of the only circle."""
REACH = 0.2
"""Angle that limits leave to a thrown arm to either side [rad]."""
SPINS = (10, 30, 50, -50)

LEVELS = {
    "stack": scenes.stack(5),
    "heavy": scenes.stack(2, density=100.0),
    "elastic": scenes.bouncing_ball(1.0),
    "half": scenes.bouncing_ball(0.5),
    "slides": scenes.slope(0.3, math.radians(30)),
    "sticks": scenes.slope(0.5, math.atan(0.45)),
    "pendulum": scenes.pendulum(math.pi / 4),
    "chain": scenes.hanging_chain(1000),
    "cantilever": scenes.cantilever(4),
    "motor": scenes.motor_wheel(3.0),
    "limit": scenes.falling_arm(math.radians(30)),
    **{f"thrown {spin}": scenes.thrown_arm(spin, REACH) for spin in SPINS},
}
INDEX = {name: number for number, name in enumerate(LEVELS)}

KNOWN_WEAKNESS = {
    ("pgs_baumgarte", "finite"): "a chain under a load of 1000 links explodes",
    ("pgs_baumgarte", "stack"): "points of a batch do not see each other: stacks creep",
    ("pgs_baumgarte", "heavy"): "ten sweeps do not carry a load of a hundred times the mass",
    ("pgs_baumgarte", "welds"): "four welded boxes droop by 12 cm",
    ("pgs_baumgarte", "elastic"): "the bias that resolves overlap stays in the velocity",
    ("pgs_baumgarte", "half"): "the bias that resolves overlap stays in the velocity",
    ("pgs_baumgarte", "chain"): "a relaxed scalar mass cannot hold a heavy load",
    ("pgs_baumgarte", "motor"): "an explicit motor cycles around its target",
    ("pgs_baumgarte", "pendulum"): "first order in time",
    ("pgs_baumgarte", "limit"): "a limit acts only while it is violated, and forgets its impulse",
    ("pgs_baumgarte", "rest"): "bodies rest a centimetre deep",
    ("pgs_baumgarte", "thrown"): "a limit acts only while it is violated",
    ("pgs_soft", "heavy"): "a soft contact sinks by more than a centimetre under such a load",
    ("pgs_soft", "welds"): "eight sweeps do not reach along four welds",
    ("pgs_soft", "elastic"): "a bounce takes the speed of the start of the step",
    ("pgs_soft", "half"): "a bounce takes the speed of the start of the step",
    ("pgs_soft", "chain"): "eight sweeps do not carry a load of a thousand links",
    ("pgs_soft", "pendulum"): "first order in time",
    ("soft_step", "heavy"): "a soft contact sinks by more than a centimetre under such a load",
    ("soft_step", "welds"): "four sweeps do not reach along four welds",
    ("soft_step", "elastic"): "a bounce takes the speed of the start of the step",
    ("soft_step", "half"): "a bounce takes the speed of the start of the step",
    ("soft_step", "chain"): "four substeps do not carry a load of a thousand links",
    ("xpbd", "elastic"): "a bounce takes the speed of the start of the substep",
    ("xpbd", "half"): "a bounce takes the speed of the start of the substep",
    ("xpbd", "pendulum"): "first order in time, and energy fades",
    ("xpbd", "chain"): "a few passes do not carry a load of a thousand links",
    ("xpbd", "welds"): "four welded boxes sag by 4 mm",
    ("jacobi", "heavy"): "a soft contact sinks by more than a centimetre under such a load",
    ("jacobi", "welds"): "what one weld knows crosses one body an iteration",
    ("jacobi", "elastic"): "a bounce takes the speed of the start of the step",
    ("jacobi", "half"): "a bounce takes the speed of the start of the step",
    ("jacobi", "chain"): "what one joint knows crosses one body an iteration",
    ("jacobi", "pendulum"): "first order in time",
}


@pytest.fixture(scope="module", params=sorted(SOLVERS))
def run(request):
    states, world = scenes.play(SOLVERS[request.param], list(LEVELS.values()), seconds=4)

    def of(name):
        number = INDEX[name]
        return lambda field: getattr(states, field)[number]

    return request.param, of, world, states


def check(run, aspect, holds):
    """A known weakness must show: a solver that got better loses its excuse."""
    weak = (run[0], aspect) in KNOWN_WEAKNESS
    assert holds != weak, KNOWN_WEAKNESS.get((run[0], aspect), "")


def test_everything_stays_finite(run):
    _, _, _, states = run
    check(run, "finite", bool(np.isfinite(states.position).all()))
    assert not states.overflow.any()


def test_a_stack_stands(run):
    _, of, _, _ = run
    last = of("stack")("position")[-1, FIRST : FIRST + 5]
    assert np.abs(last[:, 1] - (0.1 + 0.2 * np.arange(5))).max() < 0.06
    check(run, "stack", np.abs(last[:, 0]).max() < 0.01)
    depth = 0.1 - of("stack")("position")[-60:, FIRST, 1].min()
    check(run, "rest", depth < 2e-3)


def test_a_heavy_box_rests_on_a_light_one(run):
    _, of, _, _ = run
    heights = of("heavy")("position")[-60:, FIRST : FIRST + 2, 1]
    check(run, "heavy", (heights[:, 1] - heights[:, 0]).min() > 0.19)


def test_a_load_of_a_thousand_times_the_mass_rests_and_leaves_the_others_alone():
    """It takes more sweeps; the worlds beside it get no more than when they are alone."""
    five, heavy = scenes.stack(5), scenes.stack(2, density=1000.0)
    together, _ = scenes.play(PRESETS["balanced"], [five, heavy], seconds=4)
    apart, _ = scenes.play(PRESETS["balanced"], [five, five], seconds=4)
    heights = together.position[1, -60:, FIRST : FIRST + 2, 1]
    assert (heights[:, 1] - heights[:, 0]).min() > 0.198
    np.testing.assert_array_equal(together.position[0], apart.position[0])


def test_an_elastic_ball_keeps_its_energy(run):
    _, of, _, _ = run
    height = of("elastic")("position")[:, DISC, 1] - 0.2
    energy = 0.5 * of("elastic")("velocity")[:, DISC, 1] ** 2 + 9.81 * height
    check(run, "elastic", np.abs(energy / 9.81 - 1).max() < 0.01)


def test_a_bounce_has_the_height_that_restitution_says(run):
    _, of, _, _ = run
    height = of("half")("position")[:, DISC, 1] - 0.2
    speed = of("half")("velocity")[:, DISC, 1]
    # The first impact is at 0.452 s, the second 0.452 s later; 0.68 s lies in the flight between.
    apex = height[41] + speed[41] ** 2 / (2 * 9.81)
    check(run, "half", abs(apex / 0.25 - 1) < 0.01)


def test_friction_follows_coulomb(run):
    _, of, _, _ = run
    moved = of("slides")("position")[59, FIRST, 0] + 2.0
    assert moved == pytest.approx(1.1781, rel=0.05)
    assert abs(of("sticks")("position")[-1, FIRST, 0] + 2.0) < 5e-3


def test_a_pendulum_keeps_its_energy(run):
    _, of, _, _ = run
    mass, inertia = 0.1, 0.1 * 1.01 / 12
    velocity, omega = of("pendulum")("velocity")[:, FIRST], of("pendulum")("angular_velocity")
    energy = 0.5 * mass * (velocity**2).sum(axis=-1) + 0.5 * inertia * omega[:, FIRST] ** 2
    energy += mass * 9.81 * of("pendulum")("position")[:, FIRST, 1]
    check(run, "pendulum", np.ptp(energy) / (mass * 9.81 * 0.5) < 0.005)


def test_a_chain_holds_a_heavy_load(run):
    _, _, world, states = run
    check(run, "chain", scenes.joint_gap(world, states, INDEX["chain"]) < 1e-3)


def test_welds_hold(run):
    _, of, _, _ = run
    drop = np.abs(of("cantilever")("position")[:, FIRST + 3, 1] - 4.0).max()
    check(run, "welds", drop < 1e-3)


def test_an_arm_rests_on_its_limit(run):
    _, of, _, _ = run
    rest = np.degrees(of("limit")("rotation")[-60:, FIRST]) + 30
    check(run, "limit", np.abs(rest).max() < 0.3)


def test_a_thrown_arm_does_not_pass_the_limit_that_it_flies_to(run):
    """Nor where the other limit was the nearer one when the step began."""
    _, of, _, _ = run
    angles = [of(f"thrown {spin}")("rotation")[:, FIRST] for spin in SPINS]
    check(run, "thrown", max(np.abs(angle).max() for angle in angles) < REACH + 1e-3)


def test_a_motor_reaches_its_speed(run):
    _, of, _, _ = run
    rest = of("motor")("angular_velocity")[-60:, DISC] - 6.0
    check(run, "motor", np.sqrt((rest**2).mean()) < 0.01)


@pytest.mark.usefixtures("fully_optimised")
def test_the_same_bits_twice_and_alone_as_in_a_batch():
    told = run_with(Path(sys.executable), Path(__file__).with_name("repeated.py"))
    report = json.loads(told)
    assert report["same_bits"]
    assert len(report["apart"]) == 3
    assert max(report["apart"]) < 1e-5


def test_presets_are_named():
    assert {"jax2d", "fast", "balanced", "accurate", "reference"} <= set(PRESETS)
    with pytest.raises(KinetixError, match="balanced"):
        solver_named("best")
