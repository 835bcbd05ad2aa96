"""The contract of every kind of observation."""

import abc
import dataclasses
from typing import Any, ClassVar

from kinetix.environment.observations.features import Feature, Layout
from kinetix.environment.params import EnvParams
from kinetix.environment.spaces import Space
from kinetix.environment.state import EnvState


@dataclasses.dataclass(frozen=True, kw_only=True)
class AbstractObservation(abc.ABC):
    """Observation of a state: a hashable value that is called on states.

    Observations are written for one world; the environment batches them with the worlds on the last
    axis (unless `worlds_last` says otherwise), so elementwise operations, slices and concatenations
    are cheap and gathers are not.
    """

    name: ClassVar[str]
    worlds_last: ClassVar[bool] = True
    """True if a batch is observed with the worlds on the last axis. Pictures are not: each fills
    the cache by itself, and they have a batched form of their own under `vmap`."""

    layout: Layout

    @property
    def value(self) -> str:
        """Its name, as that of the equal `ObservationType`."""
        return self.name

    def get_obs(self, state: EnvState) -> Any:
        """Return the observation of one state: what calling returns, by kinetix-env's name."""
        return self(state)

    def observation_space(self, env_params: EnvParams | None = None) -> Space:
        """Return `space`, by kinetix-env's name."""
        del env_params
        return self.space

    def hash_key(self) -> int:
        """Return a number that equal observations share."""
        return hash(self)

    @property
    @abc.abstractmethod
    def space(self) -> Space:
        """Exactly what calling returns."""

    @property
    @abc.abstractmethod
    def columns(self) -> dict[str, tuple[Feature, ...]]:
        """The meaning of the last axis of every array with named columns, by the array's name."""

    @abc.abstractmethod
    def __call__(self, state: EnvState) -> Any:
        """Return the observation of one state."""
