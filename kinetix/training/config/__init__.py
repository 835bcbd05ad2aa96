"""All hyper-parameters, as plain frozen values free of JAX: an algorithm's in a file each.

The names are those of the published configurations; the defaults are those of kinetix-env 3.0.0,
except that `parity` is off (see `presets/kinetix-3.toml`).
"""

from kinetix.training.config.algorithms import ALGORITHM_DEFAULTS, CONFIGS, algorithm_of
from kinetix.training.config.bc import BcConfig
from kinetix.training.config.ppo import RESUMABLE, ActionName, PpoConfig
from kinetix.training.config.replay import ReplayConfig, ScoreFunction
from kinetix.training.config.sfl import SflConfig

__all__ = [
    "ALGORITHM_DEFAULTS",
    "CONFIGS",
    "RESUMABLE",
    "ActionName",
    "BcConfig",
    "PpoConfig",
    "ReplayConfig",
    "ScoreFunction",
    "SflConfig",
    "algorithm_of",
]
