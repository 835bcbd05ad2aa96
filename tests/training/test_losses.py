"""Advantages, losses and schedules against numbers worked out by hand."""

import dataclasses

import jax
import jax.numpy as jnp
import numpy as np
import optax
import pytest

from kinetix.agents.networks.build import build_network
from kinetix.agents.networks.config import NetworkConfig
from kinetix.agents.networks.distributions import action_head
from kinetix.agents.networks.heads import HEAD
from kinetix.agents.networks.recurrent import initial_carry
from kinetix.engine.backend import whole_batches
from kinetix.training.config import PpoConfig, ReplayConfig
from kinetix.training.ppo import update
from kinetix.training.ppo.losses import (
    generalised_advantages,
    normalised,
    policy_loss,
    value_loss,
)
from kinetix.training.ppo.rollout import Rollout, Trajectory
from kinetix.training.ppo.update import Learner, learn
from kinetix.training.schedule import adam_anew, learning_rate, make_optimiser


def _column(*values):
    return jnp.asarray(values)[:, None]


def test_advantages_of_a_running_episode():
    advantage, target = generalised_advantages(
        _column(0.0, 1.0),
        _column(0.5, 0.25),
        _column(False, False),
        jnp.array([2.0]),
        gamma=0.5,
        gae_lambda=0.5,
    )
    # error_1 = 1 + 0.5·2 − 0.25 = 1.75; error_0 = 0 + 0.5·0.25 − 0.5 = −0.375
    np.testing.assert_allclose(advantage[:, 0], [-0.375 + 0.25 * 1.75, 1.75])
    np.testing.assert_allclose(target, advantage + _column(0.5, 0.25))


def test_nothing_is_carried_over_the_end_of_an_episode():
    reward, value = _column(0.0, 1.0, 0.0), _column(0.5, 0.25, 3.0)
    advantage, _ = generalised_advantages(
        reward,
        value,
        _column(False, True, False),
        jnp.array([100.0]),
        gamma=0.5,
        gae_lambda=0.5,
    )
    np.testing.assert_allclose(advantage[:2, 0], [-0.375 + 0.25 * 0.75, 0.75])


def test_environments_do_not_mix():
    reward = jnp.array([[1.0, 0.0], [0.0, 2.0]])
    zeros = jnp.zeros((2, 2))
    advantage, _ = generalised_advantages(
        reward, zeros, zeros.astype(bool), jnp.zeros(2), gamma=1.0, gae_lambda=1.0
    )
    np.testing.assert_allclose(advantage, [[1.0, 2.0], [0.0, 2.0]])


def test_the_policy_loss_is_clipped_on_the_side_that_would_gain():
    advantage = normalised(_column(3.0, 1.0))
    np.testing.assert_allclose(advantage[:, 0], [1.0, -1.0], rtol=1e-6)
    log_ratio = jnp.log(_column(1.5, 0.5))
    loss = policy_loss(log_ratio, jnp.zeros((2, 1)), advantage, clip_eps=0.2)
    assert float(loss) == pytest.approx(-(1.2 - 0.8) / 2, abs=1e-6)
    loss = policy_loss(-log_ratio, jnp.zeros((2, 1)), advantage, clip_eps=0.2)
    assert float(loss) == pytest.approx(-(2 / 3 - 2.0) / 2, abs=1e-6)


def test_the_value_loss_takes_the_worse_of_both():
    loss = value_loss(_column(1.0), _column(0.0), _column(1.0), clip_eps=0.2)
    assert float(loss) == pytest.approx(0.5 * 0.8**2)
    loss = value_loss(_column(2.0), _column(0.0), _column(1.0), clip_eps=0.2)
    assert float(loss) == pytest.approx(0.5 * 1.0)


def test_equal_advantages_stay_finite():
    equal = normalised(_column(3.0, 3.0))
    loss = policy_loss(_column(0.0, 0.0), _column(0.0, 0.0), equal, clip_eps=0.2)
    assert float(loss) == 0.0


def test_the_learning_rate_falls_by_updates():
    config = PpoConfig(anneal_lr=True, learning_rate=1.0, num_minibatches=2, update_epochs=2)
    rate = learning_rate(config, gradient_steps=16)
    assert [float(rate(step)) for step in (0, 3, 4, 8, 15, 99)] == [1, 1, 0.75, 0.5, 0.25, 0]


def test_the_learning_rate_rises_and_falls():
    rate = learning_rate(PpoConfig(warmup_lr=True), gradient_steps=1000)
    assert float(rate(0)) == pytest.approx(1e-5, rel=1e-5)
    assert float(rate(100)) == pytest.approx(3e-4)
    assert float(rate(550)) == pytest.approx(1.5e-4, rel=1e-3)
    assert float(rate(1000)) == pytest.approx(0.0, abs=1e-9)
    rises = learning_rate(PpoConfig(warmup_lr=True, warmup_frac=1.0), gradient_steps=1000)
    assert float(rises(999)) == pytest.approx(3e-4)


def _learnt(live):
    """One gradient step on made-up play of four environments: the logits' biases, the report."""
    config = PpoConfig(num_train_envs=4, num_steps=3, num_minibatches=1, update_epochs=1)
    network = build_network(
        NetworkConfig(kind="flat_mlp", actor_depth=1, critic_depth=1, actor_width=8),
        action_head("multi_discrete"),
    )
    shape, keys = (3, 4), jax.random.split(jax.random.key(0), 5)
    observation, begins = jax.random.normal(keys[0], (*shape, 5)), jnp.zeros(shape, bool)
    carry = initial_carry(4)
    params = network.init(keys[1], carry, (observation, begins))
    _, policy, value = network.apply(params, carry, (observation, begins))
    action, live = policy.sample(keys[2]), jnp.broadcast_to(jnp.asarray(live), (*shape, 6))
    trajectory = Trajectory(
        observation=observation,
        action=action,
        live=live,
        log_prob=policy.restricted(live).log_prob(action),
        value=value,
        reward=jax.random.normal(keys[3], shape),
        begins=begins,
        done=begins,
        solved=begins,
        bad=begins,
        dropped=begins,
        episode_return=jnp.zeros(shape),
        episode_length=jnp.zeros(shape, jnp.int32),
    )
    played = Rollout(trajectory=trajectory, last_value=jnp.zeros(4), carry=carry)
    optimiser = optax.sgd(1.0)
    learner = Learner(params=params, optimiser=optimiser.init(params))
    learner, report = learn(config, network, optimiser, learner, played, keys[4])
    return learner.params["params"]["GeneralActorCriticRNN_0"]["Dense_0"]["bias"], report


def test_controls_that_a_level_lacks_are_neither_learnt_nor_counted():
    bias, report = _learnt([False, True, False, False, True, False])
    assert set(np.flatnonzero(bias)) == {3, 4, 5, 12, 13}
    assert float(report["loss/entropy"]) == pytest.approx(np.log(3) + np.log(2), abs=0.05)
    assert float(report["loss/approx_kl"]) == pytest.approx(0.0, abs=1e-6)
    bias, report = _learnt([True] * 6)
    assert np.all(bias)
    assert float(report["loss/entropy"]) == pytest.approx(4 * np.log(3) + 2 * np.log(2), abs=0.05)


def test_pieces_of_a_minibatch_teach_what_the_whole_teaches(monkeypatch):
    live = [True, True, False, False, True, False]
    whole, told = _learnt(live)
    monkeypatch.setattr(update, "_ROWS_AT_ONCE", 3)
    assert update._pieces(3, 4, 3) == 4
    pieces, told_of_pieces = _learnt(live)
    np.testing.assert_allclose(pieces, whole, rtol=1e-4, atol=1e-7)
    assert told_of_pieces.keys() == told.keys()
    for name, value in told.items():
        np.testing.assert_allclose(told_of_pieces[name], value, rtol=1e-4, atol=1e-6, err_msg=name)
    with whole_batches():
        assert update._pieces(3, 4, 3) == 1


_FLAT = NetworkConfig(kind="flat_mlp", actor_depth=1, critic_depth=1)


def _one_update(config, **more):
    """Losses of one update, and how far the policy's parameters moved."""
    head = action_head("multi_discrete")
    network = build_network(_FLAT, head)
    observation = jax.random.normal(jax.random.key(0), (8, 4, 5))
    inputs = (observation, jnp.zeros((8, 4), bool))
    params = network.init(jax.random.key(1), initial_carry(4), inputs)
    _, policy, value = network.apply(params, initial_carry(4), inputs)
    action = policy.sample(jax.random.key(2))
    live = jnp.ones((8, 4, 6), bool)
    no, zero = jnp.zeros((8, 4), bool), jnp.zeros((8, 4))
    played = Rollout(
        trajectory=Trajectory(
            observation=observation,
            action=action,
            live=live,
            log_prob=policy.log_prob(action),
            value=value,
            reward=jax.random.normal(jax.random.key(3), (8, 4)),
            begins=no,
            done=no,
            solved=no,
            bad=no,
            dropped=no,
            episode_return=zero,
            episode_length=zero.astype(jnp.int32),
        ),
        last_value=jnp.zeros(4),
        carry=initial_carry(4),
    )
    optimiser = optax.adam(1e-2)
    learner = Learner(params=params, optimiser=optimiser.init(params), **more)
    after, report = learn(config, network, optimiser, learner, played, jax.random.key(4))
    moved = jax.tree.map(lambda a, b: jnp.abs(a - b).max(), after.params, params)
    return params, after, report, moved["params"]


def test_while_the_critic_warms_up_the_policy_stays():
    config = PpoConfig(
        num_train_envs=4, num_steps=8, num_minibatches=1, critic_warmup=1, network=_FLAT
    )
    _, after, _, moved = _one_update(config, age=jnp.int32(0))
    # The critic's hidden layer and its last one.
    assert {path for path, by in _flat(moved) if by > 0} == {
        (HEAD, layer, *rest)
        for layer, *rest in (
            ("DenseAndActivation_1", "Dense_0", "kernel"),
            ("DenseAndActivation_1", "Dense_0", "bias"),
            ("Dense_1", "kernel"),
            ("Dense_1", "bias"),
        )
    }
    assert int(after.age) == 1
    _, _, _, moved = _one_update(config, age=jnp.int32(1))
    assert all(by > 0 for _, by in _flat(moved))


def _flat(moved):
    return [
        (tuple(step.key for step in path), float(by))
        for path, by in jax.tree_util.tree_leaves_with_path(moved)
    ]


def test_the_teacher_pulls_less_and_less():
    config = PpoConfig(
        num_train_envs=4,
        num_steps=8,
        num_minibatches=1,
        update_epochs=40,
        teacher_coef=20.0,
        total_timesteps=8 * 4 * 10,
    )
    params, *_ = _one_update(config)

    def strayed(age):
        _, _, report, _ = _one_update(config, teacher=params, age=jnp.int32(age))
        return float(report["loss/from_teacher"])

    assert strayed(0) < 0.5 * strayed(5)
    # Half of the ten updates are over: nothing pulls any more.
    assert strayed(5) == strayed(9)


def test_limits_of_a_fine_tuning_count_updates_however_many_rollouts_one_has():
    sizes = {"num_train_envs": 4, "num_steps": 8, "num_minibatches": 1, "network": _FLAT}
    config = ReplayConfig(**sizes, critic_warmup=1, total_timesteps=8 * 4 * 4 * 8)
    assert (config.rollouts_per_update, config.num_updates) == (4, 8)
    for age, policy_moves in ((3, False), (4, True)):
        _, _, _, moved = _one_update(config, age=jnp.int32(age))
        assert all(by > 0 for _, by in _flat(moved)) is policy_moves
    pulled = dataclasses.replace(config, critic_warmup=0, teacher_coef=1.0)

    def weight(age, config=pulled):
        learner = Learner(params=None, optimiser=None, age=jnp.int32(age))
        return float(update._teacher_weight(config, learner))

    # Four of eight updates of four rollouts; of those that learn, where not all do.
    assert [weight(age) for age in (0, 8, 16)] == [1.0, 0.5, 0.0]
    seldom = dataclasses.replace(pulled, exploratory_grad_updates=False, replay_prob=0.25)
    assert [weight(age, seldom) for age in (0, 2, 4)] == [1.0, 0.5, 0.0]


def test_divergences_are_those_of_the_textbook():
    head = action_head("multi_discrete")
    a, b = jax.random.normal(jax.random.key(0), (2, 16))
    own, other = head(a, None), head(b, None)
    p, q = jax.nn.softmax(a[:3]), jax.nn.softmax(b[:3])
    live = jnp.array([True, False, False, False, False, False])
    wanted = jnp.sum(p * jnp.log(p / q))
    np.testing.assert_allclose(own.restricted(live).divergence(other), wanted, rtol=1e-5)
    np.testing.assert_allclose(own.divergence(own), 0.0, atol=1e-6)
    head = action_head("continuous")
    own, other = head(a[:6], jnp.zeros(6)), head(b[:6], jnp.full(6, 0.5))
    each = 0.5 + 0.5 * ((1 + (a[:6] - b[:6]) ** 2) / jnp.exp(1.0) - 1)
    np.testing.assert_allclose(own.divergence(other), jnp.sum(each), rtol=1e-5)
    head = action_head("discrete")
    own, other = head(a[:11], None), head(b[:11], None)
    p, q = jax.nn.softmax(a[:11]), jax.nn.softmax(b[:11])
    np.testing.assert_allclose(own.divergence(other), jnp.sum(p * jnp.log(p / q)), rtol=1e-5)


@pytest.mark.parametrize(("anew", "largest"), [(False, 4.0), (True, 1.01)])
def test_after_a_warm_up_the_first_steps_are_as_large_as_the_rate(anew, largest):
    config = PpoConfig(anneal_lr=False, learning_rate=0.1, max_grad_norm=1e9)
    optimiser = make_optimiser(config, gradient_steps=1000)
    quiet, steady = jnp.zeros(3), jnp.ones(3)

    def step(state, gradient):
        change, state = optimiser.update(gradient, state)
        return state, jnp.abs(change).max()

    state, _ = jax.lax.scan(step, optimiser.init(quiet), jnp.tile(quiet, (500, 1)))
    state = adam_anew(state, jnp.array(anew))
    _, sizes = jax.lax.scan(step, state, jnp.tile(steady, (60, 1)))
    assert largest * 0.9 < float(sizes.max()) / config.learning_rate <= largest * 1.1
