"""Networks without attention: the flat one and the permutation-invariant one."""

from typing import Any

import jax
import jax.numpy as jnp
from flax import linen as nn
from flax.typing import Initializer
from jaxtyping import Array, Bool, Float

from kinetix.agents.networks.config import KINDS_OF_ROWS
from kinetix.agents.networks.distributions import ActionHead
from kinetix.agents.networks.heads import (
    ACTIVATIONS,
    HEAD,
    ActorCriticHead,
    HeadOptions,
    Output,
    dense,
)
from kinetix.agents.networks.recurrent import Carry


class FlatNetwork(nn.Module):
    """One layer over a flat observation, then the shared head."""

    width: int
    shared: HeadOptions
    head: ActionHead

    @nn.compact
    def __call__(
        self,
        carry: Carry,
        inputs: tuple[Float[Array, "k n f"], Bool[Array, "k n"]],
        *,
        train: bool = False,
    ) -> Output:
        """See `heads.ActorCriticHead`; `train` changes nothing here."""
        del train
        observation, dones = inputs
        # relu whatever the activation of the rest: so published networks were trained.
        embedding = jax.nn.relu(dense(self.width, name="Dense_0")(observation))
        shared = ActorCriticHead(self.shared, self.head, name=HEAD)
        return shared(carry, (embedding,), dones)


class MultiHeadDense(nn.Module):
    """Several linear layers with relu over every row, summed over the rows."""

    num_heads: int
    out_dim: int
    kernel_init: Initializer = nn.initializers.lecun_normal(batch_axis=0)
    bias_init: Initializer = nn.initializers.zeros

    @nn.compact
    def __call__(self, rows: Float[Array, "*n e f"]) -> Float[Array, "*n g"]:
        """Heads side by side on the last axis. A zero row still contributes relu(bias)."""
        shape = (self.num_heads, rows.shape[-1], self.out_dim)
        kernels = self.param("dense_kernels", self.kernel_init, shape)
        biases = self.param("dense_biases", self.bias_init, shape[::2])
        # One matrix product over all heads; the heads' outputs end up side by side.
        flat = jnp.moveaxis(kernels, 0, 1).reshape(shape[1], -1)
        return jnp.sum(jax.nn.relu(rows @ flat + biases.reshape(-1)), axis=-2)


class PermutationInvariantNetwork(nn.Module):
    """Rows of entities, a shared layer over each, a sum over all, then the shared head.

    Reads `symbolic_entity` (rows are encoded first) and `symbolic_flat_padded` (rows as they are).
    """

    activation: str
    num_heads: int
    embedding_size: int
    encoder_size: int
    separate: bool
    shared: HeadOptions
    head: ActionHead

    @nn.compact
    def __call__(
        self, carry: Carry, inputs: tuple[Any, Bool[Array, "k n"]], *, train: bool = False
    ) -> Output:
        """See `heads.ActorCriticHead`; `train` changes nothing here."""
        del train
        observation, dones = inputs
        rows = self._encode(observation) if hasattr(observation, "circles") else observation
        activation = ACTIVATIONS[self.activation]
        features = self.embedding_size // self.num_heads
        embeddings = tuple(
            activation(MultiHeadDense(self.num_heads, features, name=f"MultiHeadDense_{i}")(rows))
            for i in range(2 if self.separate else 1)
        )
        shared = ActorCriticHead(self.shared, self.head, name=HEAD)
        return shared(carry, embeddings, dones)

    def _encode(self, observation: Any) -> Float[Array, "k n e f"]:
        """Return rows of one width: polygons, circles, joints, thrusters; masked rows are zero."""
        activation = ACTIVATIONS[self.activation]
        encoded = []
        for kind, (values, mask) in enumerate(
            (
                (observation.circles, observation.circle_mask),
                (observation.polygons, observation.polygon_mask),
                (observation.joints, observation.joint_mask),
                (observation.thrusters, observation.thruster_mask),
            )
        ):
            row = activation(dense(self.encoder_size - KINDS_OF_ROWS, name=f"Dense_{kind}")(values))
            label = jnp.broadcast_to(jnp.eye(KINDS_OF_ROWS)[kind], (*row.shape[:-1], KINDS_OF_ROWS))
            row = jnp.concatenate([row, label], axis=-1)
            encoded.append(jnp.where(mask[..., None], row, 0.0))
        circles, polygons, joints, thrusters = encoded
        return jnp.concatenate([polygons, circles, joints, thrusters], axis=-2)
