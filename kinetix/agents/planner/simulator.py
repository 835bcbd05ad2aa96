"""The observation of a planner: the simulator itself, in the state that the episode is in."""

import dataclasses
from typing import ClassVar

from kinetix.environment.env import KinetixEnv
from kinetix.environment.observations import AbstractObservation
from kinetix.environment.observations.features import Feature
from kinetix.environment.params import EnvParams, StaticEnvParams
from kinetix.environment.replay import playing_env
from kinetix.environment.spaces import Dict
from kinetix.environment.state import EnvState
from kinetix.pytree import pytree, static


@pytree
class Simulator:
    """A state and everything that is needed to play on from it."""

    state: EnvState
    static_env_params: StaticEnvParams = static()
    env_params: EnvParams = static()

    @property
    def env(self) -> KinetixEnv:
        """Environment in which futures are played: episodes end there, and nothing is observed."""
        return playing_env(self.static_env_params, self.env_params)


@dataclasses.dataclass(frozen=True, kw_only=True)
class SimulatorObservations(AbstractObservation):
    """The simulator itself: not an observation to learn from."""

    name: ClassVar[str] = "simulator"
    worlds_last: ClassVar[bool] = False

    @property
    def space(self) -> Dict:
        """Nothing: a state is no vector."""
        return Dict(spaces={})

    @property
    def columns(self) -> dict[str, tuple[Feature, ...]]:
        """Nothing that is named."""
        return {}

    def __call__(self, state: EnvState) -> Simulator:
        """Return the simulator in this state."""
        layout = self.layout
        return Simulator(
            state=state,
            static_env_params=layout.static_env_params,
            env_params=layout.env_params,
        )
