"""kinetix-env's network classes and draws by their own names."""

import jax
import jax.numpy as jnp
import numpy as np
import pytest

from kinetix import EnvParams, make_kinetix_env, static_env_params_from_size
from kinetix.environment.reset import level_state
from kinetix.errors import KinetixError

KEY = jax.random.PRNGKey(0)
MODEL = {
    "fc_layer_depth": 1,
    "fc_layer_width": 16,
    "transformer_depth": 1,
    "transformer_size": 16,
    "transformer_encoder_size": 16,
    "num_heads": 4,
    "aggregate_mode": "dummy_and_mean",
    "full_attention_mask": False,
    "activation": "tanh",
}
OBSERVATIONS = {
    "ActorCriticTransformer": "symbolic_entity",
    "ActorCriticPermutationInvariantSymbolicRNN": "symbolic_entity",
    "ActorCriticSymbolicRNN": "symbolic_flat",
    "ActorCriticPixelsRNN": "pixels",
}


def _network(name, **options):
    import kinetix.models.actor_critic as actor_critic
    import kinetix.models.transformer_model as transformer_model

    module = transformer_model if name.endswith("Transformer") else actor_critic
    return getattr(module, name)(**options)


@pytest.mark.parametrize("name", OBSERVATIONS)
def test_a_class_makes_the_network_of_the_same_configuration(name):
    from kinetix.models import ScannedRNN, make_network_from_config

    static = static_env_params_from_size("s")
    env = make_kinetix_env("multi_discrete", OBSERVATIONS[name], None, EnvParams(), static)
    observation = env.get_obs(level_state("s/goalkeeper", static))
    inputs = (
        jax.tree.map(lambda x: jnp.asarray(x)[None, None], observation),
        jnp.zeros((1, 1), bool),
    )
    carry = ScannedRNN.initialize_carry(1)
    ours = make_network_from_config(
        env,
        EnvParams(),
        MODEL
        | {"recurrent_model": True}
        | ({"permutation_invariant_mlp": True} if "Invariant" in name else {}),
    )
    theirs = _network(
        name,
        action_dim=6,
        action_mode="multi_discrete",
        multi_discrete_number_of_dims_per_distribution=[3, 3, 3, 3, 2, 2],
        hybrid_action_continuous_dim=6,
        recurrent=True,
        **MODEL,
    )

    def shapes(network):
        return jax.tree.map(lambda x: x.shape, jax.eval_shape(network.init, KEY, carry, inputs))

    assert shapes(theirs) == shapes(ours)


def test_a_policy_over_choices_of_ones_own():
    from kinetix.models.actor_critic import ActorCriticSymbolicRNN, ScannedRNN

    network = ActorCriticSymbolicRNN(action_dim=5, action_mode="discrete", actor_width=8)
    inputs, carry = (jnp.ones((1, 2, 7)), jnp.zeros((1, 2), bool)), ScannedRNN.initialize_carry(2)
    params = network.init(KEY, carry, inputs)
    _, policy, value = network.apply(params, carry, inputs)
    assert policy.logits.shape == (1, 2, 5)
    assert policy.sample(seed=KEY).shape == value.shape == (1, 2)


@pytest.mark.parametrize(
    ("options", "told"),
    [
        ({"action_mode": "hybrid"}, "action_mode: expected discrete, continuous"),
        ({}, "multi_discrete_number_of_dims_per_distribution: expected"),
        ({"action_mode": "discrete", "n_heads": 8}, "n_heads: no such option"),
        ({"action_mode": "discrete", "num_heads": 3}, "num_heads: expected a multiple of 4"),
        ({"action_mode": "discrete", "add_generator_embedding": True}, "expected False"),
    ],
)
def test_options_that_make_no_sense_are_named(options, told):
    with pytest.raises(KinetixError, match=told):
        _network("ActorCriticTransformer", action_dim=4, **options)


def test_draws_keep_to_their_bounds_and_use_all_of_them():
    from kinetix.environment.ued.locomotion_distribution import (
        sample_uniform,
        sample_uniform_and_exclude,
    )

    keys = jax.random.split(KEY, 4000)
    low, high = jnp.array([0.0, -1.0]), jnp.array([1.0, 3.0])
    plain = jax.vmap(lambda key: sample_uniform(key, low, high))(keys)
    np.testing.assert_allclose(plain.mean(0), (low + high) / 2, atol=0.06)
    drawn = np.asarray(jax.vmap(lambda key: sample_uniform(key, 0.0, 4.0, 1.0, 3.5))(keys))
    assert ((drawn < 1.0) | (drawn > 3.5)).all() and drawn.max() > 3.9
    assert (drawn < 1.0).mean() == pytest.approx(2 / 3, abs=0.03)  # by length, not by side
    assert sample_uniform_and_exclude(KEY, 0.0, 4.0, 1.0, 3.5) == sample_uniform(
        KEY, 0.0, 4.0, 1.0, 3.5
    )


def test_a_part_of_networks_says_what_makes_a_whole_one():
    from kinetix.models import GeneralActorCriticRNN

    assert len(GeneralActorCriticRNN.initialize_carry(2)) == 2
    with pytest.raises(KinetixError, match=r"make one with kinetix\.models\.make_network_from"):
        GeneralActorCriticRNN(6, recurrent=True)


def test_places_are_spread_evenly_over_shapes():
    from kinetix.environment.ued import util

    keys = jax.random.split(KEY, 4000)
    corners = jnp.array([(0.0, 0.0), (2.0, 0.0), (2.0, 1.0), (0.0, 1.0)])
    for count, centre in ((3, (4 / 3, 1 / 3)), (4, (1.0, 0.5))):
        places = jax.vmap(
            lambda key, n=count: util.random_position_on_polygon(key, corners, n, None)
        )(keys)
        np.testing.assert_allclose(places.mean(0), centre, atol=0.04)
        assert (places >= 0).all() and (places <= corners.max(0)).all()
        assert count == 4 or (places[:, 1] <= places[:, 0] / 2 + 1e-6).all()
    on = jax.vmap(lambda key: util.random_position_on_circle(key, 2.0, 0.25))(keys)
    far = np.linalg.norm(on, axis=1)
    assert far.max() <= 2.0
    assert (far == 0.0).mean() == pytest.approx(0.25, abs=0.03)
    assert (far > np.sqrt(2.0)).mean() == pytest.approx(0.75 / 2, abs=0.03)
