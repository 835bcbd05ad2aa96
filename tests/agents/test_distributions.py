"""Distributions against numbers worked out by hand."""

import math

import jax
import jax.numpy as jnp
import numpy as np
import pytest

from kinetix.agents.networks.distributions import (
    Categorical,
    DiagonalNormal,
    MultiCategorical,
    action_head,
)

_HALF = math.log(2)
_THIRD = math.log(3)


def test_a_compound_choice_sums_over_its_parts():
    policy = MultiCategorical(logits=jnp.zeros((2, 16)), sizes=(3, 3, 3, 3, 2, 2))
    action = jnp.array([[0, 1, 2, 0, 1, 0], [2, 2, 2, 2, 1, 1]])
    expected = 4 * _THIRD + 2 * _HALF
    np.testing.assert_allclose(policy.log_prob(action), -expected, rtol=1e-6)
    np.testing.assert_allclose(policy.entropy(), expected, rtol=1e-6)


def test_log_prob_reads_the_right_logit():
    logits = jnp.array([1.0, 2.0, 3.0, 0.5, -0.5])
    policy = MultiCategorical(logits=logits, sizes=(3, 2))
    first, second = jax.nn.log_softmax(logits[:3]), jax.nn.log_softmax(logits[3:])
    assert float(policy.log_prob(jnp.array([2, 1]))) == pytest.approx(float(first[2] + second[1]))
    np.testing.assert_array_equal(policy.mode(), [2, 0])


def test_draws_follow_the_probabilities_and_the_temperature():
    policy = MultiCategorical(logits=jnp.tile(jnp.array([0.0, _THIRD]), (20_000, 1)), sizes=(2,))
    share = policy.sample(jax.random.key(0)).mean()
    assert float(share) == pytest.approx(0.75, abs=0.015)
    hot = policy.sample(jax.random.key(0), temperature=2.0).mean()
    assert float(hot) == pytest.approx(math.sqrt(3) / (1 + math.sqrt(3)), abs=0.015)


def test_one_choice():
    policy = Categorical(logits=jnp.array([0.0, _THIRD]))
    assert float(policy.log_prob(jnp.array(1))) == pytest.approx(math.log(0.75))
    assert float(policy.entropy()) == pytest.approx(2 * _HALF - 0.75 * _THIRD)
    assert int(policy.mode()) == 1


def test_normal():
    policy = DiagonalNormal(logits=jnp.array([1.0, -1.0]), log_std=jnp.array([0.0, _HALF]))
    expected = -0.5 * (1 + 2 * math.log(2 * math.pi)) - _HALF - 0.5 * 0.25
    assert float(policy.log_prob(jnp.array([2.0, 0.0]))) == pytest.approx(expected)
    assert float(policy.entropy()) == pytest.approx(1 + math.log(2 * math.pi) + _HALF)
    draws = jax.vmap(policy.sample)(jax.random.split(jax.random.key(0), 20_000))
    np.testing.assert_allclose(draws.std(0), [1.0, 2.0], rtol=0.03)


@pytest.mark.parametrize(
    ("kind", "dimension"), [("multi_discrete", 16), ("discrete", 11), ("continuous", 6)]
)
def test_heads_have_the_sizes_of_the_action_spaces(kind, dimension):
    assert action_head(kind).dimension == dimension


def test_an_unknown_kind_of_action_is_refused():
    with pytest.raises(ValueError, match="expected multi_discrete, discrete or continuous"):
        action_head("hybrid")


_LIVE = jnp.array([False, True, False, False, True, False])
"""Motor 1 and thruster 0."""


def test_controls_that_a_level_lacks_change_neither_log_probability_nor_entropy():
    logits = jax.random.normal(jax.random.key(0), (16,))
    policy = MultiCategorical(logits=logits, sizes=(3, 3, 3, 3, 2, 2)).restricted(_LIVE)
    motor, thruster = jax.nn.log_softmax(logits[3:6]), jax.nn.log_softmax(logits[12:14])
    action = jnp.array([2, 1, 0, 2, 1, 1])
    assert float(policy.log_prob(action)) == pytest.approx(float(motor[1] + thruster[1]))
    entropy = -jnp.sum(jnp.exp(motor) * motor) - jnp.sum(jnp.exp(thruster) * thruster)
    assert float(policy.entropy()) == pytest.approx(float(entropy))
    slope = jax.grad(lambda x: policy.replace(logits=x).log_prob(action))(logits)
    assert np.flatnonzero(slope).tolist() == [3, 4, 5, 12, 13]


def test_choices_of_controls_that_a_level_lacks_are_the_no_op():
    logits = jax.random.normal(jax.random.key(0), (11,))
    policy = Categorical(logits=logits).restricted(_LIVE)
    chance = jax.nn.softmax(logits)
    acts = [2, 3, 9]  # motor 1 backward, forward; thruster 0
    nothing = 1 - sum(float(chance[k]) for k in acts)
    for choice in range(11):
        expected = float(chance[choice]) if choice in acts else nothing
        log_prob = float(policy.log_prob(jnp.asarray(choice)))
        assert math.exp(log_prob) == pytest.approx(expected, rel=1e-5)
    parts = [float(chance[k]) for k in acts] + [nothing]
    assert float(policy.entropy()) == pytest.approx(-sum(p * math.log(p) for p in parts), rel=1e-5)


def test_entries_of_controls_that_a_level_lacks_do_not_count():
    policy = DiagonalNormal(logits=jnp.arange(6.0), log_std=jnp.zeros(6)).restricted(_LIVE)
    action = jnp.array([9.0, 2.0, 9.0, 9.0, 4.0, 9.0])
    assert float(policy.log_prob(action)) == pytest.approx(-0.5 - math.log(2 * math.pi))
    assert float(policy.entropy()) == pytest.approx(1 + math.log(2 * math.pi))


@pytest.mark.parametrize("kind", ["multi_discrete", "discrete", "continuous"])
def test_chances_of_each_control_add_up(kind):
    head = action_head(kind)
    logits = jax.random.normal(jax.random.key(0), (2, head.dimension))
    chances = head(logits, jnp.zeros(head.dimension)).chances(4)
    assert chances.shape == (2, 6, 3)
    np.testing.assert_allclose(chances.sum(axis=-1), 1.0, rtol=1e-6)
    np.testing.assert_array_equal(chances[:, 4:, 0], 0.0)  # thrusters do not pull
