"""Averages over episodes do not swing where episodes time out together."""

import math

import pytest

from kinetix.training.averages import EpisodeAverages


def _update(episodes, solved):
    means = {"episode_return": solved, "episode_length": 10.0, "episode_solved": solved}
    return {"episodes": float(episodes)} | means


def test_every_episode_has_the_same_weight():
    averages = EpisodeAverages(128)
    assert averages.add(_update(90, 1.0))["average/episode_solved"] == 1.0
    after = averages.add(_update(10, 0.0))
    assert after["average/episode_solved"] == pytest.approx(0.9)
    assert after["average/episode_length"] == pytest.approx(10.0)


def test_time_outs_of_all_environments_at_once_do_not_make_the_rate_swing():
    """Half of 256 episodes are won early, the others time out in every fourth update."""
    averages = EpisodeAverages(256)
    wins = [_update(42, 1.0), _update(43, 1.0), _update(43, 1.0), _update(128, 0.0)]
    told = [averages.add(row)["average/episode_solved"] for _ in range(5) for row in wins]
    settled = told[4:]
    assert min(settled) > 0.35
    assert max(settled) < 0.65
    plain = [row["episode_solved"] for row in wins]
    assert (min(plain), max(plain)) == (0.0, 1.0)


def test_only_the_last_episodes_count():
    averages = EpisodeAverages(100)
    for _ in range(5):
        averages.add(_update(100, 0.0))
    averages.add(_update(100, 1.0))
    assert averages.add(_update(100, 1.0))["average/episode_solved"] == 1.0


def test_updates_without_an_episode_change_nothing():
    averages = EpisodeAverages(8)
    assert averages.add({"episodes": 0.0, "episode_return": math.nan}) == {}
    before = averages.add(_update(10, 0.5))
    assert averages.add({"episodes": 0.0, "episode_return": math.nan}) == before
    assert averages.add({}) == before
