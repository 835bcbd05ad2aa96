"""Shapes of an agent's parameters, found without making any."""

from types import SimpleNamespace
from typing import Any

import jax
import jax.numpy as jnp
from flax import linen as nn

from kinetix.agents.arrays import Tree
from kinetix.agents.card import AgentCard, CapacityCard
from kinetix.agents.networks.build import build_network
from kinetix.agents.networks.distributions import action_head
from kinetix.agents.networks.recurrent import initial_carry
from kinetix.environment.observations import OBSERVATIONS, AbstractObservation, Layout
from kinetix.environment.params import EnvParams, StaticEnvParams
from kinetix.environment.spaces import Dict

_USUAL = CapacityCard(polygons=5, circles=2, joints=1, thrusters=1)
"""Stands in where a card does not have it; the parameters do not depend on it."""


def static_env_params_of_card(card: AgentCard, **changes: Any) -> StaticEnvParams:
    """Sizes and physics of the environment that an agent was trained in.

    Args:
        card: The agent's description.
        **changes: Other fields of `StaticEnvParams`.
    """
    capacity = card.capacity or _USUAL
    values: dict[str, Any] = {
        "num_polygons": capacity.polygons,
        "num_circles": capacity.circles,
        "num_joints": capacity.joints,
        "num_thrusters": capacity.thrusters,
        "num_motor_bindings": capacity.motor_bindings,
        "num_thruster_bindings": capacity.thruster_bindings,
        "frame_skip": card.environment.frame_skip,
        "physics": card.environment.physics,
    }
    return StaticEnvParams(**(values | changes))


def observations_of_card(
    card: AgentCard, env_params: EnvParams, static_env_params: StaticEnvParams
) -> AbstractObservation:
    """Return the agent's observations of an environment, with the agent's own options.

    Args:
        card: The agent's description.
        env_params: The environment's parameters.
        static_env_params: Its sizes.
    """
    layout = Layout.of(env_params, static_env_params)
    options: dict[str, Any] = dict(card.observation.options)
    if card.network.kind in (
        "relational",
        "permutation_invariant_mlp",
    ) and card.observation.type.endswith("entity"):
        options.setdefault("attention", False)
    if card.network.kind == "relational":
        options.setdefault("from_upper_corner", True)
    return OBSERVATIONS[card.observation.type](layout=layout, **options)


def zero_observation(observations: AbstractObservation, *axes: int) -> Any:
    """Return an observation of nothing: zeros of the right shapes.

    Args:
        observations: The kind of observation.
        *axes: Leading axes.
    """
    space: Any = observations.space
    if isinstance(space, Dict):
        parts: dict[str, Any] = dict(space.spaces)
        return SimpleNamespace(
            **{name: jnp.zeros((*axes, *part.shape), part.dtype) for name, part in parts.items()}
        )
    return jnp.zeros((*axes, *space.shape), space.dtype)


def network_of_card(card: AgentCard) -> nn.Module:
    """Return the network that an agent's description asks for.

    Args:
        card: The agent's description.
    """
    sizes = card.capacity or _USUAL
    head = action_head(
        card.action.type,
        motor_bindings=sizes.motor_bindings,
        thruster_bindings=sizes.thruster_bindings,
    )
    return build_network(card.network, head)


def init_parameters(card: AgentCard, key: jax.Array) -> dict[str, Any]:
    """Return fresh parameters for an agent.

    Args:
        card: Its description.
        key: Random key.

    Returns:
        The tree below "params".
    """
    static_env_params = static_env_params_of_card(card)
    observations = observations_of_card(card, EnvParams(), static_env_params)
    inputs = (zero_observation(observations, 1, 1), jnp.zeros((1, 1), bool))
    network = network_of_card(card)

    @jax.jit  # each array by a program of its own takes thrice as long
    def drawn(key: jax.Array) -> Any:
        return network.init(key, initial_carry(1), inputs)["params"]

    return drawn(key)


def normalised_widths(card: AgentCard) -> dict[str, int]:
    """Return the columns of every part of the observation that normalisation applies to, by field.

    Args:
        card: The agent's description.
    """
    static_env_params = static_env_params_of_card(card)
    space: Any = observations_of_card(card, EnvParams(), static_env_params).space
    if not isinstance(space, Dict):
        return {"": space.shape[-1]}
    parts: dict[str, Any] = dict(space.spaces)
    return {
        name: part.shape[-1]
        for name, part in parts.items()
        if jnp.issubdtype(part.dtype, jnp.floating)
    }


def parameter_shapes(card: AgentCard) -> Tree:
    """Shape and dtype of every parameter, as nested dictionaries.

    Args:
        card: The agent's description.
    """
    return jax.eval_shape(lambda: init_parameters(card, jax.random.key(0)))
