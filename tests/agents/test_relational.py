"""The relational network: no slot means anything to it, whatever the weights and the actions."""

import dataclasses

import jax
import jax.numpy as jnp
import numpy as np
import pytest

from kinetix import load_agent, load_level, save_agent
from kinetix.agents.agent import Agent
from kinetix.agents.card import ActionCard, AgentCard, ObservationCard
from kinetix.agents.from_card import init_parameters, observations_of_card
from kinetix.agents.networks.build import build_network
from kinetix.agents.networks.config import NetworkConfig
from kinetix.agents.networks.distributions import action_head
from kinetix.agents.networks.recurrent import initial_carry
from kinetix.agents.networks.relational import (
    _ANCHOR,
    _BLUE,
    _CIRCLE_WITHOUT_ROLES,
    _CORNERS,
    _GREEN,
    _JET,
    _JET_KEY,
    _JOINT_WITHOUT_KEYS,
    _MOTOR_KEY,
    _PLACE,
    _ROLES,
    _THRUSTER_WITHOUT_KEYS,
    _WEIGHTS,
)
from kinetix.environment.actions import ACTIONS
from kinetix.environment.observations import EntityObservations, Layout
from kinetix.environment.params import EnvParams, StaticEnvParams, static_env_params_from_size
from kinetix.environment.rearrange import permute_state
from kinetix.environment.reset import level_state
from kinetix.errors import CheckpointError
from tests.agents.observations import with_axes

_CONFIG = NetworkConfig(
    kind="relational", encoder_size=16, actor_depth=1, critic_depth=1, actor_width=16
)
_LAYOUT = Layout.of(EnvParams(), StaticEnvParams())


def seen(name: str, size: str, *, shuffled: int | None = None):
    """The entity observation of a level in the slots of a size."""
    static = static_env_params_from_size(size)
    state = level_state(load_level(f"levels/{name}.json"), static)
    if shuffled is not None:
        state = jax.jit(permute_state)(jax.random.key(shuffled), state)
    layout = Layout.of(EnvParams(), static)
    return jax.jit(EntityObservations(layout=layout, attention=False))(state)


def network(action: str = "multi_discrete", **changes):
    return build_network(dataclasses.replace(_CONFIG, **changes), action_head(action))


@pytest.fixture(scope="module")
def said():
    """From an observation to logits (the last layers start small: scaled up) and value."""
    made = network()
    inputs = (with_axes(seen("m/turnabout", "m")), jnp.zeros((1, 1), bool))
    params = jax.jit(made.init)(jax.random.key(0), initial_carry(1), inputs)

    @jax.jit
    def apply(observation):
        inputs = (with_axes(observation), jnp.zeros((1, 1), bool))
        _, policy, value = made.apply(params, initial_carry(1), inputs)
        return jnp.concatenate([100 * policy.logits[0, 0], value[0]])

    return apply


def test_columns_are_those_of_the_observation():
    circle = [feature.name for feature in _LAYOUT.circle]
    joint = [feature.name for feature in _LAYOUT.joint]
    thruster = [feature.name for feature in _LAYOUT.thruster]
    assert circle[_PLACE] == ["position_x", "position_y"]
    assert circle[_WEIGHTS] == ["inverse_mass", "inverse_inertia", "density"]
    assert (circle[_GREEN], circle[_BLUE]) == ("role_green", "role_blue")
    assert circle[_ROLES] == "role_neutral"
    assert circle[_ROLES + _LAYOUT.roles :][:2] == ["sin_rotation", "cos_rotation"]
    # The observation appends gravity.
    assert len(circle) + 1 == _CIRCLE_WITHOUT_ROLES + _LAYOUT.roles
    corners = [feature.name for feature in _LAYOUT.polygon][len(circle) - 1 :]
    assert len(corners) == _CORNERS + 1
    assert (corners[0], corners[-1]) == ("vertex_0_x", "is_triangle")
    assert joint[_ANCHOR] == ["from_anchor_x", "from_anchor_y"]
    assert joint[_MOTOR_KEY] == "motor_binding_0"
    assert len(joint) == _JOINT_WITHOUT_KEYS + _LAYOUT.motor_bindings
    assert thruster[_JET] == ["position_x", "position_y"]
    assert thruster[_JET_KEY] == "thruster_binding_0"
    assert thruster[_JET_KEY + _LAYOUT.thruster_bindings] == "sin_angle"
    assert len(thruster) == _THRUSTER_WITHOUT_KEYS + _LAYOUT.thruster_bindings


@pytest.mark.parametrize("name", ["m/turnabout", "m/segway", "l/rover_ridge"])
def test_slots_mean_nothing(said, name):
    size = name[0]
    once = said(seen(name, size))
    np.testing.assert_allclose(said(seen(name, size, shuffled=3)), once, atol=2e-4)


def test_room_means_nothing(said):
    np.testing.assert_allclose(
        said(seen("m/turnabout", "l")), said(seen("m/turnabout", "m")), atol=2e-4
    )


def test_what_is_not_there_changes_nothing(said):
    observation = seen("s/wheelie", "l")
    masks = {
        "polygons": observation.polygon_mask,
        "circles": observation.circle_mask,
        "joints": observation.joint_mask,
        "thrusters": observation.thruster_mask,
    }
    rows = {name: getattr(observation, name) for name in masks}
    gradient = jax.jacrev(lambda rows: said(observation._replace(**rows)))(rows)
    for name, mask in masks.items():
        assert np.all(np.isfinite(gradient[name]))
        np.testing.assert_array_equal(gradient[name][:, ~np.asarray(mask)], 0)
    assert np.any(gradient["joints"] != 0)


def test_a_control_without_a_joint_or_thruster_says_nothing(said):
    logits = said(seen("s/wheelie", "s"))[:-1]
    motors, jets = logits[:12].reshape(4, 3), logits[12:].reshape(2, 2)
    assert np.sum(np.any(motors != 0, axis=1)) == 1
    np.testing.assert_array_equal(jets, 0)


@pytest.mark.parametrize("action", ["multi_discrete", "discrete", "continuous"])
@pytest.mark.parametrize("recurrent", [False, True])
def test_every_kind_of_action_and_memory(action, recurrent):
    made = network(action, recurrent_model=recurrent)
    inputs = (with_axes(seen("m/turnabout", "m"), steps=2), jnp.zeros((2, 1), bool))
    params = jax.jit(made.init)(jax.random.key(0), initial_carry(1), inputs)
    carry, policy, value = jax.jit(made.apply)(params, initial_carry(1), inputs)
    assert policy.logits.shape == (2, 1, action_head(action).dimension)
    assert bool(jnp.any(carry[0] != 0)) is recurrent
    assert bool(value[0, 0] == value[1, 0]) is not recurrent


@pytest.mark.parametrize("action", ["multi_discrete", "discrete", "continuous"])
@pytest.mark.parametrize("control", range(6))
@pytest.mark.parametrize("sign", [-1, 1])
def test_heads_arrange_controls_as_actions_do(action, control, sign):
    """Logits that favour one control make the likeliest action drive that control alone."""
    if control >= 4 and sign < 0:
        return
    motors, jets = jnp.zeros((4, 3)), jnp.zeros((2, 2))
    if control < 4:
        motors = motors.at[control, 1 if sign > 0 else 2].set(1.0)
    else:
        jets = jets.at[control - 4, 1].set(1.0)
    head = action_head(action)
    logits = head.of_controls(motors, jets)
    done = ACTIONS[action](motor_bindings=4, thruster_bindings=2).unified(
        head(logits, jnp.zeros(head.dimension)).mode()
    )
    np.testing.assert_array_equal(done, np.eye(6)[control] * sign)


def test_an_empty_scene_is_no_trouble(said):
    nothing = jax.tree.map(jnp.zeros_like, seen("m/turnabout", "m"))
    assert np.all(np.isfinite(said(nothing)))


def test_it_is_saved_and_loaded_but_not_as_an_agent_of_kinetix_env(tmp_path):
    card = AgentCard(
        name="small",
        network=_CONFIG,
        observation=ObservationCard(type="symbolic_entity"),
        action=ActionCard(type="multi_discrete"),
    )
    agent = Agent(card, init_parameters(card, jax.random.key(0)))
    save_agent(agent, tmp_path / "own")
    loaded = load_agent(tmp_path / "own")
    assert jax.tree.all(jax.tree.map(np.array_equal, loaded.params, agent.params))
    assert loaded.card.plays_any_capacity
    with pytest.raises(CheckpointError, match="has no relational network"):
        save_agent(agent, tmp_path / "other", format="kinetix-env")


def test_it_sees_lists_of_corners_from_an_upper_one_on():
    def sees(kind):
        card = AgentCard(name="", network=dataclasses.replace(_CONFIG, kind=kind))
        return observations_of_card(card, EnvParams(), StaticEnvParams()).from_upper_corner

    assert sees("relational")
    assert not sees("entity_transformer")
