"""Running statistics of observations, against numbers worked out by hand."""

from typing import Any, NamedTuple

import jax.numpy as jnp
import numpy as np

from kinetix.agents.normalisation import (
    EPSILON,
    LIMIT,
    from_card,
    normalise,
    start,
    to_card,
    update,
)


class Seen(NamedTuple):
    circles: Any
    circle_mask: Any


def _seen(values, mask):
    return Seen(circles=jnp.asarray(values)[..., None], circle_mask=jnp.asarray(mask))


def test_empty_slots_do_not_count():
    seen = _seen([[1.0, 3.0, 99.0], [5.0, -99.0, 7.0]], [[True, True, False], [True, False, True]])
    statistics = update(start(seen), seen)
    np.testing.assert_allclose(statistics.mean["circles"], [4.0], rtol=1e-4)
    np.testing.assert_allclose(statistics.variance["circles"], [5.0], rtol=1e-3)
    np.testing.assert_allclose(statistics.count["circles"], 4.0 + EPSILON)


def test_two_batches_give_what_one_gives():
    flat = jnp.arange(12.0).reshape(6, 2) ** 2
    both = update(update(start(flat), flat[:2]), flat[2:])
    once = update(start(flat), flat)
    np.testing.assert_allclose(both.mean[""], once.mean[""], rtol=1e-5)
    np.testing.assert_allclose(both.variance[""], once.variance[""], rtol=1e-5)


def test_a_column_that_was_all_but_constant_gives_no_enormous_values():
    flat = jnp.ones((100, 1))
    statistics = update(start(flat), flat)
    np.testing.assert_array_equal(
        normalise(statistics, jnp.array([[50.0], [-50.0]])), [[LIMIT], [-LIMIT]]
    )


def test_the_description_keeps_the_counts_and_older_ones_are_read():
    seen = _seen([[1.0, 3.0]], [[True, False]])
    statistics = update(start(seen), seen)
    card = to_card(statistics)
    again = from_card(card)
    np.testing.assert_allclose(again.count["circles"], statistics.count["circles"])
    older = from_card(type(card)(count=7.0, mean=card.mean, variance=card.variance))
    assert float(older.count["circles"]) == 7.0
