"""The published agent, and what every agent promises."""

import dataclasses
import json

import jax
import jax.numpy as jnp
import numpy as np
import pytest

from kinetix.agents.agent import Agent, load_agent, save_agent
from kinetix.agents.card import ObservationCard
from kinetix.errors import CheckpointError, KinetixError
from tests.agents.observations import published


def _batched(observation, count):
    return jax.tree.map(lambda x: jnp.broadcast_to(x, (count, *np.shape(x))), observation)


@pytest.fixture(scope="module")
def general(peer):
    return load_agent(peer.parent / "peer" / "agents" / "paper-general")


@pytest.mark.peer
@pytest.mark.parametrize("legacy", [True, False])
def test_published_agent_gives_the_recorded_logits(peer, general, legacy):
    with (peer / "fixtures" / "tfjs_entity_logits.json").open() as file:
        recorded = json.load(file)
    network = dataclasses.replace(general.card.network, legacy_entity_id=legacy)
    agent = Agent(general.card.replace(network=network), general.params["params"])
    for level, observation in published(peer).items():
        entities = _batched(observation["symbolic_entity"], 1)
        _, _, info = agent.act(agent.init_carry(1), entities, jax.random.key(0))
        expected = recorded[level][f"legacy_{legacy}"]
        np.testing.assert_allclose(info["logits"][0], expected["logits"], atol=2e-5)
        np.testing.assert_allclose(info["value"][0], expected["value"], atol=2e-5)


@pytest.mark.peer
def test_batch_size_does_not_matter(peer, general):
    observation = published(peer)["s/h3_point_the_thruster"]["symbolic_entity"]
    alone = general.act(general.init_carry(1), _batched(observation, 1), jax.random.key(0))
    many = general.act(general.init_carry(5), _batched(observation, 5), jax.random.key(0))
    np.testing.assert_allclose(many[2]["logits"][3], alone[2]["logits"][0], atol=1e-5)


@pytest.mark.peer
def test_actions_follow_the_key_and_the_flag(peer, general):
    observation = _batched(published(peer)["l/grasp_easy"]["symbolic_entity"], 64)
    carry = general.init_carry(64)
    likeliest, _, info = general.act(carry, observation, jax.random.key(0), deterministic=True)
    np.testing.assert_array_equal(likeliest, np.broadcast_to(likeliest[0], likeliest.shape))
    drawn, _, _ = general.act(carry, observation, jax.random.key(0))
    again, _, _ = general.act(carry, observation, jax.random.key(0))
    np.testing.assert_array_equal(drawn, again)
    assert len(np.unique(drawn, axis=0)) > 1
    assert set(info) == {"logits", "log_prob", "value", "entropy"}
    assert np.all(info["entropy"] > 0)


def test_what_an_agent_cannot_be_asked_with():
    agent = load_agent("goalkeeper")
    carry, key = agent.init_carry(2), jax.random.key(0)
    with pytest.raises(KinetixError, match=r"sees symbolic_flat of shape \(140,\), got \(7,\)"):
        agent.act(carry, jnp.zeros((2, 7)), key)
    entities = agent.card.replace(observation=ObservationCard(type="symbolic_entity"))
    with pytest.raises(KinetixError, match=r"sees symbolic_entity, got .* without 'circles'"):
        Agent(entities, {}).act(carry, jnp.zeros((2, 140)), key)
    with pytest.raises(KinetixError, match="leading axis of environments; one observation gets it"):
        agent.act(carry, jnp.zeros(140), key)
    with pytest.raises(KinetixError, match=r"expected 2 environments, .* agent\.init_carry\(3\)"):
        agent.act(carry, jnp.zeros((3, 140)), key)
    with pytest.raises(KinetixError, match=r"key: expected .* the order is act\(carry, obs, key\)"):
        agent.act(carry, jnp.zeros((2, 140)), 0)
    with pytest.raises(CheckpointError, match="got str; the order is save_agent"):
        save_agent("here", agent)
    with pytest.raises(CheckpointError, match="directory=None: expected the directory of an agent"):
        load_agent(None)


@pytest.fixture(scope="module")
def agent():
    return load_agent("goalkeeper")


@pytest.mark.parametrize("batch", [None, -1, "2", 2.5])
def test_memory_is_made_for_a_number_of_episodes(agent, batch):
    with pytest.raises(KinetixError, match="expected a number of episodes"):
        agent.init_carry(batch)


def test_another_agent_is_made_of_the_parameters_alone(agent):
    """`agent.params` holds the normalisation as well."""
    with pytest.raises(KinetixError, match=r"params: expected .* pass params\['params'\]"):
        Agent(agent.card, agent.params)
    again = Agent(agent.card, agent.params["params"])
    assert again.digest == agent.digest


def test_memory_that_is_none_is_refused(agent):
    with pytest.raises(KinetixError, match="carry: expected what init_carry"):
        agent.act(None, None, jax.random.key(0))


@pytest.mark.parametrize("directory", ["", None, 3])
def test_an_agent_needs_a_directory(agent, directory):
    with pytest.raises(CheckpointError, match="expected the directory of an agent"):
        load_agent(directory)
    with pytest.raises(CheckpointError, match="expected the directory of an agent"):
        save_agent(agent, directory)
