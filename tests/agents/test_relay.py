"""Networks that take turns: who decides when, and that an agent of them is one like any other."""

import jax
import jax.numpy as jnp
import numpy as np
import pytest

from kinetix import load_agent, save_agent
from kinetix.agents.agent import Agent
from kinetix.agents.card import ActionCard, AgentCard, ObservationCard
from kinetix.agents.networks.config import NetworkConfig
from kinetix.agents.networks.recurrent import initial_carry
from kinetix.agents.relay import first_of, together
from kinetix.agents.shapes import init_parameters
from kinetix.errors import CheckpointError
from tests.agents.test_relational import seen
from tests.agents.tiny import NETWORK

TURN = 3
RELATIONAL = NetworkConfig(
    kind="relational", encoder_size=16, actor_depth=1, critic_depth=1, actor_width=16
)


def member(number: int, network: NetworkConfig = RELATIONAL) -> Agent:
    card = AgentCard(
        name=f"member {number}",
        network=network,
        observation=ObservationCard(type="symbolic_entity"),
        action=ActionCard(type="multi_discrete"),
    )
    return Agent(card, init_parameters(card, jax.random.key(number)))


@pytest.fixture(scope="module")
def members():
    return [member(number) for number in range(3)]


@pytest.fixture(scope="module")
def relay(members):
    return together(members, TURN)


@pytest.fixture(scope="module")
def observation():
    """Of two environments."""
    one = seen("m/turnabout", "m")
    return jax.tree.map(lambda x: jnp.broadcast_to(x, (2, *x.shape)), one)


def logits(agent: Agent, observation, dones: list[tuple[bool, bool]]) -> np.ndarray:
    """Of every decision, [decision, environment, choice]."""
    carry, told = agent.init_carry(2), []
    for done in dones:
        _, carry, info = agent.act(carry, observation, jax.random.key(0), done=np.array(done))
        told.append(info["logits"])
    return np.array(told)


def test_each_decides_for_a_turn_and_an_episode_begins_with_the_first(members, relay, observation):
    of_each = [logits(each, observation, [(True, True)])[0] for each in members]
    assert np.abs(of_each[0] - of_each[1]).max() > 1e-4
    # The second environment's episode ends after four decisions.
    dones = [(step == 0, step in (0, 4)) for step in range(3 * TURN + 2)]
    said = logits(relay, observation, dones)
    for step in range(len(dones)):
        for row, since in ((0, step), (1, step - 4 if step >= 4 else step)):
            expected = of_each[since // TURN % 3][row]
            np.testing.assert_allclose(said[step, row], expected, atol=1e-6, err_msg=f"{step}")


def test_many_decisions_at_once_are_those_of_one_after_the_other(relay, observation):
    steps = 2 * TURN + 1
    dones = np.zeros((steps, 2), bool)
    dones[0] = dones[2, 1] = True
    many = jax.tree.map(lambda x: jnp.broadcast_to(x, (steps, *x.shape)), observation)
    variables = {"params": relay.params["params"]}
    carry, policy, value = relay.policy.network.apply(variables, initial_carry(2), (many, dones))
    singly = logits(relay, observation, [tuple(done) for done in dones])
    np.testing.assert_allclose(policy.logits, singly, atol=1e-6)
    assert value.shape == (steps, 2)
    np.testing.assert_array_equal(carry[1][:, 0], [steps, steps - 2])


def test_it_is_saved_and_loaded_like_any_agent(relay, tmp_path):
    save_agent(relay, tmp_path / "own")
    loaded = load_agent(tmp_path / "own")
    assert loaded.card.network.members == 3
    assert loaded.digest == relay.digest


def test_the_first_of_them_is_an_agent_too(members, relay):
    first = first_of(relay)
    assert first.digest == members[0].digest
    assert first.card.network == members[0].card.network
    assert first_of(first) is first


def test_agents_that_differ_in_more_than_parameters_cannot_take_turns(members):
    with pytest.raises(CheckpointError, match="member 7: expected the network"):
        together([members[0], member(7, NETWORK)], TURN)


def test_kinetix_envs_form_cannot_carry_it(tmp_path):
    pair = together([member(number, NETWORK) for number in range(2)], TURN)
    with pytest.raises(CheckpointError, match="take turns"):
        save_agent(pair, tmp_path, format="kinetix-env")


def test_networks_with_memory_cannot_take_turns():
    with pytest.raises(ValueError, match=r"members: .* no memory"):
        NetworkConfig(kind="relational", recurrent_model=True, members=2)


def test_more_members_than_anybody_would_compute_are_refused():
    with pytest.raises(ValueError, match="members: expected at most 16, got 17"):
        NetworkConfig(members=17)
