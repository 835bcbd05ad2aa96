"""Curves of runs against numbers worked out by hand."""

import numpy as np

from editor.agents.curves import Curve, Curves, band_of, run_names, smoothed, thinned
from editor.agents.metrics import STEPS, Metrics


def test_smoothing_has_no_bias_at_the_start_and_passes_over_gaps():
    values = np.array([4.0, np.nan, 1.0, 1.0])
    np.testing.assert_array_equal(smoothed(values, 0.0), values)
    # Weights 1/2 and 1, then 1/4, 1/2 and 1.
    np.testing.assert_allclose(smoothed(values, 0.5), [4.0, np.nan, 2.0, 2.5 / 1.75])


def test_smoothing_of_many_values_is_that_of_a_loop():
    values = np.random.default_rng(0).normal(size=1000)
    values[[3, 400, 401]] = np.nan
    for weight in (0.3, 0.99):
        total = count = 0.0
        expected = np.full(len(values), np.nan)
        for k in np.flatnonzero(np.isfinite(values)):
            total, count = total * weight + values[k], count * weight + 1.0
            expected[k] = total / count
        np.testing.assert_allclose(smoothed(values, weight), expected, rtol=1e-9, atol=1e-12)
    assert smoothed(np.array([]), 0.5).tolist() == []


def test_a_thinned_curve_keeps_ends_and_extremes():
    y = np.random.default_rng(0).normal(size=80_123)
    y[12_345], y[54_321], y[100] = 9.0, -9.0, np.nan
    thin = thinned(Curve(x=np.arange(80_123.0), y=y))
    assert len(thin.x) == len(thin.y) < 2200
    assert (thin.x[0], thin.x[-1]) == (0, 80_122)
    assert 9.0 in thin.y and -9.0 in thin.y
    np.testing.assert_array_equal(thin.y, y[thin.x.astype(int)])
    assert (np.diff(thin.x) > 0).all()
    short = _curve(range(1500), range(1500))
    assert thinned(short) is short


def test_metrics_that_some_rows_lack_keep_their_steps():
    metrics = Metrics([{STEPS: 10.0, "a": 1.0}, {STEPS: 20.0, "b": 2.0}])
    metrics.extend([{STEPS: 30.0, "a": 3.0}])
    assert (len(metrics), metrics.names, metrics.steps) == (3, (STEPS, "a", "b"), 30)
    assert [each.tolist() for each in metrics.column("a")] == [[10.0, 30.0], [1.0, 3.0]]
    assert [each.tolist() for each in metrics.column("none")] == [[], []]


def test_curves_are_worked_out_again_when_there_is_more():
    metrics, curves = Metrics([{"a": 1.0}, {"a": 2.0}]), Curves()
    first, _ = curves.of(metrics, "a", 0.0)
    assert curves.of(metrics, "a", 0.0)[0] is first
    assert curves.of(metrics, "a", 0.5)[0].y[1] < 2.0
    metrics.extend([{"a": 3.0}])
    assert curves.of(metrics, "a", 0.0)[0].y.tolist() == [1.0, 2.0, 3.0]


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
