"""Searching for actions that win: the plans themselves, and a level that needs two controls."""

import dataclasses

import numpy as np
import pytest

from kinetix.environment.replay import replay_solution
from kinetix.environment.search.beam import BATCH, STRETCH, stretches
from kinetix.environment.search.plans import HOLD, random_plans, runs_of
from kinetix.environment.search.search import search_task, solve_level, solving_env
from kinetix.level.codec import load_level
from kinetix.level.controls import channels_in_use
from kinetix.level.model import Body, Circle, Level, Solution, Thruster


def hopper(x: float) -> Level:
    """A green ball that must go up and to the right."""
    return Level(
        name="hopper",
        size="s",
        max_timesteps=90,
        bodies=(
            Body(id=1, shape=Circle(radius=0.2), position=(1.0, 0.61), role="green"),
            Body(id=2, shape=Circle(radius=0.3), position=(x, 2.5), role="blue", fixed=True),
        ),
        thrusters=(Thruster(id=3, body=1, position=(0.0, 0.0), angle=1.0, power=0.25),),
    )


def test_plans_drive_only_what_is_there():
    channels = channels_in_use(load_level("m/jump_jet"))
    assert channels == (0, 4, 5)
    plans = random_plans(np.random.default_rng(0), 50, 100, channels)
    assert plans.shape == (50, 100, 6)
    assert set(np.flatnonzero(plans.any((0, 1)))) == set(channels)
    assert [plans[..., channel].max() for channel in channels] == [2, 1, 1]


def test_plans_hold_their_controls():
    plans = random_plans(np.random.default_rng(1), 200, 120, (0,))[..., 0]
    changes = (np.diff(plans, axis=1) != 0).sum(1)
    # Nobody changes faster than the shortest hold allows, and tempos differ between plans.
    assert changes.max() <= 120 // HOLD[0]
    assert changes.min() < 5 < changes.max()


def test_runs_say_the_same_as_the_actions():
    actions = random_plans(np.random.default_rng(2), 1, 90, (0, 4))[0]
    runs = runs_of(actions)
    assert len(runs) > 3
    assert np.array_equal(np.repeat([a for _, a in runs], [n for n, _ in runs], axis=0), actions)


@pytest.mark.slow
def test_one_environment_serves_levels_of_a_size():
    levels = [hopper(2.0), hopper(3.0)]
    env = solving_env(levels, physics="jax2d")
    rounds = []
    for level in levels:
        solution = solve_level(level, physics="jax2d", env=env, report=rounds.append)
        assert solution is not None
        assert solution.frame_skip == 2
        assert replay_solution(level.replace(solution=solution)) == "won"
    # What nothing drives cannot be won; the search says so after one round.
    idle = hopper(2.0).replace(thrusters=())
    assert solve_level(idle, physics="jax2d", env=env, report=rounds.append) is None
    assert rounds[-1].won == 0
    assert rounds[-1].distance == pytest.approx(1.97, abs=0.2)

    # The second way alone: attempts that won before are refused once, so that it must go on.
    asked = []

    def wins(actions: np.ndarray) -> bool:
        asked.append(actions)
        return len(asked) > 1

    task = dataclasses.replace(search_task(levels[0], env, physics="jax2d"), wins=wins)
    found = next(each for each in stretches(task) if each.actions is not None)
    assert found.plans == BATCH
    assert found.won >= 1 and len(asked) == 2
    assert found.actions is asked[1]
    assert len(found.actions) > STRETCH
    solution = Solution(physics="jax2d", frame_skip=2, actions=runs_of(found.actions))
    assert replay_solution(levels[0].replace(solution=solution)) == "won"


@pytest.mark.slow
def test_where_every_plan_is_lost_the_distance_is_still_one():
    level = hopper(2.0)
    deadly = level.replace(
        thrusters=(), arena=level.arena.replace(floor=level.arena.floor.replace(role="red"))
    )
    told = []
    assert solve_level(deadly, physics="jax2d", seconds=0, report=told.append) is None
    assert 0 < min(one.distance for one in told) < 3
