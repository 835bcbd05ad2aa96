"""The entity transformer: bodies attend to bodies, joints and thrusters send messages.

The heads are relational: each quarter of them sees one kind of neighbour (everything, the same
jointed assembly, directly jointed bodies, bodies in contact).
"""

import dataclasses
from typing import Any

import jax
import jax.numpy as jnp
from flax import linen as nn
from jaxtyping import Array, Bool, Float

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
from kinetix.agents.networks.rows import flat, linear, rows_dot

MASK_PLANES = 4
"""Planes of the observation's attention mask."""


class Gate(nn.Module):
    """A gated residual connection, in the manner of a GRU.

    Source: Parisotto et al., "Stabilizing Transformers for Reinforcement Learning" (2019), eq. 5.
    """

    @nn.compact
    def __call__(self, x: Float[Array, "*n e"], y: Float[Array, "*n e"]) -> Float[Array, "*n e"]:
        """Blend the stream `x` with the block's output `y`."""
        shape, x, y = x.shape, flat(x), flat(y)

        def turned(index: int, value: Array) -> Array:
            return linear(x.shape[-1], use_bias=False, name=f"Dense_{index}")(value)

        bias = self.param("gating_bias", nn.initializers.zeros, (x.shape[-1],))
        reset = jax.nn.sigmoid(turned(0, y) + turned(1, x))
        update = jax.nn.sigmoid(turned(2, y) + turned(3, x) - bias)
        candidate = jnp.tanh(turned(4, y) + turned(5, reset * x))
        return ((1 - update) * x + update * candidate).reshape(shape)


@dataclasses.dataclass(frozen=True, kw_only=True)
class LayerOptions:
    """Options of the layers; see `config.NetworkConfig`."""

    depth: int
    size: int
    num_heads: int
    ffn: bool
    dropout: float
    mixing: bool
    mixing_layers: int
    mixing_multiplication: int


class TransformerLayer(nn.Module):
    """Masked self-attention and a linear (or two-layer) block, each behind a gate."""

    options: LayerOptions

    @nn.compact
    def __call__(
        self, x: Float[Array, "*n e f"], mask: Bool[Array, "*n h e e"], *, train: bool
    ) -> Float[Array, "*n e f"]:
        """Update the tokens; head `h` of token i sees token j where `mask[h, i, j]`."""
        options = self.options
        attention = nn.MultiHeadDotProductAttention(
            num_heads=options.num_heads,
            qkv_features=options.size,
            qkv_dot_general=rows_dot,
            out_dot_general=rows_dot,
            name="attention1",
        )
        # Weights are kept only for those who ask for them (`kinetix.agents.explain`).
        asked = self.is_mutable_collection("intermediates") and not self.is_initializing()
        y = attention(nn.LayerNorm(name="ln1")(x), mask=mask, sow_weights=asked)
        x = Gate(name="gate1")(x, jax.nn.relu(y))
        e = nn.LayerNorm(name="ln2")(x)
        width = x.shape[-1]
        if options.ffn:
            e = jax.nn.relu(linear(4 * width, name="dense1")(e))
            e = nn.Dropout(options.dropout, deterministic=not train)(e)
            e = linear(width, name="dense2")(e)
        else:
            e = linear(width, name="dense1")(e)
        return Gate(name="gate2")(x, jax.nn.relu(e))


class MessageBlock(nn.Module):
    """The several-layer form of a message: hidden layers with relu, then relu on the output."""

    num_layers: int
    multiplication: int
    width: int

    @nn.compact
    def __call__(self, x: Float[Array, "*n f"]) -> Float[Array, "*n e"]:
        """Return the message of each row."""
        for index in range(self.num_layers - 1):
            hidden = linear(self.multiplication * self.width, name=f"Dense_{index}")(x)
            x = jax.nn.relu(hidden)
        return jax.nn.relu(linear(self.width, name=f"Dense_{self.num_layers - 1}")(x))


class Transformer(nn.Module):
    """Layers of attention, each followed by the messages of joints and thrusters."""

    options: LayerOptions

    @nn.compact
    def __call__(
        self,
        tokens: Float[Array, "*n e f"],
        mask: Bool[Array, "*n h e e"],
        joints: "Messages",
        thrusters: "Messages",
        *,
        train: bool,
    ) -> Float[Array, "*n e f"]:
        """Update the tokens.

        Args:
            tokens: Bodies, perhaps with the dummy in front.
            mask: Who sees whom, for every head.
            joints: Embeddings of joint rows, their two bodies, their mask.
            thrusters: Embeddings of thruster rows, their body, their mask.
            train: Whether dropout acts.
        """
        width = tokens.shape[-1]
        for index in range(self.options.depth):
            layer = TransformerLayer(self.options, name=f"tf_layers_{index}")
            x = layer(tokens, mask, train=train)
            # Both kinds of message are computed from x and only then added.
            tokens = (
                x
                + joints.send(x, self._message(f"joint_layers_{index}", width))
                + thrusters.send(x, self._message(f"thruster_layers_{index}", width))
            )
        return tokens

    def _message(self, name: str, width: int) -> nn.Module:
        options = self.options
        if options.mixing:
            return MessageBlock(
                options.mixing_layers, options.mixing_multiplication, width, name=name
            )
        return linear(width, name=name)


class Messages:
    """Rows that connect bodies: their embeddings and the bodies.

    Rows find their bodies by products with one-hot matrices. There are few bodies, and neither
    gathers nor their gradients, which are scatters, run well in batches.
    """

    def __init__(
        self,
        embedding: Float[Array, "*n m f"],
        bodies: tuple[Float[Array, "*n m e"], ...],
        mask: Bool[Array, "*n m"],
    ) -> None:
        """Keep the rows.

        Args:
            embedding: Embedded features of the rows.
            bodies: One-hot rows of the bodies that a row reads; it writes to the first.
            mask: Rows that exist.
        """
        self.embedding = embedding
        self.bodies = bodies
        self.mask = mask[..., None].astype(embedding.dtype)

    def send(self, x: Float[Array, "*n e f"], message: nn.Module) -> Float[Array, "*n e f"]:
        """Return the sum of the messages that each token receives."""
        read = [body @ x for body in self.bodies]
        delta = message(jnp.concatenate([*read, self.embedding], axis=-1)) * self.mask
        return jnp.swapaxes(self.bodies[0], -1, -2) @ delta


class EntityTransformer(nn.Module):
    """Encoders, transformer, aggregation, then the shared head."""

    activation: str
    encoder_size: int
    full_attention_mask: bool
    aggregate_mode: str
    legacy_entity_id: bool
    layers: LayerOptions
    shared: HeadOptions
    head: ActionHead

    @nn.compact
    def __call__(
        self, carry: Carry, inputs: tuple[Any, Bool[Array, "k n"]], *, train: bool = False
    ) -> Output:
        """See `heads.ActorCriticHead`. The observation is a `symbolic_entity` one."""
        observation, dones = inputs
        tokens, active = self._tokens(observation)
        mask = self._mask(observation, active)
        joints, thrusters = self._messages(observation, tokens.shape[-2])
        transformer = Transformer(self.layers, name="Transformer_0")
        tokens = transformer(tokens, mask, joints, thrusters, train=train)
        if self.aggregate_mode == "dummy":
            embedding = tokens[..., 0, :]
        else:
            weight = active.astype(tokens.dtype)
            total = jnp.einsum("...e,...ef->...f", weight, tokens)
            # At least one: a scene without bodies gives zeros, not NaN.
            embedding = total / jnp.maximum(jnp.sum(weight, axis=-1, keepdims=True), 1.0)
        shared = ActorCriticHead(self.shared, self.head, name=HEAD)
        return shared(carry, (embedding,), dones)

    @property
    def _has_dummy(self) -> bool:
        return self.aggregate_mode != "mean"

    def _encode(self, values: Array, index: int, *, entity_id: float | None = None) -> Array:
        size = self.encoder_size - (entity_id is not None)
        encoded = ACTIVATIONS[self.activation](dense(size, name=f"Dense_{index}")(values))
        if entity_id is None:
            return encoded
        return jnp.pad(encoded, [(0, 0)] * (encoded.ndim - 1) + [(0, 1)], constant_values=entity_id)

    def _tokens(self, observation: Any) -> tuple[Float[Array, "*n e f"], Bool[Array, "*n e"]]:
        """Tokens [dummy, polygons, circles] and which of them are active."""
        circles = self._encode(observation.circles, 0, entity_id=0.0)
        polygon_id = 0.0 if self.legacy_entity_id else 1.0
        polygons = self._encode(observation.polygons, 1, entity_id=polygon_id)
        tokens = jnp.concatenate([polygons, circles], axis=-2)
        active = jnp.concatenate([observation.polygon_mask, observation.circle_mask], axis=-1)
        if self._has_dummy:
            front = [(0, 0)] * (active.ndim - 1) + [(1, 0)]
            tokens = jnp.pad(tokens, [*front, (0, 0)], constant_values=1.0)
            active = jnp.pad(active, front, constant_values=True)
        return tokens, active

    def _mask(self, observation: Any, active: Bool[Array, "*n e"]) -> Bool[Array, "*n h e e"]:
        """Return who attends to whom; head h uses plane ⌊4h/H⌋."""
        both = (active[..., :, None] & active[..., None, :])[..., None, :, :]
        if self.full_attention_mask:
            return both
        planes = observation.attention_mask
        if self._has_dummy:
            front = [(0, 0)] * (planes.ndim - 2) + [(1, 0), (1, 0)]
            planes = jnp.pad(planes, front, constant_values=True)
        return jnp.repeat(planes & both, self.layers.num_heads // MASK_PLANES, axis=-3)

    def _messages(self, observation: Any, tokens: int) -> tuple[Messages, Messages]:
        """Embedded joint and thruster rows; body numbers are shifted by one for the dummy."""
        shift = int(self._has_dummy)

        def one_hot(index: Array) -> Array:
            return jax.nn.one_hot(index + shift, tokens)

        pair = observation.joint_indexes
        joints = Messages(
            self._encode(observation.joints, 2),
            (one_hot(pair[..., 0]), one_hot(pair[..., 1])),
            observation.joint_mask,
        )
        thrusters = Messages(
            self._encode(observation.thrusters, 3),
            (one_hot(observation.thruster_indexes),),
            observation.thruster_mask,
        )
        return joints, thrusters
