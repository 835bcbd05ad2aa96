"""Memory that a training needs, and the number of environments that fit."""

import dataclasses
from typing import Any

import jax
import numpy as np

from kinetix.memory import available_memory
from kinetix.training.config import PpoConfig
from kinetix.training.ppo.rollout import begin, rollout
from kinetix.training.setup import Setup

_COPIES = 2.5
"""A rollout, its shuffled copy and one minibatch's activations, measured in rollouts."""


@dataclasses.dataclass(frozen=True, kw_only=True)
class MemoryNeed:
    """Estimates, in bytes."""

    per_environment: int
    available: int

    @property
    def largest_num_train_envs(self) -> int:
        """The largest power of two of environments that fits."""
        fitting = max(self.available // max(self.per_environment, 1), 1)
        return 1 << (int(fitting).bit_length() - 1)


def estimate(setup: Setup) -> MemoryNeed:
    """Count the bytes of one environment’s state and rollout, without playing any.

    Args:
        setup: The training.
    """
    config: PpoConfig = setup.config
    devices = jax.device_count()

    def play(key: jax.Array) -> Any:
        learner = setup.start_learner(key, None)
        playing = begin(setup.game, key, devices)
        return rollout(setup.game, learner.params, playing, key, config.num_steps)

    playing, played = jax.eval_shape(play, jax.random.PRNGKey(0))
    per_environment = (_bytes(playing) + int(_COPIES * _bytes(played))) // devices
    return MemoryNeed(per_environment=per_environment, available=_available())


def _bytes(tree: Any) -> int:
    return sum(int(np.prod(x.shape)) * x.dtype.itemsize for x in jax.tree.leaves(tree))


def _available() -> int:
    """Return the memory of the first device, or of the machine if that is the CPU."""
    statistics = jax.local_devices()[0].memory_stats() or {}
    limit = statistics.get("bytes_limit")
    if limit is not None:
        return int(limit) - int(statistics.get("bytes_in_use", 0))
    return available_memory()
