"""Configuration of each algorithm."""

from kinetix.training.config.bc import BcConfig
from kinetix.training.config.ppo import PpoConfig
from kinetix.training.config.replay import ReplayConfig
from kinetix.training.config.sfl import SflConfig

CONFIGS: dict[str, type[PpoConfig]] = {
    "bc": BcConfig,
    "ppo": PpoConfig,
    "sfl": SflConfig,
    "plr": ReplayConfig,
    "accel": ReplayConfig,
    "dr": ReplayConfig,
}
"""The kind of configuration that each algorithm takes."""

ALGORITHM_DEFAULTS: dict[str, dict[str, object]] = {
    "accel": {"use_accel": True, "num_edits": 5},
    "dr": {"replay_prob": 0.0},
}
"""Settings in which algorithms that share a kind of configuration differ."""


def algorithm_of(config: PpoConfig) -> str:
    """Return the name of the algorithm that a configuration is for."""
    if isinstance(config, SflConfig):
        return "sfl"
    if isinstance(config, BcConfig):
        return "bc"
    if isinstance(config, ReplayConfig):
        if config.use_accel:
            return "accel"
        return "plr" if config.replay_prob else "dr"
    return "ppo"
