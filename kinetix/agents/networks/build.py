"""From a configuration to a network."""

from flax import linen as nn

from kinetix.agents.networks.config import NetworkConfig
from kinetix.agents.networks.distributions import ActionHead
from kinetix.agents.networks.heads import HeadOptions
from kinetix.agents.networks.mlp import FlatNetwork, PermutationInvariantNetwork
from kinetix.agents.networks.pixels import PixelNetwork
from kinetix.agents.networks.relational import RelationalNetwork
from kinetix.agents.networks.transformer import EntityTransformer, LayerOptions


def build_network(config: NetworkConfig, head: ActionHead) -> nn.Module:
    """Make the network.

    Args:
        config: Its kind and options.
        head: The head of the actor (`distributions.action_head`).

    Returns:
        A module with `module.apply(params, carry, (observation, dones), train=False)` →
        (carry, distribution, value); observation and dones have the leading axes time and batch.
    """
    return _BUILDERS[config.kind](config, head)


def _shared(config: NetworkConfig) -> HeadOptions:
    return HeadOptions(
        activation=config.activation,
        recurrent=config.recurrent_model,
        actor_depth=config.actor_depth,
        actor_width=config.actor_width,
        critic_depth=config.critic_depth,
        critic_width=config.critic_width,
    )


def _transformer(config: NetworkConfig, head: ActionHead) -> nn.Module:
    layers = LayerOptions(
        depth=config.transformer_depth,
        size=config.transformer_size,
        num_heads=config.num_heads,
        ffn=config.transformer_ffn,
        dropout=config.dropout_prob,
        mixing=config.multilayer_joint_thruster_mixing,
        mixing_layers=config.joint_thruster_block_num_layers,
        mixing_multiplication=config.joint_thruster_block_hidden_dim_multiplication,
    )
    return EntityTransformer(
        activation=config.activation,
        encoder_size=config.transformer_encoder_size,
        full_attention_mask=config.full_attention_mask,
        aggregate_mode=config.aggregate_mode,
        legacy_entity_id=config.legacy_entity_id,
        layers=layers,
        shared=_shared(config),
        head=head,
    )


def _invariant(config: NetworkConfig, head: ActionHead) -> nn.Module:
    return PermutationInvariantNetwork(
        activation=config.activation,
        num_heads=config.num_heads,
        embedding_size=config.symbolic_embedding_dim,
        encoder_size=config.encoder_size,
        separate=config.separate_actor_critic,
        shared=_shared(config),
        head=head,
    )


def _relational(config: NetworkConfig, head: ActionHead) -> nn.Module:
    return RelationalNetwork(
        width=config.encoder_size,
        rounds=config.message_rounds,
        shared=_shared(config),
        head=head,
    )


def _flat(config: NetworkConfig, head: ActionHead) -> nn.Module:
    return FlatNetwork(width=config.actor_width, shared=_shared(config), head=head)


def _pixels(config: NetworkConfig, head: ActionHead) -> nn.Module:
    return PixelNetwork(mode=config.cnn_mode, shared=_shared(config), head=head)


_BUILDERS = {
    "entity_transformer": _transformer,
    "relational": _relational,
    "permutation_invariant_mlp": _invariant,
    "flat_mlp": _flat,
    "cnn": _pixels,
}
