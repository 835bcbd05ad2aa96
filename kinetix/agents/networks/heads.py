"""The part that all networks share: optional memory, then an actor and a critic."""

import dataclasses
from collections.abc import Callable
from typing import Final

import jax
import jax.numpy as jnp
from flax import linen as nn
from jaxtyping import Array, Bool, Float

from kinetix.agents.networks.distributions import ActionHead, Distribution
from kinetix.agents.networks.recurrent import Carry, ScannedRNN
from kinetix.agents.networks.rows import linear

ACTIVATIONS: dict[str, Callable[[Array], Array]] = {"tanh": jnp.tanh, "relu": jax.nn.relu}
"""Activations by name."""

Output = tuple[Carry, Distribution, Float[Array, "k n"]]
"""Output of a network: the next recurrent state, the policy, the value; axes time, batch."""


def dense(features: int, *, gain: float = 2**0.5, name: str | None = None) -> nn.Dense:
    """Return a linear layer with orthogonal weights and zero biases.

    Args:
        features: Number of outputs.
        gain: Scale of the orthogonal matrix.
        name: Name in the parameter tree.
    """
    return linear(features, kernel_init=nn.initializers.orthogonal(gain), name=name)


class DenseAndActivation(nn.Module):
    """A linear layer followed by an activation."""

    features: int
    activation: str

    @nn.compact
    def __call__(self, x: Float[Array, "*n e"]) -> Float[Array, "*n f"]:
        """Apply both."""
        return ACTIVATIONS[self.activation](dense(self.features, name="Dense_0")(x))


@dataclasses.dataclass(frozen=True, kw_only=True)
class HeadOptions:
    """Options of the shared part; see `config.NetworkConfig`."""

    activation: str
    recurrent: bool
    actor_depth: int
    actor_width: int
    critic_depth: int
    critic_width: int


HEAD: Final = "GeneralActorCriticRNN_0"
"""Name of `ActorCriticHead` in parameter trees, kinetix-env's."""


def critic_layers(actor_depth: int, critic_depth: int) -> tuple[str, ...]:
    """Return the names of the head's layers of which the value alone is computed.

    Args:
        actor_depth: Hidden layers of the policy.
        critic_depth: Hidden layers of the value; they are numbered on from the policy's.
    """
    hidden = range(actor_depth, actor_depth + critic_depth)
    return (*(f"DenseAndActivation_{index}" for index in hidden), "Dense_1")


class ActorCriticHead(nn.Module):
    """Optional GRU, then a stack of layers for the policy and one for the value.

    In parameter trees it is called `HEAD`.
    """

    options: HeadOptions
    head: ActionHead

    @nn.compact
    def __call__(
        self,
        carry: Carry,
        embeddings: tuple[Float[Array, "k n e"], ...],
        dones: Bool[Array, "k n"],
    ) -> Output:
        """Return the policy and the value.

        Args:
            carry: Recurrent state before the first step.
            embeddings: One embedding for both, or one for the actor and one for the critic.
            dones: Where true, the recurrent state is zeroed before that step.
        """
        options = self.options
        if options.recurrent:
            carry, embeddings = self._remember(carry, embeddings, dones)
        actor, critic = embeddings[0], embeddings[-1]
        for index in range(options.actor_depth):
            name = f"DenseAndActivation_{index}"
            actor = DenseAndActivation(options.actor_width, options.activation, name=name)(actor)
        *hidden, last = critic_layers(options.actor_depth, options.critic_depth)
        for name in hidden:
            critic = DenseAndActivation(options.critic_width, options.activation, name=name)(critic)
        # A small last layer: the first policy is close to uniform.
        logits = dense(self.head.dimension, gain=0.01, name="Dense_0")(actor)
        value = dense(1, gain=1.0, name=last)(critic)
        log_std = None
        if self.head.needs_log_std:
            log_std = self.param("log_std", nn.initializers.zeros, (self.head.dimension,))
        return carry, self.head(logits, log_std), jnp.squeeze(value, axis=-1)

    def _remember(
        self, carry: Carry, embeddings: tuple[Array, ...], dones: Array
    ) -> tuple[Carry, tuple[Array, ...]]:
        carries, outputs = list(carry), []
        for index, embedding in enumerate(embeddings):
            memory = ScannedRNN(name=f"ScannedRNN_{index}")
            carries[index], output = memory(carries[index], (embedding, dones))
            outputs.append(output)
        return (carries[0], carries[1]), tuple(outputs)
