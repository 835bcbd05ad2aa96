"""Agents that take turns, put together and taken apart."""

import dataclasses
from collections.abc import Sequence

from kinetix.agents.agent import Agent
from kinetix.agents.networks.config import NetworkConfig
from kinetix.errors import CheckpointError


def together(agents: Sequence[Agent], turn: int) -> Agent:
    """Return an agent that begins as the first of some, and goes on as the next after each turn.

    Args:
        agents: Of one network without memory; what they observe and do is as the first describes.
        turn: Decisions of a turn.

    Raises:
        CheckpointError: Two of them differ in more than their parameters; the sentence says which.
    """
    first = agents[0].card
    for agent in agents[1:]:
        card = agent.card
        if (card.network, card.observation, card.action) != (
            first.network,
            first.observation,
            first.action,
        ):
            raise CheckpointError(
                f"{card.name}: expected the network, observation and action of {first.name}, as "
                "only agents that differ in nothing but their parameters can take turns"
            )
    network = dataclasses.replace(first.network, members=len(agents), turn=turn)
    params = {_name(k): agent.params["params"] for k, agent in enumerate(agents)}
    return Agent(first.replace(network=network), params)


def first_of(agent: Agent) -> Agent:
    """Return the agent that begins an episode: the first of those that take turns, or it alone."""
    network = agent.card.network
    if network.members == 1:
        return agent
    alone = dataclasses.replace(network, members=1, turn=NetworkConfig.turn)
    card = agent.card.replace(network=alone)
    return Agent(card, agent.params["params"][_name(0)])


def _name(index: int) -> str:
    """The member's name in the parameter tree."""
    return f"members_{index}"
