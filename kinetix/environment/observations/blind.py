"""Nothing but the time."""

import dataclasses
import math
from typing import ClassVar

import jax.numpy as jnp
from jaxtyping import Array, Float

from kinetix.environment.observations.base import AbstractObservation
from kinetix.environment.observations.features import Feature
from kinetix.environment.spaces import Box
from kinetix.environment.state import EnvState
from kinetix.errors import KinetixError


@dataclasses.dataclass(frozen=True, kw_only=True)
class BlindObservations(AbstractObservation):
    """One-hot of the environment step."""

    name: ClassVar[str] = "blind"

    @property
    def _last(self) -> int:
        """The last step that has an entry.

        Raises:
            KinetixError: Episodes have no end, and no row is long enough.
        """
        if math.isinf(self.layout.max_timesteps):
            raise KinetixError(
                "observation blind, an entry per step: expected a finite EnvParams.max_timesteps"
            )
        return self.layout.max_timesteps

    @property
    def space(self) -> Box:
        """One entry a step, the step 0 and the last included."""
        return Box(low=0.0, high=1.0, shape=(self._last + 1,))

    @property
    def columns(self) -> dict[str, tuple[Feature, ...]]:
        """One column a step."""
        steps = range(self._last + 1)
        return {"": tuple(Feature(name=f"timestep_{step}") for step in steps)}

    def __call__(self, state: EnvState) -> Float[Array, " k"]:
        """1.0 at the index of the step, or at the last one where a level lasts longer."""
        step = jnp.minimum(state.timestep, self._last)
        return (jnp.arange(self._last + 1) == step).astype(jnp.float32)
