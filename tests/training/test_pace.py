"""Time left: compilation out, evaluations in."""

import pytest

from kinetix.training.pace import Pace


def test_compilation_does_not_count():
    pace = Pace(updates=100, eval_freq=0)
    assert pace.seconds_left(0) is None
    pace.updated(60.0)
    assert pace.seconds_left(1) is None
    pace.updated(2.0)
    assert pace.seconds_left(2) == pytest.approx(98 * 2.0)
    for seconds in (2.0, 45.0, 2.0):  # one of them compiled a mutation
        pace.updated(seconds)
    assert pace.seconds_left(5) == pytest.approx(95 * 2.0)


def test_evaluations_count():
    pace = Pace(updates=10, eval_freq=4)
    for _ in range(4):
        pace.updated(1.0)
    pace.evaluated(30.0)
    assert pace.seconds_left(4) == pytest.approx(6 + 2 * 30)
    pace.evaluated(5.0)
    # After the eighth one is left, that of the end.
    assert pace.seconds_left(8) == pytest.approx(2 + 5)
    pace.evaluated(7.0)
    assert pace.seconds_left(8) == pytest.approx(2 + 6)
