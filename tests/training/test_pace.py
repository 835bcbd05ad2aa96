"""Time left: compilation out, evaluations in."""

import jax
import jax.numpy as jnp
import pytest

from kinetix.training.pace import Pace
from kinetix.training.work import Part, Work


def _parts(*seconds, name="update", compiled=False):
    return [Part(name=name, seconds=each, compiled=compiled) for each in seconds]


def test_compilation_does_not_count():
    pace = Pace(updates=100, eval_freq=0, per_update={"update": 1.0})
    assert pace.seconds_left(0) is None
    pace.worked(_parts(60.0, compiled=True))
    assert pace.seconds_left(1) is None
    pace.worked(_parts(2.0))
    assert pace.seconds_left(2) == pytest.approx(98 * 2.0)
    pace.worked(_parts(2.0, 45.0, 2.0))  # something else had the machine
    assert pace.seconds_left(5) == pytest.approx(95 * 2.0)


def test_parts_count_as_often_as_they_occur():
    """Scoring happens in every 16th update only, and lasts far longer than one."""
    pace = Pace(updates=33, eval_freq=0, per_update={"update": 1.0, "scoring": 4 / 16})
    pace.worked(_parts(90.0, name="scoring", compiled=True) + _parts(20.0, 20.0, name="scoring"))
    pace.worked(_parts(60.0, compiled=True))
    pace.worked(_parts(1.0))
    assert pace.seconds_left(1) == pytest.approx(32 * (1.0 + 20.0 / 4))


def test_a_kind_that_has_not_been_timed_lasts_as_long_as_the_others():
    pace = Pace(updates=10, eval_freq=0, per_update={"new levels": 0.5, "replay": 0.5})
    pace.worked(_parts(3.0, name="new levels"))
    assert pace.seconds_left(0) == pytest.approx(30.0)


def test_evaluations_count_before_one_has_been_timed_too():
    pace = Pace(updates=10, eval_freq=4, per_update={"update": 1.0}, evaluation_share=25.0)
    pace.worked(_parts(1.0))
    assert pace.seconds_left(4) == pytest.approx(6 + 2 * 25)
    pace.evaluated(5.0)
    # After the eighth one is left, that of the end.
    assert pace.seconds_left(8) == pytest.approx(2 + 5)
    pace.evaluated(7.0)
    assert pace.seconds_left(8) == pytest.approx(2 + 6)


def test_a_part_that_compiles_anew_is_known_as_one():
    """As the second update after a resume did, for arrays that were on other devices."""
    work, double = Work(), jax.jit(lambda x: 2 * x)
    for size in (3, 3, 4, 4):
        work("update", double, jnp.zeros(size))
    assert [part.compiled for part in work.taken()] == [True, False, True, False]
