"""Properties that hold for networks with any weights."""

import dataclasses

import jax
import jax.numpy as jnp
import numpy as np
import pytest

from kinetix.agents.networks.build import build_network
from kinetix.agents.networks.config import (
    NETWORK_PRESETS,
    OBSERVATIONS_OF_KIND,
    NetworkConfig,
)
from kinetix.agents.networks.critics import for_the_critic_alone
from kinetix.agents.networks.distributions import action_head
from kinetix.agents.networks.recurrent import initial_carry
from tests.agents.observations import Entities, Picture, random_entities, with_axes

_SMALL = NetworkConfig(
    actor_depth=1,
    critic_depth=1,
    actor_width=8,
    critic_width=8,
    transformer_size=8,
    transformer_encoder_size=16,
)
_DONES = jnp.zeros((1, 1), bool)


@pytest.fixture(scope="module")
def transformer():
    """Apply function of a small transformer with random weights, on one observation."""
    network = build_network(_SMALL, action_head("multi_discrete"))
    inputs = (with_axes(random_entities(0)), _DONES)
    params = network.init(jax.random.key(0), initial_carry(1), inputs)

    @jax.jit
    def apply(observation):
        _, policy, value = network.apply(params, initial_carry(1), (with_axes(observation), _DONES))
        # The last layers start small; scaled up, so that differences show.
        return jnp.concatenate([100 * policy.logits[0, 0], value[0]])

    return apply


def _permuted(observation: Entities, seed: int) -> Entities:
    random = np.random.default_rng(seed)
    polygons, circles = len(observation.polygon_mask), len(observation.circle_mask)
    p, c = random.permutation(polygons), random.permutation(circles)
    bodies = np.concatenate([p, polygons + c])
    inverse = np.argsort(bodies)
    j = random.permutation(len(observation.joint_mask))
    t = random.permutation(len(observation.thruster_mask))
    return Entities(
        circles=observation.circles[c],
        polygons=observation.polygons[p],
        joints=observation.joints[j],
        thrusters=observation.thrusters[t],
        circle_mask=observation.circle_mask[c],
        polygon_mask=observation.polygon_mask[p],
        joint_mask=observation.joint_mask[j],
        thruster_mask=observation.thruster_mask[t],
        attention_mask=observation.attention_mask[:, bodies][:, :, bodies],
        joint_indexes=inverse[observation.joint_indexes[j]],
        thruster_indexes=inverse[observation.thruster_indexes[t]],
    )


def _padded(observation: Entities) -> Entities:
    """The same scene with one empty slot more of every kind."""
    polygons = len(observation.polygon_mask)

    def row(values):
        return np.concatenate([values, np.full_like(values[:1], 7)])

    def absent(mask):
        return np.append(mask, False)

    def moved(index):
        return np.where(index >= polygons, index + 1, index)

    planes = np.insert(observation.attention_mask, polygons, False, axis=1)
    planes = np.insert(planes, polygons, False, axis=2)
    zero_pair = np.zeros((1, 2), np.int32)
    return Entities(
        circles=row(observation.circles),
        polygons=row(observation.polygons),
        joints=row(observation.joints),
        thrusters=row(observation.thrusters),
        circle_mask=absent(observation.circle_mask),
        polygon_mask=absent(observation.polygon_mask),
        joint_mask=absent(observation.joint_mask),
        thruster_mask=absent(observation.thruster_mask),
        attention_mask=np.pad(planes, ((0, 0), (0, 1), (0, 1))),
        joint_indexes=np.concatenate([moved(observation.joint_indexes), zero_pair]),
        thruster_indexes=np.append(moved(observation.thruster_indexes), 0),
    )


def test_permuting_entities_changes_nothing(transformer):
    observation = random_entities(1)
    np.testing.assert_allclose(
        transformer(_permuted(observation, 2)), transformer(observation), atol=1e-4
    )


def test_empty_slots_change_nothing(transformer):
    observation = random_entities(3)
    np.testing.assert_allclose(
        transformer(_padded(observation)), transformer(observation), atol=1e-4
    )


def test_inactive_entities_have_no_influence(transformer):
    observation = random_entities(4)
    gradient = jax.jacrev(
        lambda rows: transformer(
            observation._replace(
                polygons=rows[0], circles=rows[1], joints=rows[2], thrusters=rows[3]
            )
        )
    )((observation.polygons, observation.circles, observation.joints, observation.thrusters))
    masks = (
        observation.polygon_mask,
        observation.circle_mask,
        observation.joint_mask,
        observation.thruster_mask,
    )
    for rows, mask in zip(gradient, masks, strict=True):
        assert np.all(np.isfinite(rows))
        np.testing.assert_array_equal(rows[:, ~mask], 0)
        assert np.any(rows[:, mask] != 0)


@pytest.mark.parametrize("mode", ["mean", "dummy", "dummy_and_mean"])
def test_aggregate_modes_differ_and_stay_finite_in_an_empty_scene(mode):
    network = build_network(
        dataclasses.replace(_SMALL, aggregate_mode=mode), action_head("multi_discrete")
    )
    full = random_entities(0)
    empty = full._replace(
        polygon_mask=np.zeros_like(full.polygon_mask), circle_mask=np.zeros_like(full.circle_mask)
    )
    params = network.init(jax.random.key(0), initial_carry(1), (with_axes(full), _DONES))
    _, _, value = network.apply(params, initial_carry(1), (with_axes(empty), _DONES))
    assert np.isfinite(value).all()


def test_dropout_acts_only_in_training():
    config = dataclasses.replace(_SMALL, transformer_ffn=True, dropout_prob=0.5)
    network = build_network(config, action_head("discrete"))
    inputs = (with_axes(random_entities(0)), _DONES)
    params = network.init(jax.random.key(0), initial_carry(1), inputs)

    def value(train, seed=0):
        rngs = {"dropout": jax.random.key(seed)}
        return float(
            network.apply(params, initial_carry(1), inputs, train=train, rngs=rngs)[2].item()
        )

    assert value(False) == value(False, 1)
    assert value(True) != value(True, 1)


def test_message_blocks_of_several_layers_have_their_names():
    config = dataclasses.replace(
        _SMALL, multilayer_joint_thruster_mixing=True, joint_thruster_block_num_layers=3
    )
    network = build_network(config, action_head("discrete"))
    inputs = (with_axes(random_entities(0)), _DONES)
    params = jax.eval_shape(network.init, jax.random.key(0), initial_carry(1), inputs)["params"]
    for layer in range(2):
        block = params["Transformer_0"][f"joint_layers_{layer}"]
        assert [block[f"Dense_{i}"]["kernel"].shape for i in range(3)] == [
            (48, 64),
            (64, 64),
            (64, 16),
        ]


@pytest.mark.parametrize(
    ("preset", "millions"),
    [("tf-paper", 0.786369), ("tf-s", 1.955233), ("tf-m", 38.9), ("tf-l", 53.1)],
)
def test_sizes_of_the_presets(preset, millions):
    network = build_network(NETWORK_PRESETS[preset], action_head("multi_discrete"))
    inputs = (with_axes(random_entities(0)), _DONES)
    shapes = jax.eval_shape(network.init, jax.random.key(0), initial_carry(1), inputs)
    count = sum(leaf.size for leaf in jax.tree.leaves(shapes))
    assert count == pytest.approx(millions * 1e6, rel=2e-3)


def test_resnet_has_the_documented_tree():
    config = NetworkConfig(kind="cnn", cnn_mode="resnet_18")
    network = build_network(config, action_head("continuous"))
    picture = Picture(image=np.zeros((125, 125, 3), np.float32), global_info=np.zeros(1))
    inputs = (with_axes(picture), _DONES)
    params = jax.eval_shape(network.init, jax.random.key(0), initial_carry(1), inputs)["params"]
    assert set(params["ResNetBasicBlock_2"]) == {
        f"{kind}_{index}" for kind in ("Conv", "GroupNorm") for index in range(3)
    }
    assert set(params["ResNetBasicBlock_1"]) == {"Conv_0", "Conv_1", "GroupNorm_0", "GroupNorm_1"}
    assert sum(name.startswith("ResNetBasicBlock") for name in params) == 8
    assert params["GeneralActorCriticRNN_0"]["log_std"].shape == (6,)


@pytest.mark.parametrize("kind", OBSERVATIONS_OF_KIND)
def test_what_the_critic_has_alone_moves_the_value_and_never_the_policy(kind):
    config = dataclasses.replace(_SMALL, kind=kind, recurrent_model=True, encoder_size=16)
    network = build_network(config, action_head("multi_discrete"))
    observations = {
        "flat_mlp": jnp.ones(9),
        "cnn": Picture(image=jnp.ones((40, 40, 3)), global_info=jnp.ones(1)),
    }
    inputs = (with_axes(observations.get(kind, random_entities(0))), _DONES)
    params = network.init(jax.random.key(0), initial_carry(1), inputs)

    def told(params, what):
        _, policy, value = network.apply(params, initial_carry(1), inputs)
        return jnp.sum(policy.logits**2) if what == "policy" else jnp.sum(value)

    of_policy, of_value = (
        for_the_critic_alone(config, jax.jit(jax.grad(told), static_argnums=1)(params, what))
        for what in ("policy", "value")
    )
    assert not any(jnp.any(x) for x in jax.tree.leaves(of_policy))
    # A weight and a bias of the hidden layer and of the last one.
    assert sum(bool(jnp.any(x)) for x in jax.tree.leaves(of_value)) == 4


def test_memory_is_cleared_before_the_step_where_an_episode_begins():
    config = NetworkConfig(kind="flat_mlp", recurrent_model=True, actor_depth=1, critic_depth=1)
    network = build_network(config, action_head("multi_discrete"))
    observation = jnp.ones((4, 2, 5))
    dones = jnp.zeros((4, 2), bool).at[2, 0].set(True)
    params = network.init(jax.random.key(0), initial_carry(2), (observation, dones))
    _, _, value = network.apply(params, initial_carry(2), (observation, dones))
    assert value[2, 0] == pytest.approx(float(value[0, 0]), abs=1e-6)
    assert value[2, 1] != pytest.approx(float(value[0, 1]), abs=1e-6)


@pytest.mark.parametrize(
    ("changes", "sentence"),
    [
        ({"num_heads": 6}, "num_heads: expected a multiple of 4"),
        ({"transformer_size": 12}, "transformer_size: expected a multiple of 8"),
        ({"activation": "gelu"}, "activation: expected one of tanh, relu, got 'gelu'"),
        ({"actor_width": 10**9}, "actor_width: expected a whole number from 1 to 65536"),
        ({"transformer_depth": True}, "transformer_depth: expected a whole number"),
        ({"dropout_prob": 1.0}, "dropout_prob: expected 0 ≤ x < 1"),
        (
            {"kind": "permutation_invariant_mlp", "encoder_size": 4},
            "encoder_size: expected more than 4",
        ),
    ],
)
def test_impossible_options_are_refused_with_a_sentence(changes, sentence):
    with pytest.raises(ValueError, match=sentence):
        NetworkConfig(**changes)
