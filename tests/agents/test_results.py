"""Means, groups and bounds against numbers worked out by hand."""

import pytest

from kinetix.agents.results import LevelResult, groups_of, rates_of_parts, summarise, wilson


def _result(name, solved, attempts=4):
    return LevelResult(
        level=name, attempts=attempts, solved=solved, mean_return=0.0, mean_length=1.0
    )


@pytest.mark.parametrize(
    ("successes", "trials", "low", "high"),
    [(0, 20, 0.0, 0.1611), (20, 20, 0.8389, 1.0), (10, 20, 0.2993, 0.7007), (1, 2, 0.0945, 0.9055)],
)
def test_wilson_bounds(successes, trials, low, high):
    assert wilson(successes, trials) == pytest.approx((low, high), abs=1e-4)


@pytest.mark.parametrize(
    ("name", "groups"),
    [
        ("s/h0_weak_thrust", ("s_all", "s_handmade")),
        ("l/mjc_hopper", ("l_all", "l_mjc")),
        ("l/pr", ("l_all", "l_pr")),
        ("m/r12_x", ("m_all", "m_random")),
        ("some/where/s/wheelie", ("s_all", "s_wheelie")),
        ("alone", ()),
    ],
)
def test_groups(name, groups):
    assert groups_of(name) == groups


def test_the_parts_of_a_set_are_told_apart():
    results = [_result("a", 4), _result("b", 0), _result("c", 2), _result("d", 4)]
    parts = {"a": "train", "b": "eval", "c": "train"}  # d is of no set
    assert rates_of_parts(results, parts) == {"train": 0.75, "eval": 0.0}
    assert rates_of_parts(results, {"a": "train", "c": "train"}) == {}
    assert rates_of_parts(results[1:2], parts) == {}


def test_every_level_counts_the_same():
    summary = summarise(
        [_result("s/h0_a", 4), _result("s/h1_b", 0, attempts=100), _result("m/x", 1)]
    )
    assert summary["mean_solve_rate"] == pytest.approx((1 + 0 + 0.25) / 3)
    assert summary["best_of_k"] == pytest.approx(2 / 3)
    assert summary["groups"] == {"m_all": 0.25, "m_x": 0.25, "s_all": 0.5, "s_handmade": 0.5}
    assert summary["levels"] == 3
