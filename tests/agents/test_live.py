"""One watched episode: memory, draws, hands that take over, and what the agent was up to."""

import jax
import jax.numpy as jnp
import numpy as np
import pytest

from kinetix.agents.agent import Agent
from kinetix.agents.card import AgentCard, CapacityCard, ObservationCard
from kinetix.agents.environments import capacity_for, environment_for
from kinetix.agents.from_card import init_parameters
from kinetix.agents.live import intention, play_step
from kinetix.agents.networks.config import NetworkConfig
from kinetix.engine.spec import Capacity
from kinetix.environment.actions import ACTIONS
from kinetix.environment.reset import level_state
from kinetix.errors import CheckpointError
from kinetix.level.model import Body, Circle, Level

LEVEL = Level(
    name="fall",
    next_id=3,
    bodies=(
        Body(id=1, shape=Circle(radius=0.2), position=(2.5, 3.0), role="green"),
        Body(id=2, shape=Circle(radius=0.2), position=(1.0, 0.6), fixed=True, role="blue"),
    ),
)
SMALL = Capacity(polygons=5, circles=2, joints=1, thrusters=1)
HAND = jnp.array([1.0, 0.0, 0.0, 0.0, 0.0, 1.0])


@pytest.fixture(scope="module")
def player():
    card = AgentCard(
        name="remembers",
        observation=ObservationCard(type="symbolic_flat"),
        network=NetworkConfig(
            kind="flat_mlp", recurrent_model=True, actor_depth=1, critic_depth=1, actor_width=8
        ),
        capacity=CapacityCard(polygons=5, circles=2, joints=1, thrusters=1),
    )
    return Agent(card, init_parameters(card, jax.random.key(1)))


@pytest.fixture(scope="module")
def played(player):
    """Six steps, a person driving in the fourth: states before each, thoughts, the last memory."""
    env = environment_for(player, SMALL, physics="jax2d")
    state = jax.tree.map(jnp.asarray, level_state(LEVEL, env.static_env_params))
    carry, key = player.policy.init_carry(1), jax.random.key(3)
    states, thoughts = [], []
    for step in range(6):
        states.append(state)
        state, carry, thought, info = play_step(
            env,
            player.policy,
            player.params,
            state,
            carry,
            jnp.asarray(step == 0),
            jax.random.fold_in(key, step),
            HAND,
            jnp.asarray(step == 3),
        )
        thoughts.append(thought)
        assert not info["nan"]
    return env, states, thoughts, carry


def test_memory_lasts_through_the_episode_also_while_a_person_drives(player, played):
    env, states, _, carry = played
    seen = jnp.stack([env.get_obs(state) for state in states])[:, None]
    done = jnp.zeros((6, 1), bool).at[0].set(True)
    network = player.policy.network
    memory, _, _ = network.apply(
        {"params": player.params["params"]}, player.policy.init_carry(1), (seen, done)
    )
    np.testing.assert_allclose(carry[0], memory[0], atol=1e-5)
    assert float(jnp.abs(carry[0]).max()) > 0.01


def test_a_hand_is_played_and_the_agent_still_tells_what_it_would_do(played):
    _, _, thoughts, _ = played
    np.testing.assert_array_equal(thoughts[3].action, HAND)
    for k in (0, 1, 2, 4, 5):
        np.testing.assert_array_equal(thoughts[k].action, thoughts[k].own_action)
    assert all(bool(thought.sane) for thought in thoughts)
    assert [float(thought.entropy) for thought in thoughts] == [0.0] * 6  # nothing to control


@pytest.mark.parametrize("kind", sorted(ACTIONS))
def test_intention_is_the_mean_action(kind):
    actions = ACTIONS[kind]()
    if kind == "continuous":
        logits = jnp.array([0.5, -2.0, 0.0, 1.0, 0.25, -1.0])
        np.testing.assert_allclose(intention(actions, logits), [0.5, -1, 0, 1, 0.25, 0])
        return
    count = 16 if kind == "multi_discrete" else 11
    logits = jax.random.normal(jax.random.key(0), (count,))
    keys = jax.random.split(jax.random.key(1), 4000)
    if kind == "discrete":
        drawn = jax.vmap(lambda key: jax.random.categorical(key, logits))(keys)
    else:
        parts = [logits[3 * k : 3 * k + 3] for k in range(4)] + [logits[12:14], logits[14:]]
        drawn = jax.vmap(
            lambda key: jnp.stack(
                [
                    jax.random.categorical(jax.random.fold_in(key, k), part)
                    for k, part in enumerate(parts)
                ]
            )
        )(keys)
    mean = jax.vmap(actions.unified)(drawn).mean(axis=0)
    np.testing.assert_allclose(intention(actions, logits), mean, atol=0.05)


def test_a_flat_agent_says_which_level_is_too_large(player):
    assert capacity_for(player.card, SMALL, level="x") == SMALL
    large = Capacity(polygons=6, circles=2, joints=1, thrusters=1)
    with pytest.raises(CheckpointError, match=r"sees exactly 5 polygons.*x with 6 polygons"):
        capacity_for(player.card, large, level="x")
