"""The planner: it wins what random play does not, and stays within the player's interface."""

import jax
import jax.numpy as jnp
import numpy as np
import pytest

from kinetix.agents.environments import environment_for
from kinetix.agents.evaluate import NamedLevel, Settings, evaluate
from kinetix.agents.named import BUILT_IN, load_player
from kinetix.agents.planner.budget import Budget
from kinetix.agents.planner.futures import STRETCH, WAY, _Attempts, _chosen, best_first
from kinetix.agents.planner.player import Planner
from kinetix.agents.planner.policy import ELITE, GROUPS, LENGTH
from kinetix.agents.planner.proposals import CHANNELS, SHIFT, fresh_plans, varied_plans
from kinetix.environment.episode import play_episode
from kinetix.environment.reset import level_state
from kinetix.errors import CheckpointError
from kinetix.level.codec import load_level
from kinetix.level.sizes import capacity_of

_LIVE = jnp.array([True, False, True, False, False, True])
_LEVEL = "s/goalkeeper"


@pytest.fixture(scope="module")
def game():
    """The planner with a small budget, its environment, and a level that random play loses."""
    player = Planner(rounds=1, first=2)
    level = load_level(_LEVEL)
    env = environment_for(player, capacity_of(level), physics="jax2d")
    return player, env, jax.tree.map(jnp.asarray, level_state(level, env.static_env_params))


@pytest.mark.slow
def test_it_wins_a_level_that_nothing_and_chance_lose(game):
    player, env, state = game
    episode = play_episode(
        env, state, player.decide, params=player.params, carry=player.init_carry(1)
    )
    assert episode.outcome == "won"
    for name in ("noop", "random"):
        other = load_player(name)
        world = environment_for(other, env.static_env_params.capacity, physics="jax2d")
        lost = play_episode(world, state, other.policy.decide, carry=other.policy.init_carry(1))
        assert lost.outcome != "won"


@pytest.mark.slow
def test_it_tells_the_futures_that_it_tried(game):
    player, env, state = game
    observation = jax.tree.map(lambda x: x[None], env.get_obs(state))
    keys, begins = jax.random.split(jax.random.key(0), 1), jnp.ones(1, bool)
    decide = jax.jit(player.decide)
    _, mind, said = decide(player.params, player.init_carry(1), observation, keys, begins)
    outlook = jax.tree.map(lambda x: np.asarray(x[0]), said["outlook"])
    green = int(np.argmax(np.asarray(state.labels.role) == 1))
    start = np.asarray(state.physics.position)[green]
    np.testing.assert_allclose(outlook.ways[:, 0], np.broadcast_to(start, (24, 2)), atol=0.1)
    assert np.ptp(outlook.ways, axis=0).max() > 0.01
    assert bool(outlook.won[0]) == bool(mind.score[0] < 0)
    # Between two plannings it follows its plan.
    action, later, _ = decide(player.params, mind, observation, keys, ~begins)
    np.testing.assert_array_equal(action[0], mind.best[0, 0])
    np.testing.assert_array_equal(later.best[0, :-1], mind.best[0, 1:])
    assert int(later.age[0]) == 2


@pytest.mark.slow
def test_it_is_measured_like_any_other_player():
    level = NamedLevel(name="goal", source=_LEVEL)
    *_, last = evaluate(Planner(rounds=1, first=2), [level], Settings(attempts=1))
    assert [result.solve_rate for result in last.results] == [1.0]


def test_names_mean_players():
    assert [load_player(name).card.name for name in BUILT_IN] == list(BUILT_IN)
    assert "knows" in load_player("planner").card.description
    with pytest.raises(CheckpointError, match="planner"):
        load_player("planer")


def test_fresh_plans_drive_live_controls_alone_and_hold_them():
    chance = jax.random.uniform(jax.random.key(1), (200, 96, 2 * CHANNELS))
    plans = np.asarray(fresh_plans(chance, _LIVE))
    assert plans.shape == (200, 96, CHANNELS)
    assert not plans[:, :, ~np.asarray(_LIVE)].any()
    assert set(np.unique(plans[:, :, 0])) == {0, 1, 2}
    assert set(np.unique(plans[:, :, 5])) == {0, 1}
    changes = (np.diff(plans[:, :, 0], axis=1) != 0).mean(axis=1)
    # Each has its own tempo: some tap, some hold for a second or more.
    assert changes.min() < 0.05
    assert changes.max() > 0.3


def test_variations_are_the_parents_up_to_where_they_differ():
    fresh = fresh_plans(jax.random.uniform(jax.random.key(2), (300, 64, 2 * CHANNELS)), _LIVE)
    elite = fresh[:ELITE]
    chance = jax.random.uniform(jax.random.key(3), (300, 6))
    children = np.asarray(varied_plans(chance, elite, fresh, _LIVE))
    parents = np.asarray(elite)[(ELITE * np.asarray(chance[:, 0]) ** 2).astype(int)]
    first = (64 * np.asarray(chance[:, 1]) ** 2).astype(int)
    for child, parent, at in zip(children, parents, first, strict=True):
        np.testing.assert_array_equal(child[:at], parent[:at])
    assert (children != parents).any(axis=(1, 2)).mean() > 0.7
    assert not children[:, :, ~np.asarray(_LIVE)].any()
    assert SHIFT < 64


def test_the_best_come_first_and_ties_keep_their_order():
    score = jnp.array([3.0, 1.0, jnp.inf, 1.0, -2.0])
    assert best_first(score).tolist() == [4, 1, 3, 0, 2]


def test_a_group_of_whole_plans_has_no_beam():
    """Only the beam goes on from the nearest attempt: a swing must first move away."""
    shape = groups, count = (2, 8)
    number = jnp.broadcast_to(jnp.arange(count), shape)
    no = jnp.zeros(shape, bool)
    attempts = _Attempts(
        plans=jnp.broadcast_to(number[..., None, None], (*shape, 2 * STRETCH, CHANNELS)),
        moving={"number": number},
        over=no,
        won=no,
        lost=no,
        steps=number,
        distance=number.astype(jnp.float32),
        least=number.astype(jnp.float32),
        ways=jnp.zeros((*shape, WAY, 2)),
    )
    wholes = jnp.array([count, 4])
    chosen = _chosen(attempts, jnp.int32(1), jnp.zeros((groups, count, 2)), wholes)
    assert chosen.moving["number"].tolist() == [[*range(8)], [0, 1, 2, 3, 0, 0, 0, 0]]
    # Those that are taken up keep their own plan from here on.
    plans = np.asarray(chosen.plans)[1, :, :, 0]
    assert (plans[4:, :STRETCH] == 0).all()
    assert plans[:, STRETCH:].tolist() == [[k] * STRETCH for k in range(count)]


def test_its_memory_has_one_plan_a_group_and_begins_with_nothing():
    mind = Planner().init_carry(3)
    assert mind.elite.shape == (3, GROUPS, ELITE, LENGTH, 6)
    assert not np.asarray(mind.elite).any()


def test_rounds_fit_into_the_time():
    pace = Budget(milliseconds=100, first_milliseconds=800, horizon=64)
    assert (pace.rounds, pace.first) == (1, 1)
    pace.note(0.02, rounds=1, first=False)
    assert (pace.rounds, pace.first) == (5, 10)
    for _ in range(30):
        pace.note(0.04, rounds=2, first=False)
    assert (pace.rounds, pace.first) == (5, 10)
    pace.note(8.0, rounds=10, first=True)
    assert pace.rounds == 1


def test_a_slow_machine_plans_less_often_and_plays_on_time():
    """A round of 250 ms where 100 ms fit is paid back before the next one."""
    pace = Budget(milliseconds=100, first_milliseconds=800, horizon=64)
    spent, planned = 0.0, 0
    for _ in range(100):
        rounds = pace.rounds
        seconds = 0.25 * rounds + 0.002
        pace.note(seconds, rounds=rounds, first=False)
        spent, planned = spent + seconds, planned + bool(rounds)
    assert 30 <= planned <= 40
    assert spent <= 100 * 0.1 + 0.25
