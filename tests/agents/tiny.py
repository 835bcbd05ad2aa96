"""A network that is small enough for tests of files."""

from kinetix.agents.networks.config import NetworkConfig

NETWORK = NetworkConfig(
    actor_depth=1,
    critic_depth=1,
    actor_width=8,
    critic_width=8,
    transformer_size=8,
    transformer_encoder_size=8,
    transformer_depth=1,
)
