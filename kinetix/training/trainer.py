"""The interface of training algorithms, and the algorithm of a configuration."""

from collections.abc import Mapping
from typing import Any, Protocol

from kinetix.agents.agent import Agent
from kinetix.training.config import BcConfig, PpoConfig, ReplayConfig, SflConfig
from kinetix.training.curricula.replay import Replay
from kinetix.training.curricula.sfl import Sfl
from kinetix.training.imitation.clone import Clone
from kinetix.training.ppo.train import Ppo
from kinetix.training.setup import Setup
from kinetix.training.work import Work


class Trainer(Protocol):
    """An algorithm: a state and a function that improves it."""

    @property
    def setup(self) -> Setup:
        """Environment, network, optimiser."""
        ...

    @property
    def work(self) -> Work:
        """Runs and times the parts of updates."""
        ...

    @property
    def parts_per_update(self) -> Mapping[str, float]:
        """Mean number of parts of each name in an update."""
        ...

    def start(self) -> Any:
        """Return the state before the first update."""
        ...

    def update(self, state: Any) -> tuple[Any, Mapping[str, Any]]:
        """Return the next state, and metrics."""
        ...


def make_trainer(config: PpoConfig, teacher: Agent | None = None) -> Trainer:
    """Return the algorithm that a configuration is for.

    Args:
        config: The configuration, already checked.
        teacher: The agent to start from.
    """
    if isinstance(config, BcConfig):
        return Clone(config, teacher)
    if isinstance(config, SflConfig):
        return Sfl(config, teacher)
    if isinstance(config, ReplayConfig):
        return Replay(config, teacher)
    return Ppo(config, teacher)
