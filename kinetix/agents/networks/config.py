"""Configuration of a network: plain numbers and names, free of JAX."""

import dataclasses
from typing import Literal, get_args

Kind = Literal["entity_transformer", "relational", "permutation_invariant_mlp", "flat_mlp", "cnn"]
Activation = Literal["tanh", "relu"]
AggregateMode = Literal["dummy_and_mean", "dummy", "mean"]
CnnMode = Literal["impala_fast", "resnet_18"]

OBSERVATIONS_OF_KIND: dict[str, tuple[str, ...]] = {
    "entity_transformer": ("symbolic_entity",),
    "relational": ("symbolic_entity",),
    "permutation_invariant_mlp": ("symbolic_entity", "symbolic_flat_padded"),
    "flat_mlp": ("symbolic_flat", "blind"),
    "cnn": ("pixels",),
}
"""The observations that each kind of network can read; the first is its usual one."""

_LARGEST_WIDTH = 65_536
"""Widths beyond this are a damaged file, not a network; refused before anything is allocated."""
_LARGEST_DEPTH = 256
"""The same for numbers of layers."""
KINDS_OF_ROWS = 4
"""Circle, polygon, joint, thruster: the one-hot columns of an encoded row of the invariant
network."""


@dataclasses.dataclass(frozen=True, kw_only=True)
class NetworkConfig:
    """A network's kind and options; the option names are those of published configurations.

    Options that do not belong to the kind are carried along and ignored.
    """

    kind: Kind = "entity_transformer"
    """Kind of network."""
    activation: Activation = "tanh"
    """Activation of encoders and heads."""
    recurrent_model: bool = False
    """True if a GRU stands between the embedding and the heads."""
    actor_depth: int = 5
    """Hidden layers of the actor."""
    critic_depth: int = 5
    """Hidden layers of the critic."""
    actor_width: int = 128
    """Units in each hidden layer of the actor."""
    critic_width: int = 128
    """Units in each hidden layer of the critic."""
    transformer_depth: int = 2
    """Transformer layers."""
    transformer_size: int = 16
    """Query, key and value features over all heads together."""
    transformer_encoder_size: int = 128
    """Width of a token."""
    num_heads: int = 8
    """Attention heads (a multiple of 4 in the transformer); heads of the invariant network."""
    full_attention_mask: bool = False
    """Let every head attend to every active body instead of four kinds of neighbour."""
    aggregate_mode: AggregateMode = "dummy_and_mean"
    """Reduction of the tokens to one embedding."""
    transformer_ffn: bool = False
    """A two-layer block after the attention instead of one linear layer."""
    multilayer_joint_thruster_mixing: bool = False
    """Several layers instead of one in the messages of joints and thrusters."""
    joint_thruster_block_num_layers: int = 2
    """Layers of such a message block."""
    joint_thruster_block_hidden_dim_multiplication: int = 4
    """Hidden width of such a block, in tokens' widths."""
    dropout_prob: float = 0.0
    """Dropout inside the two-layer block."""
    legacy_entity_id: bool = False
    """Paper-time networks gave circles and polygons the same constant; true keeps that."""
    symbolic_embedding_dim: int = 256
    """Embedding width of the invariant network."""
    encoder_size: int = 64
    """Width of an encoded row (relational network; invariant network, four columns included)."""
    message_rounds: int = 1
    """Rounds of messages along joints (relational network)."""
    separate_actor_critic: bool = False
    """Two embeddings, one for the actor and one for the critic (invariant network)."""
    cnn_mode: CnnMode = "impala_fast"
    """Convolutional encoder."""

    def __post_init__(self) -> None:
        """Refuse what no network can be built from.

        Raises:
            ValueError: An option is outside its range; the message names it.
        """
        for name, allowed in (
            ("kind", get_args(Kind)),
            ("activation", get_args(Activation)),
            ("aggregate_mode", get_args(AggregateMode)),
            ("cnn_mode", get_args(CnnMode)),
        ):
            value = getattr(self, name)
            if value not in allowed:
                raise ValueError(f"{name}: expected one of {', '.join(allowed)}, got {value!r}")
        for field in dataclasses.fields(self):
            value = getattr(self, field.name)
            if field.type is bool and not isinstance(value, bool):
                raise ValueError(f"{field.name}: expected true or false, got {value!r}")
            if field.type is int:
                _check_integer(field.name, value)
        if not isinstance(self.dropout_prob, (int, float)) or not 0 <= self.dropout_prob < 1:
            raise ValueError(f"dropout_prob: expected 0 ≤ x < 1, got {self.dropout_prob!r}")
        if self.kind == "permutation_invariant_mlp" and self.encoder_size <= KINDS_OF_ROWS:
            raise ValueError(
                f"encoder_size: expected more than {KINDS_OF_ROWS}, as many columns tell the kinds "
                f"of rows apart, got {self.encoder_size}"
            )
        self._check_heads()

    def _check_heads(self) -> None:
        divisors = {
            "entity_transformer": (("num_heads", 4), ("transformer_size", self.num_heads)),
            "permutation_invariant_mlp": (("symbolic_embedding_dim", self.num_heads),),
        }
        for name, divisor in divisors.get(self.kind, ()):
            value = getattr(self, name)
            if value % divisor:
                why = "4 kinds of neighbour" if divisor == 4 else f"num_heads = {divisor}"
                raise ValueError(f"{name}: expected a multiple of {divisor} ({why}), got {value}")


def _check_integer(name: str, value: object) -> None:
    is_depth = name.endswith(("depth", "num_layers", "multiplication"))
    least, most = (0, _LARGEST_DEPTH) if is_depth else (1, _LARGEST_WIDTH)
    if isinstance(value, bool) or not isinstance(value, int) or not least <= value <= most:
        raise ValueError(f"{name}: expected a whole number from {least} to {most}, got {value!r}")


NETWORK_PRESETS: dict[str, NetworkConfig] = {
    "tf-paper": NetworkConfig(),
    "tf-s": NetworkConfig(
        actor_depth=3,
        critic_depth=3,
        actor_width=256,
        critic_width=256,
        transformer_size=32,
        transformer_ffn=True,
        multilayer_joint_thruster_mixing=True,
    ),
    "tf-m": NetworkConfig(
        actor_depth=1,
        critic_depth=1,
        actor_width=256,
        critic_width=256,
        transformer_depth=3,
        transformer_size=128,
        transformer_encoder_size=512,
        transformer_ffn=True,
        multilayer_joint_thruster_mixing=True,
    ),
    "tf-l": NetworkConfig(
        actor_depth=1,
        critic_depth=1,
        actor_width=512,
        critic_width=512,
        transformer_depth=4,
        transformer_size=256,
        transformer_encoder_size=512,
        transformer_ffn=True,
        multilayer_joint_thruster_mixing=True,
    ),
    "relational": NetworkConfig(
        kind="relational",
        activation="relu",
        actor_depth=2,
        critic_depth=2,
        actor_width=256,
        critic_width=256,
    ),
    "perm-inv": NetworkConfig(kind="permutation_invariant_mlp"),
    "flat": NetworkConfig(kind="flat_mlp"),
    "pixels": NetworkConfig(kind="cnn"),
}
"""The published networks, and ours, by names."""
