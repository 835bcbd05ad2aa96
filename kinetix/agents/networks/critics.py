"""Parameters of the critic alone."""

from typing import Any

import jax
import jax.numpy as jnp
from jaxtyping import Array

from kinetix.agents.networks.config import NetworkConfig
from kinetix.agents.networks.heads import HEAD, critic_layers
from kinetix.agents.networks.relational import critic_layers as relational_critic_layers


def for_the_critic_alone(config: NetworkConfig, gradient: Any) -> Any:
    """Return a gradient with zeros for all but the critic's own layers of the head.

    Encoders wait, whether the policy reads them or not.

    Args:
        config: Of the network.
        gradient: A tree like the network's parameters.
    """
    if config.kind == "relational":
        within: tuple[str, ...] = ("params",)
        own = relational_critic_layers(config.critic_depth)
    else:
        within = ("params", HEAD)
        own = critic_layers(config.actor_depth, config.critic_depth)

    def kept(path: Any, x: Array) -> Array:
        *parts, layer = (step.key for step in path[: len(within) + 1])
        return x if tuple(parts) == within and layer in own else jnp.zeros_like(x)

    return jax.tree_util.tree_map_with_path(kept, gradient)
