import math
import pickle
import subprocess
import sys

import jax
import jax.numpy as jnp
import numpy as np
import pytest

import kinetix
from kinetix.environment import simulation
from kinetix.errors import KinetixError, LevelError
from kinetix.level.model import Motor, Solution


def falling(x=0.0, **fields):
    b = kinetix.LevelBuilder("Falling", arena=False)
    b.circle(x, 0, 0.2, **fields)
    return b.build()


def test_free_fall_far_away_and_fast_is_not_clipped():
    run = kinetix.simulate(falling(500.0, velocity=(300.0, 0.0), angular_velocity=80.0), 1.0)
    assert run.position.shape == (61, 1, 2)
    assert run.time[-1] == pytest.approx(1.0)
    assert run.position[-1, 0] == pytest.approx((800.0, -9.81 / 2), abs=1e-3)
    assert run.velocity[-1, 0] == pytest.approx((300.0, -9.81), abs=1e-3)
    assert run.rotation[-1, 0] == pytest.approx(80.0, abs=1e-3)
    assert (run.dropped_contacts == np.zeros(60)).all()


def test_a_level_with_walls_is_clipped_as_in_the_environment():
    b = kinetix.LevelBuilder(gravity=(0, 0))
    b.circle(2, 2, 0.2, angular_velocity=80.0)
    run = kinetix.simulate(b.build(), 0.1)
    assert run.angular_velocity[-1, 0] == 50.0


def test_runs_of_any_length_and_number_share_a_compiled_step():
    before = simulation._advance._cache_size()
    kinetix.simulate(falling(), 0.1)
    kinetix.simulate(falling(3.0, density=2.0), 4.0)
    kinetix.simulate(falling(3.0, velocity=(1.0, 2.0)), 1.0, dt=1 / 120)
    assert simulation._advance._cache_size() <= before + 1


def test_a_long_run_goes_on_where_a_chunk_ended():
    steps = simulation.CHUNK + 7
    run = kinetix.simulate(falling(), steps / 60)
    assert len(run.time) == steps + 1
    assert run.position[:, 0, 1] == pytest.approx(-9.81 / 2 * run.time**2, abs=1e-3)


def test_bodies_come_in_the_level_s_order():
    b = kinetix.LevelBuilder(arena=False)
    ball, box = b.circle(0, 0, 0.2, velocity=(1, 0)), b.rectangle(9, 0, 1, 1, fixed=True)
    run = kinetix.simulate(b.build(), 0.1)
    assert run.ids.tolist() == [ball, box]
    assert run.position[-1, run.index(box)] == pytest.approx((9, 0))
    with pytest.raises(KinetixError, match="no body 7"):
        run.index(7)


def test_a_level_without_bodies_stays_empty():
    run = kinetix.simulate(kinetix.LevelBuilder().build(), 0.1)
    assert (run.ids.shape, run.position.shape) == ((0,), (7, 0, 2))


def wheel(auto=False):
    b = kinetix.LevelBuilder(gravity=(0, 0))
    post, disc = b.rectangle(2, 2, 0.1, 0.1, fixed=True), b.circle(2, 2, 0.3)
    b.hinge(post, disc, (2, 2), motor=Motor(binding=1, auto=auto))
    b.thruster(disc, (2, 2), angle=0, power=1)
    return b.build()


def test_actions_drive_motors():
    still = kinetix.simulate(wheel(), 1.0)
    held = kinetix.simulate(wheel(), 1.0, actions=[0, 1, 0, 0, 0, 0])
    rows = np.zeros((60, 6))
    rows[30:, 1] = -1
    later = kinetix.simulate(wheel(), 1.0, actions=rows)
    assert still.rotation[-1, 1] == 0
    assert held.angular_velocity[-1, 1] == pytest.approx(6.0, abs=0.01)
    assert later.rotation[30, 1] == 0
    assert later.angular_velocity[-1, 1] == pytest.approx(-6.0, abs=0.01)
    assert kinetix.simulate(wheel(auto=True), 1.0).angular_velocity[-1, 1] == pytest.approx(
        6, abs=0.01
    )


@pytest.mark.parametrize("specialised", [True, False])
def test_a_recorded_solution_wins_as_in_the_environment(specialised):
    level = kinetix.load_level("s/first_flight")
    steps = sum(1 for _ in level.solution.unrolled()) * level.solution.frame_skip
    run = kinetix.simulate(
        level,
        steps / 60,
        physics=level.solution.physics,
        actions=level.solution,
        specialised=specialised,
    )
    green, blue = (
        next(body for body in level.bodies if body.role == role) for role in ("green", "blue")
    )
    apart = run.position[-1, run.index(green.id)] - run.position[-1, run.index(blue.id)]
    assert np.linalg.norm(apart) < np.linalg.norm(np.subtract(green.position, blue.position)) / 2


@pytest.mark.parametrize("dt", [1 / 30, 1 / 60, 1 / 120, 0.016])
def test_actions_of_a_solution_last_as_long_whatever_the_time_step(dt):
    """A thruster of 10 N pushes 1 kg for 4/15 s, rests for 2/15 s, and pushes for 2/15 s more."""
    builder = kinetix.LevelBuilder("Thrust", gravity=(0, 0), arena=False)
    body = builder.rectangle(0, 0, 1, 1)
    builder.thruster(body, (0, 0), angle=0, power=1)
    runs = ((4, (0, 0, 0, 0, 1, 0)), (2, (0, 0, 0, 0, 0, 0)), (2, (0, 0, 0, 0, 1, 0)))
    solution = Solution(physics="balanced", frame_skip=4, actions=runs)
    run = kinetix.simulate(builder.build(), 0.6, actions=solution, dt=dt)
    speed = run.velocity[:, 0, 0]
    for moment, burnt in ((0.1, 0.1), (4 / 15, 4 / 15), (0.4, 4 / 15), (0.5, 11 / 30), (0.6, 0.4)):
        assert speed[round(moment / dt)] == pytest.approx(10 * burnt, abs=10 * dt * 1.01)


def test_a_step_longer_than_an_action_of_a_solution_is_refused():
    solution = Solution(physics="balanced", frame_skip=2, actions=((3, (0,) * 6),))
    assert len(kinetix.simulate(falling(), 0.2, actions=solution, dt=1 / 30).time) == 7
    with pytest.raises(KinetixError, match=r"dt 0\.05: expected at most 0\.03333 s, for which"):
        kinetix.simulate(falling(), 0.2, actions=solution, dt=0.05)


def test_the_reference_computes_in_binary64():
    run = kinetix.simulate(falling(0.1), 1 / 60, physics="reference")
    assert run.position.dtype == np.float64
    assert kinetix.simulate(falling(), 1 / 60).position.dtype == np.float32


def test_a_run_is_frozen_short_and_can_be_kept():
    run = kinetix.simulate(falling(), 0.5)
    assert len(repr(run)) < 120
    with pytest.raises(ValueError, match="read-only"):
        run.position[0] = 1
    with pytest.raises(AttributeError):
        run.time = None
    assert (pickle.loads(pickle.dumps(run)).position == run.position).all()


@pytest.mark.parametrize("number", [np.float32, np.array, jnp.float32, jnp.array])
def test_times_may_be_arrays_of_one_number(number):
    run = kinetix.simulate(falling(), number(0.1), dt=number(1 / 30))
    assert len(run.time) == 4


WRONG = {
    "level": ((None, 1.0), {}, "level None: expected a name, a file, or a kinetix.Level"),
    "seconds": ((falling(), -1.0), {}, "seconds -1.0: expected a finite number above 0"),
    "endless": ((falling(), math.inf), {}, "seconds inf: expected a finite number"),
    "long": ((falling(), 1e9), {}, "at most 10000000 steps"),
    "dt": ((falling(), 1.0), {"dt": 0}, "dt 0: expected a finite number above 0"),
    "physics": ((falling(), 1.0), {"physics": "slow"}, "unknown physics 'slow'"),
    "word": ((falling(), 1.0), {"actions": "solution"}, r"actions 'solution': .* its \.solution"),
    "actions": ((falling(), 1.0), {"actions": [1, 2]}, r"expected finite numbers of shape \(6,\)"),
    "rows": ((falling(), 1.0), {"actions": np.zeros((59, 6))}, r"\(60, 6\), a row per step"),
    "nan": ((falling(), 1.0), {"actions": [math.nan] * 6}, "expected finite numbers"),
    "words": ((falling(), 1.0), {"actions": "random"}, "expected finite numbers"),
}


@pytest.mark.parametrize("name", WRONG)
def test_what_cannot_be_is_said_in_a_sentence(name):
    arguments, options, text = WRONG[name]
    with pytest.raises(KinetixError, match=text):
        kinetix.simulate(*arguments, **options)


FORKED = """
import multiprocessing, sys, kinetix

def height(gravity):
    level = kinetix.load_level("s/goalkeeper").replace(gravity=(0.0, gravity))
    return float(kinetix.simulate(level, 0.1).position.sum())

def alone():
    process = multiprocessing.get_context("fork").Process(target=height, args=(-5.0,))
    process.start()
    process.join(60)
    return process.exitcode

if sys.argv[1] == "after":
    height(-9.8)
elif sys.argv[1] == "jax":
    import jax.numpy
    jax.numpy.zeros(3).block_until_ready()
sys.exit(alone())
"""


@pytest.mark.slow
@pytest.mark.parametrize(("when", "works"), [("before", True), ("after", False), ("jax", False)])
def test_a_fork_of_what_has_simulated_is_refused_rather_than_waiting_for_ever(when, works):
    command = [sys.executable, "-W", "ignore", "-c", FORKED, when]
    ended = subprocess.run(command, capture_output=True, text=True, timeout=100, check=False)
    assert (ended.returncode == 0) == works, ended.stderr
    assert works or ("would hang" in ended.stderr and "spawn" in ended.stderr)


@pytest.mark.parametrize(
    "run",
    [
        lambda x: kinetix.simulate(falling(), 0.1, actions=x * jnp.ones(6)).position.sum(),
        lambda x: kinetix.simulate(falling(), x).position.sum(),
    ],
)
@pytest.mark.parametrize("transform", [jax.grad, jax.jit])
def test_inside_of_a_transformation_it_says_that_it_cannot_stand_there(run, transform):
    with pytest.raises(KinetixError, match="takes numbers, no tracers"):
        transform(run)(0.5)


@pytest.mark.parametrize(
    ("change", "text"),
    [
        ({"density": -1.0}, "density: expected 0.001 ≤ x"),
        ({"density": 0.0}, "density: expected 0.001 ≤ x"),
        ({"restitution": 5.0}, "restitution: expected 0 ≤ x ≤ 1"),
        ({"friction": -3.0}, "friction: expected 0 ≤ x"),
        ({"id": 99}, "expected x < next_id"),
    ],
)
def test_a_level_that_was_changed_is_looked_at_before_it_is_computed(change, text):
    level = falling()
    bad = level.replace(bodies=(*level.bodies[:-1], level.bodies[-1].replace(**change)))
    with pytest.raises(LevelError, match=text):
        kinetix.simulate(bad, 0.1)
    with pytest.raises(LevelError, match=text):
        kinetix.load_from_json_file(bad)


def test_a_level_that_was_made_in_python_may_be_larger_than_a_file():
    b = kinetix.LevelBuilder(arena=False, gravity=(0, -2000))
    b.rectangle(1e4, -0.5, 2e3, 1, fixed=True, friction=50)
    b.circle(1e4, 30, 3, velocity=(400, 0), density=1e5)
    assert kinetix.simulate(b.build(), 0.05).position[-1, 1, 1] < 30


def test_limits_of_time_must_be_possible_too():
    for limit in (0, -1, 1.5):
        with pytest.raises(LevelError, match="max_timesteps: expected"):
            kinetix.load_from_json_file(falling().replace(max_timesteps=limit))
