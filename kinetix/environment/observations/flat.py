"""All entities in one vector."""

import dataclasses
from typing import ClassVar

import jax.numpy as jnp
from jaxtyping import Array, Float

from kinetix.environment.observations.base import AbstractObservation
from kinetix.environment.observations.features import Feature
from kinetix.environment.observations.rows import flat_rows, gravity_feature
from kinetix.environment.spaces import Box
from kinetix.environment.state import EnvState

BOUND = 10.0
"""The flat forms are clipped to ± this."""


def bounded(values: Array) -> Array:
    """Clipped to ± `BOUND`, and 0 for NaN."""
    return jnp.nan_to_num(jnp.clip(values, -BOUND, BOUND))


@dataclasses.dataclass(frozen=True, kw_only=True)
class FlatObservations(AbstractObservation):
    """Polygons without walls and ceiling, circles, joints, thrusters, gravity, end to end."""

    name: ClassVar[str] = "symbolic_flat"

    @property
    def space(self) -> Box:
        """A vector between −10 and 10."""
        return Box(low=-BOUND, high=BOUND, shape=(len(self.layout.flat),))

    @property
    def columns(self) -> dict[str, tuple[Feature, ...]]:
        """One array, without a name."""
        return {"": self.layout.flat}

    def __call__(self, state: EnvState) -> Float[Array, " f"]:
        """Return the vector."""
        parts = [rows.reshape(-1) for rows in flat_rows(state, self.layout)]
        return bounded(jnp.concatenate([*parts, gravity_feature(state)[None]]))
