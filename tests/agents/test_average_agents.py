"""The script that averages agents: what the card of the average says."""

import dataclasses

import jax
import jax.numpy as jnp
import pytest

from kinetix.agents.agent import Agent
from kinetix.agents.card import (
    ActionCard,
    AgentCard,
    CapacityCard,
    NormalisationCard,
    ObservationCard,
)
from kinetix.agents.from_card import init_parameters
from kinetix.agents.networks.config import NetworkConfig
from kinetix.errors import KinetixError
from scripts.average_agents import averaged

CARD = AgentCard(
    name="ppo-s-2048",
    observation=ObservationCard(type="symbolic_flat"),
    network=NetworkConfig(kind="flat_mlp", actor_depth=1, critic_depth=1, actor_width=8),
    capacity=CapacityCard(polygons=5, circles=2, joints=1, thrusters=1),
    training={"algorithm": "ppo", "seed": 3, "environment_steps": 2048, "wall_time": 9.5},
    results={"eval/mean": 0.9},
)


def test_agents_of_different_kinds_have_no_average():
    parameters = init_parameters(CARD, jax.random.key(0))
    statistics = NormalisationCard(count=1.0, mean={}, variance={})
    others = {
        "network": CARD.replace(network=dataclasses.replace(CARD.network, actor_depth=2)),
        "action": CARD.replace(action=ActionCard(type="discrete")),
        "normalisation": CARD.replace(normalisation=statistics),
    }
    for part, card in others.items():
        agents = [Agent(card.replace(name="other"), parameters), Agent(CARD, parameters)]
        with pytest.raises(KinetixError, match=f"other and ppo-s-2048 have no .*their {part} diff"):
            averaged(agents)


def test_an_average_does_not_claim_what_one_of_its_agents_did():
    parameters = init_parameters(CARD, jax.random.key(0))
    tripled = jax.tree.map(lambda x: 3 * x, parameters)
    agents = [Agent(CARD, parameters), Agent(CARD, tripled)]
    mean = averaged(agents, 4)
    digests = [agent.digest for agent in agents]
    assert mean.card.training == {"algorithm": "ppo", "seed": 3, "averaged": digests}
    assert not mean.card.results
    assert mean.card.environment.frame_skip == 4
    assert averaged(agents).card.environment == CARD.environment
    twice = jax.tree.map(lambda x: 2 * x, parameters)
    assert all(jax.tree.leaves(jax.tree.map(jnp.allclose, mean.params["params"], twice)))
