"""The search by stretches: what counts as won and as lost, and where batch and truth differ."""

import dataclasses
import itertools
from typing import Any

import jax
import jax.numpy as jnp
import numpy as np
import pytest

from kinetix.environment.search import beam as module
from kinetix.environment.search.beam import BATCH, Task, stretches
from kinetix.environment.search.search import search_task, solving_env
from kinetix.level.model import Body, Circle, Level, Polygon, Thruster

GOAL = 40.0
BAR = ((-1.0, -0.2), (1.0, -0.2), (1.0, 0.2), (-1.0, 0.2))


@pytest.fixture
def task(monkeypatch: pytest.MonkeyPatch) -> Task:
    """A walk along a line: held forward, a step is 1 m in a batch and .9 m alone."""

    def stretch(env, states, parents, plans):
        del env
        x = np.asarray(states)[parents].copy()
        won, steps = np.zeros(BATCH, bool), np.zeros(BATCH, int)
        for k in range(plans.shape[1]):
            steps += ~won
            x += np.where(won, 0.0, plans[:, k, 0] == 1)
            won |= x >= GOAL
        return jnp.asarray(x), won, won, steps, np.abs(GOAL - x)

    monkeypatch.setattr(module, "_stretch", stretch)

    def alone(actions):
        return 0.9 * float(np.sum(actions[:, 0] == 1))

    return Task(
        env=None,  # pyright: ignore[reportArgumentType]
        start=jnp.float32(0.0),  # pyright: ignore[reportArgumentType]
        limit=256,
        channels=(0,),
        random=np.random.default_rng(0),
        wins=lambda actions: alone(actions) >= GOAL,
        after=lambda actions: jnp.float32(alone(actions)),  # pyright: ignore[reportArgumentType]
    )


def test_a_plan_that_wins_in_the_batch_only_is_followed_to_a_real_win(task: Task) -> None:
    """Every pass begins nearer, until what remains is short enough to be the same."""
    rounds = []
    for found, _ in zip(stretches(task), range(20), strict=False):
        rounds.append(found)
        if found.actions is not None:
            break
    *unproven, last = rounds
    assert len(unproven) >= 2 and all(one.unproven is not None for one in unproven)
    assert last.actions is not None and task.wins(last.actions)
    assert len(last.actions) < 256


def test_where_nothing_wins_alone_the_search_begins_again(
    task: Task, monkeypatch: pytest.MonkeyPatch
) -> None:
    """It goes on for ever, from the start again and again, and never reports a win."""
    starts: list[float] = []

    def noted(task: Task, start: Any, *rest: Any) -> module.Round:
        starts.append(float(start))
        return one_pass(task, start, *rest)

    one_pass = module._pass
    monkeypatch.setattr(module, "_pass", noted)
    never = dataclasses.replace(task, wins=lambda actions: False)
    rounds = list(itertools.islice(stretches(never), 30))
    assert len(rounds) == 30 and all(found.actions is None for found in rounds)
    assert starts.count(0.0) > 1 and max(starts) > 0


def lava() -> Level:
    """A green ball above red: up is the goal, and whoever does nothing falls and has lost."""
    return Level(
        name="lava",
        size="s",
        max_timesteps=120,
        bodies=(
            Body(id=1, shape=Circle(radius=0.2), position=(2.0, 1.3), role="green"),
            Body(id=2, shape=Circle(radius=0.3), position=(2.0, 2.5), role="blue", fixed=True),
            Body(id=3, shape=Polygon(vertices=BAR), position=(2.0, 0.5), role="red", fixed=True),
        ),
        thrusters=(Thruster(id=4, body=1, position=(0.0, 0.0), angle=np.pi / 2, power=1.0),),
    )


def test_lost_and_won_are_told_apart() -> None:
    env = solving_env([lava()], physics="fast")
    task = search_task(lava(), env, physics="fast")
    plans = np.zeros((3, 60, 6), np.int32)
    plans[0, :, 4] = 1
    plans[2, 30:, 4] = 1  # too late
    states = jax.tree.map(lambda x: jnp.broadcast_to(x, (3, *jnp.shape(x))), task.start)
    _, won, over, steps, _ = module._stretch(env, states, np.arange(3), plans)
    assert won.tolist() == [True, False, False]
    assert over.tolist() == [True, True, True]
    assert steps[1] == steps[2] < 30


def test_a_pass_goes_on_after_a_loss_and_ends_with_a_win() -> None:
    """Nobody who has lost is asked for, and nobody who has won is dropped."""
    env = solving_env([lava()], physics="fast")
    asked: list[np.ndarray] = []
    task = search_task(lava(), env, physics="fast")
    task = dataclasses.replace(task, wins=lambda actions: not asked.append(actions))
    found = next(stretches(task))
    assert found.won > 0 and found.actions is asked[0]
    assert len(asked) == 1 and task.after(found.actions) is None

    hopeless = lava().replace(thrusters=())
    found = next(stretches(search_task(hopeless, env, physics="fast")))
    assert found.won == 0 and found.actions is None and found.unproven is None
