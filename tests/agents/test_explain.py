"""Explanations of a network: attention and importance."""

import dataclasses

import jax
import jax.numpy as jnp
import numpy as np
import pytest

from kinetix.agents.agent import Agent
from kinetix.agents.card import (
    ActionCard,
    AgentCard,
    CapacityCard,
    EnvironmentCard,
    ObservationCard,
)
from kinetix.agents.environments import environment_for
from kinetix.agents.explain import MOVED, Situation, attention, saliency, values_over_places
from kinetix.agents.from_card import init_parameters
from kinetix.agents.networks.config import NetworkConfig
from kinetix.environment.reset import level_state
from kinetix.level.sizes import SIZES

LEVEL = "s/goalkeeper"


def _moment(agent, env) -> Situation:
    state = jax.tree.map(jnp.asarray, level_state(LEVEL, env.static_env_params))
    return Situation(state=state, carry=agent.init_carry(1), begins=jnp.ones((), bool))


def _value(agent, env, moment, state) -> float:
    seen = jax.tree.map(lambda x: x[None], env.get_obs(state))
    keys, begins = jax.random.key(0)[None], jnp.ones(1, bool)
    return float(agent.policy.decide(agent.params, moment.carry, seen, keys, begins)[2]["value"][0])


def _made_up(observation: str, action: str, network: NetworkConfig) -> Agent:
    """An agent of size s with drawn parameters."""
    sizes = dataclasses.asdict(SIZES["s"])
    card = AgentCard(
        name="made up",
        observation=ObservationCard(type=observation),  # pyright: ignore[reportArgumentType]
        action=ActionCard(type=action),  # pyright: ignore[reportArgumentType]
        capacity=CapacityCard(**sizes, motor_bindings=4, thruster_bindings=2),
        network=network,
        environment=EnvironmentCard(physics="balanced"),
    )
    return Agent(card, init_parameters(card, jax.random.key(1)))


@pytest.fixture(scope="module")
def entity():
    """An entity transformer on a level of size s."""
    agent = _made_up("symbolic_entity", "multi_discrete", NetworkConfig())
    env = environment_for(agent, SIZES["s"], physics="balanced")
    return agent, env, _moment(agent, env)


def test_attention_adds_up_and_leaves_empty_slots_out(entity) -> None:
    """Shares of the bodies that are there, together at most 1; asking changes no decision."""
    agent, env, moment = entity
    told = np.asarray(attention(env, agent.policy, agent.params, moment))
    active = np.asarray(moment.state.world.bodies.active)
    assert told.shape == active.shape
    assert np.all(told[active] > 0) and np.all(told[~active] == 0)
    assert 0.2 < told.sum() <= 1.0 + 1e-5


def test_saliency_is_the_slope_of_the_value(entity) -> None:
    """A small push along the steepest way changes the value as the gradient says."""
    agent, env, moment = entity
    told = saliency(env, agent.policy, agent.params, moment, "value")
    bodies, state = np.asarray(told.bodies), moment.state
    active = np.asarray(state.world.bodies.active)
    assert np.all(bodies >= 0) and np.all(bodies[~active] == 0) and bodies.max() > 0

    def value(position) -> jax.Array:
        physics = dataclasses.replace(state.physics, position=position)
        seen = env.observations(dataclasses.replace(state, physics=physics))
        one = jax.tree.map(lambda x: x[None], seen)
        keys, begins = jax.random.key(0)[None], jnp.ones(1, bool)
        return agent.policy.decide(agent.params, moment.carry, one, keys, begins)[2]["value"][0]

    body = int(np.argmax(bodies))
    step = 1e-3
    slopes = []
    for axis in (0, 1):
        shift = jnp.zeros_like(state.physics.position).at[body, axis].set(step)
        up, down = value(state.physics.position + shift), value(state.physics.position - shift)
        slopes.append(float(up - down) / (2 * step))
    # The position's part alone is no more than the whole.
    assert MOVED * float(np.hypot(*slopes)) <= bodies[body] * 1.05 + 1e-4
    action = saliency(env, agent.policy, agent.params, moment, "action")
    assert np.isfinite(np.asarray(action.bodies)).all()


def test_values_over_places_are_those_of_the_moved_state(entity) -> None:
    """A map holds the value of the state at its own place, and of the moved level elsewhere."""
    agent, env, moment = entity
    state = moment.state
    moved = jnp.zeros(state.world.bodies.active.shape, bool).at[4].set(True)
    shifts = jnp.array([[0.0, 0.0], [0.3, -0.2]])
    told = values_over_places(env, agent.policy, agent.params, moment, moved, shifts)
    position = state.physics.position.at[4].add(shifts[1])
    there = dataclasses.replace(
        state, physics=dataclasses.replace(state.physics, position=position)
    )
    assert float(told[0]) == pytest.approx(_value(agent, env, moment, state), abs=1e-4)
    assert float(told[1]) == pytest.approx(_value(agent, env, moment, there), abs=1e-4)


@pytest.mark.parametrize(
    ("observation", "action", "network"),
    [
        ("symbolic_flat", "multi_discrete", NetworkConfig(kind="flat_mlp")),
        ("symbolic_flat", "continuous", NetworkConfig(kind="flat_mlp", recurrent_model=True)),
        ("pixels", "discrete", NetworkConfig(kind="cnn")),
    ],
)
def test_every_network_has_a_saliency(observation, action, network) -> None:
    """Flat, recurrent, continuous and pixel networks: something matters, empty slots do not."""
    agent = _made_up(observation, action, network)
    env = environment_for(agent, SIZES["s"], physics="balanced")
    moment = _moment(agent, env)
    assert attention(env, agent.policy, agent.params, moment) is None
    for about in ("value", "action"):
        told = saliency(env, agent.policy, agent.params, moment, about)
        bodies = np.asarray(told.bodies)
        assert bodies.max() > 0 and np.isfinite(bodies).all()
        assert np.all(bodies[~np.asarray(moment.state.world.bodies.active)] == 0)
