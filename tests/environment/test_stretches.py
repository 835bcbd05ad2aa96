"""The search by stretches where a batch and an episode played alone disagree. No physics."""

import dataclasses

import jax.numpy as jnp
import numpy as np
import pytest

from kinetix.environment import stretches as module
from kinetix.environment.stretches import BATCH, Task, stretches

GOAL = 40.0


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


def test_where_nothing_wins_alone_the_search_begins_again(task: Task) -> None:
    """It neither hangs nor takes a batch's word for it."""
    never = dataclasses.replace(task, wins=lambda actions: False)
    rounds = [found for found, _ in zip(stretches(never), range(30), strict=False)]
    assert all(found.actions is None for found in rounds)
