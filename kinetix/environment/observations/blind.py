"""Nothing but the time."""

import dataclasses
from typing import ClassVar

import jax.numpy as jnp
from jaxtyping import Array, Float

from kinetix.environment.observations.base import AbstractObservation
from kinetix.environment.observations.features import Feature
from kinetix.environment.spaces import Box
from kinetix.environment.state import EnvState


@dataclasses.dataclass(frozen=True, kw_only=True)
class BlindObservations(AbstractObservation):
    """One-hot of the environment step."""

    name: ClassVar[str] = "blind"

    @property
    def space(self) -> Box:
        """One entry a step, the step 0 and the last included."""
        return Box(low=0.0, high=1.0, shape=(self.layout.max_timesteps + 1,))

    @property
    def columns(self) -> dict[str, tuple[Feature, ...]]:
        """One column a step."""
        steps = range(self.layout.max_timesteps + 1)
        return {"": tuple(Feature(name=f"timestep_{step}") for step in steps)}

    def __call__(self, state: EnvState) -> Float[Array, " k"]:
        """1.0 at the index of the step."""
        index = jnp.arange(self.layout.max_timesteps + 1)
        return (index == state.timestep).astype(jnp.float32)
