"""Curves of runs against numbers worked out by hand."""

import numpy as np

from editor.agents.curves import Curve, band_of, run_names, smoothed


def test_smoothing_has_no_bias_at_the_start_and_passes_over_gaps():
    values = np.array([4.0, np.nan, 1.0, 1.0])
    np.testing.assert_array_equal(smoothed(values, 0.0), values)
    # Weights 1/2 and 1, then 1/4, 1/2 and 1.
    np.testing.assert_allclose(smoothed(values, 0.5), [4.0, np.nan, 2.0, 2.5 / 1.75])


def test_runs_of_one_name_are_told_apart_by_their_folders():
    assert run_names(["/runs/a/seed_0", "/runs/a/seed_1"]) == ["seed_0", "seed_1"]
    assert run_names(["/runs/a/seed_0", "/runs/b/seed_0"]) == ["a/seed_0", "b/seed_0"]
    assert run_names(["/runs/a", "/runs/a"]) == ["a", "a"]
    assert run_names([]) == []


def _curve(x, y):
    return Curve(x=np.array(x, float), y=np.array(y, float))


def test_a_band_is_where_all_runs_have_values():
    band = band_of([_curve([0, 10], [0, 10]), _curve([5, 25], [1, 1]), _curve([0], [7])])
    assert (band.x[0], band.x[-1]) == (5.0, 10.0)
    np.testing.assert_allclose((band.low[0], band.high[0]), (1.0, 5.0))
    np.testing.assert_allclose((band.low[-1], band.mean[-1], band.high[-1]), (1.0, 5.5, 10.0))


def test_there_is_no_band_of_one_run_or_of_runs_that_do_not_meet():
    one = _curve([0, 10], [0, 1])
    assert band_of([one]) is None
    assert band_of([one, _curve([20, 30], [0, 1])]) is None
