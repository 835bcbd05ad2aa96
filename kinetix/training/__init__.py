"""Headless training: PPO, and the curricula SFL, PLR, ACCEL and DR around it (docs/training.md).

`kinetix.training.train("ppo", "runs/mine", levels=("s/goalkeeper",))` returns the trained agent.
"""

from typing import TYPE_CHECKING

from kinetix.lazy import lazy_names

if TYPE_CHECKING:
    from kinetix.training.settings import make_config
    from kinetix.training.start import train

_HOME = {"make_config": "kinetix.training.settings", "train": "kinetix.training.start"}

__all__ = ["make_config", "train"]

__getattr__, __dir__ = lazy_names(__name__, _HOME)
