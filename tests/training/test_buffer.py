"""The level buffer and the scores, against cases worked out by hand."""

import dataclasses
import itertools
import math

import jax
import jax.numpy as jnp
import numpy as np
import pytest

from kinetix.errors import KinetixError
from kinetix.training.config import ReplayConfig
from kinetix.training.curricula import replay
from kinetix.training.curricula.buffer import draw, empty_buffer, insert, revise, weights
from kinetix.training.curricula.scores import best_return, episode_mean, level_scores
from kinetix.training.curricula.sfl import count_by_owner
from kinetix.training.curricula.tally import Tally, count_ends, learnability, sfl_score
from kinetix.training.ppo.rollout import Rollout, Trajectory
from tests.training.tiny import sfl_on, tiny_config

_CONFIG = ReplayConfig(staleness_coeff=0.0)
_LEVEL = {"number": jnp.zeros(2)}


def _levels(*numbers):
    return {"number": jnp.stack([jnp.full(2, float(number)) for number in numbers])}


def _filled(scores, config=_CONFIG, capacity=4):
    buffer = empty_buffer(_LEVEL, capacity)
    score = jnp.asarray(scores)
    return insert(buffer, _levels(*range(1, len(scores) + 1)), score, score, config)[0]


def _numbers(buffer):
    return buffer.levels["number"][:, 0].tolist()


def test_levels_fill_free_entries_first():
    buffer = _filled([0.5, -jnp.inf, 0.1])
    assert sorted(_numbers(buffer)) == [0, 1, 2, 3]
    assert int(buffer.filled.sum()) == 3


def test_rank_weights():
    buffer = _filled([0.1, 0.9, 0.5])
    expected = {2: 1, 3: 1 / 2, 1: 1 / 3, 0: 0}
    got = dict(zip(_numbers(buffer), weights(buffer, _CONFIG).tolist(), strict=True))
    for number, weight in expected.items():
        assert got[number] == pytest.approx(weight / (1 + 1 / 2 + 1 / 3), abs=1e-6)


def test_temperature_and_topk():
    buffer = _filled([0.1, 0.9, 0.5])
    sharp = dataclasses.replace(_CONFIG, temperature=0.5)
    got = sorted(weights(buffer, sharp).tolist())
    np.testing.assert_allclose(got, np.array([0, 1 / 9, 1 / 4, 1]) / (1 + 1 / 4 + 1 / 9), rtol=1e-5)
    top = dataclasses.replace(_CONFIG, prioritization="topk", topk_k=2)
    assert sorted(weights(buffer, top).tolist()) == [0.0, 0.0, 0.5, 0.5]


def test_a_full_buffer_only_takes_what_is_better_than_its_least():
    buffer = _filled([0.4, 0.3, 0.2, 0.1])
    worse = insert(buffer, _levels(8, 9), jnp.array([0.05, 0.1]), jnp.zeros(2), _CONFIG)[0]
    assert sorted(_numbers(worse)) == [1, 2, 3, 4]
    better = insert(buffer, _levels(8, 9), jnp.array([0.15, 0.5]), jnp.zeros(2), _CONFIG)[0]
    # 8 replaces 4 (0.1), then 9 replaces 8 (0.15), now the least.
    assert sorted(_numbers(better)) == [1, 2, 3, 9]


def test_duplicates_stay_out_when_asked():
    config = dataclasses.replace(_CONFIG, buffer_duplicate_check=True)
    buffer = _filled([0.4, 0.3, 0.2, 0.1], config)
    offered = insert(buffer, _levels(2, 9, 9), jnp.array([0.9, 0.8, 0.7]), jnp.zeros(3), config)[0]
    assert sorted(_numbers(offered)) == [1, 2, 3, 9]


def test_duplicates_stay_out_of_a_buffer_that_is_not_full():
    config = dataclasses.replace(_CONFIG, buffer_duplicate_check=True)
    buffer = _filled([0.4, 0.3], config)
    offered = insert(buffer, _levels(2, 9, 9), jnp.array([0.9, 0.8, 0.7]), jnp.zeros(3), config)[0]
    assert sorted(_numbers(offered)) == [0, 1, 2, 9]
    assert int(offered.filled.sum()) == 3


def test_no_level_is_drawn_again_before_all_others():
    buffer = _filled([0.1, 0.9, 0.5, 0.3], capacity=6)
    config = dataclasses.replace(_CONFIG, temperature=0.1)  # the best has nearly all the weight
    _, index = draw(buffer, jax.random.PRNGKey(1), 10, config, distinct=True)
    counts = np.bincount(np.asarray(index), minlength=6)
    assert sorted(counts.tolist()) == [0, 0, 2, 2, 3, 3]
    top = dataclasses.replace(_CONFIG, prioritization="topk", topk_k=1)
    _, index = draw(buffer, jax.random.PRNGKey(1), 4, top, distinct=True)
    assert len(set(index.tolist())) == 4


def test_draws_advance_the_counter_and_favour_what_is_stale():
    config = dataclasses.replace(_CONFIG, staleness_coeff=1.0)
    buffer = _filled([0.4, 0.3, 0.2, 0.1], config)
    buffer, index = draw(buffer, jax.random.PRNGKey(0), 20, config)
    # Nobody is stale at first; afterwards everybody is but the one drawn last.
    assert all(a != b for a, b in itertools.pairwise(index.tolist()))
    assert int(buffer.draws) == 20
    for level in range(4):
        last = np.flatnonzero(np.asarray(index) == level)[-1]
        assert int(buffer.last_draw[level]) == last + 1


def test_draws_follow_the_weights():
    buffer = _filled([0.1, 0.9, 0.5])
    _, index = draw(buffer, jax.random.PRNGKey(1), 4000, _CONFIG)
    share = np.bincount(np.asarray(index), minlength=4) / 4000
    np.testing.assert_allclose(share, weights(buffer, _CONFIG), atol=0.03)


def test_replays_update_scores_and_keep_the_best_return():
    buffer = _filled([0.4, 0.3])
    buffer = revise(buffer, jnp.array([0]), jnp.array([0.2]), jnp.array([-1.0]))
    assert float(buffer.score[0]) == pytest.approx(0.2)
    assert float(buffer.max_return[0]) == pytest.approx(0.4)


def test_a_level_that_was_replayed_several_times_has_the_mean_of_its_scores():
    buffer = _filled([0.4, 0.3, 0.2])
    index, score = jnp.array([0, 0, 1, 0, 2]), jnp.array([0.2, 0.6, 0.9, -jnp.inf, -jnp.inf])
    buffer = revise(buffer, index, score, jnp.zeros(5))
    np.testing.assert_allclose(buffer.score, [0.4, 0.9, -jnp.inf, -jnp.inf], rtol=1e-6)


def test_returns_are_discounted_from_the_start_of_their_episode():
    done = jnp.array([[False], [True], [False], [True]])
    # Rewards 1, 2, then 4, 8: the environment tells sums.
    played = _rollout(
        jnp.zeros((4, 1)), jnp.zeros((4, 1)), done, returns=jnp.array([[1.0], [3.0], [4.0], [12.0]])
    )
    np.testing.assert_allclose(best_return(played), [12.0])
    np.testing.assert_allclose(best_return(played, gamma=0.5), [4.0 + 0.5 * 8.0])


def test_episode_means_leave_out_what_did_not_finish():
    values = jnp.array([[1.0, 1.0], [3.0, 1.0], [5.0, 1.0], [9.0, 1.0]])
    done = jnp.array([[False, False], [True, False], [True, False], [False, False]])
    np.testing.assert_allclose(episode_mean(values, done), [(2.0 + 5.0) / 2, -jnp.inf])


def _rollout(value, reward, done, solved=None, returns=None):
    zeros = jnp.zeros_like(value)
    trajectory = Trajectory(
        observation=(),
        action=zeros,
        live=jnp.ones((*value.shape, 1), bool),
        log_prob=zeros,
        value=value,
        reward=reward,
        begins=done,
        done=done,
        solved=done if solved is None else solved,
        bad=jnp.zeros_like(done),
        dropped=jnp.zeros_like(done),
        episode_return=zeros if returns is None else returns,
        episode_length=zeros,
    )
    return Rollout(trajectory=trajectory, last_value=jnp.zeros(value.shape[1]), carry=())


def test_scores():
    value = jnp.array([[0.5], [0.25], [0.75]])
    reward = jnp.array([[0.0], [1.0], [0.0]])
    done = jnp.array([[False], [True], [False]])
    played = _rollout(value, reward, done, returns=jnp.array([[0.0], [1.0], [7.0]]))
    np.testing.assert_allclose(best_return(played), [1.0])
    most = level_scores("MaxMC", played, jnp.array([2.0]), gamma=1.0, gae_lambda=1.0)
    np.testing.assert_allclose(most, [(1.5 + 1.75) / 2])
    positive = level_scores("pvl", played, jnp.array([2.0]), gamma=1.0, gae_lambda=0.0)
    # error_0 = 0.25 − 0.5 < 0, error_1 = 1 − 0.25
    np.testing.assert_allclose(positive, [0.375])
    half = _rollout(
        value, reward, jnp.ones((3, 1), bool), solved=jnp.array([[True], [False], [True]])
    )
    learnable = level_scores("learnability", half, jnp.zeros(1), gamma=1.0, gae_lambda=1.0)
    np.testing.assert_allclose(learnable, [2 / 9], rtol=1e-6)


def test_learnability_and_its_correction():
    tally = Tally(episodes=jnp.array([0, 4, 4, 4]), solved=jnp.array([0, 0, 2, 4]))
    np.testing.assert_allclose(learnability(tally, correction=False), [0, 0, 0.25, 0])
    np.testing.assert_allclose(learnability(tally, correction=True), [0, 0, 0.2, 0])
    np.testing.assert_allclose(sfl_score(tally, correction=True), [0, 0, 0.2005, 0.001], rtol=1e-6)


def test_episodes_that_go_on_count_for_the_level_that_they_began_on():
    tally = Tally(episodes=jnp.array([5, 0, 0]), solved=jnp.array([1, 0, 0]))
    zeros = jnp.zeros((3, 2))
    done = jnp.array([[False, True], [True, False], [True, False]])
    solved = jnp.array([[False, True], [True, False], [False, False]])
    trajectory = _rollout(zeros, zeros, done, solved=solved).trajectory
    # The first environment is on level 0 and goes on with 2; the second on none, then on 1.
    owner, following = jnp.array([0, -1]), jnp.array([2, 1])
    tally, owner = count_by_owner(tally, owner, following, trajectory)
    assert tally.episodes.tolist() == [6, 0, 1]
    assert tally.solved.tolist() == [2, 0, 0]
    assert owner.tolist() == [2, 1]


def test_at_most_so_many_episodes_count():
    tally = Tally(episodes=jnp.array([0, 2]), solved=jnp.array([0, 1]))
    both = jnp.array([True, True])
    counted = count_ends(tally, both, both, most=2)
    assert counted.episodes.tolist() == [1, 2]
    assert counted.solved.tolist() == [1, 1]


@pytest.mark.slow
def test_first_episodes_are_anywhere_before_their_time_limit_also_after_an_update(tmp_path):
    trainer = sfl_on(tmp_path / "rocket.json")
    state = trainer.start()
    spread = np.asarray(state.playing.env_state.timestep)
    assert len(set(spread.tolist())) > 1
    state, _ = trainer.update(state)
    np.testing.assert_array_equal(state.playing.env_state.timestep, spread)


@pytest.mark.parametrize(("exploring", "share"), [(True, 1.0), (False, 0.25)])
def test_the_learning_rate_falls_over_the_updates_that_learn(exploring, share, monkeypatch):
    asked = []

    def make_setup(config, *, gradient_steps, teacher):
        del config, teacher
        asked.append(gradient_steps)
        raise KinetixError("enough")

    monkeypatch.setattr(replay, "make_setup", make_setup)
    config = tiny_config("plr", exploratory_grad_updates=exploring, replay_prob=0.25)
    with pytest.raises(KinetixError, match="enough"):
        replay.Replay(config)
    per_update = config.outer_rollout_steps * config.update_epochs * config.num_minibatches
    assert asked == [math.ceil(config.num_updates * share) * per_update]
