"""The rows of the flat form as a matrix."""

import dataclasses
from typing import ClassVar

import jax.numpy as jnp
from jaxtyping import Array, Float

from kinetix.environment.observations.base import AbstractObservation
from kinetix.environment.observations.features import KINDS, Feature
from kinetix.environment.observations.flat import BOUND, bounded
from kinetix.environment.observations.rows import flat_rows, gravity_feature
from kinetix.environment.spaces import Box
from kinetix.environment.state import EnvState


@dataclasses.dataclass(frozen=True, kw_only=True)
class FlatPaddedObservations(AbstractObservation):
    """One row an entity, padded to the widest, then a one-hot of the kind and gravity.

    There is no mask: the rows of inactive entities still carry kind and gravity.
    """

    name: ClassVar[str] = "symbolic_flat_padded"

    @property
    def space(self) -> Box:
        """A matrix between −10 and 10."""
        capacity = self.layout.capacity
        rows = (
            len(self.layout.flat_polygons) + capacity.circles + capacity.joints + capacity.thrusters
        )
        width = self.layout.padded_width + len(KINDS) + 1
        return Box(low=-BOUND, high=BOUND, shape=(rows, width))

    @property
    def columns(self) -> dict[str, tuple[Feature, ...]]:
        """The columns of every kind of row, padding and the common last five included."""
        layout = self.layout
        rows = (layout.polygon, layout.circle, layout.flat_joint, layout.flat_thruster)
        kinds = tuple(Feature(name=f"is_{kind}", meaning="one-hot kind of row") for kind in KINDS)
        padding = Feature(name="padding", meaning="the constant 0")
        return {
            kind: (*row, *((padding,) * (layout.padded_width - len(row))), *kinds, layout.gravity)
            for kind, row in zip(KINDS, rows, strict=True)
        }

    def __call__(self, state: EnvState) -> Float[Array, "e f"]:
        """Return the matrix: polygons, circles, joints, thrusters."""
        width = self.layout.padded_width
        groups = []
        for kind, rows in enumerate(flat_rows(state, self.layout)):
            count = rows.shape[0]
            is_kind = jnp.broadcast_to(jnp.arange(len(KINDS)) == kind, (count, len(KINDS)))
            gravity = jnp.broadcast_to(gravity_feature(state), (count, 1))
            padding = jnp.zeros((count, width - rows.shape[1]), rows.dtype)
            groups.append(
                jnp.concatenate([rows, padding, is_kind.astype(jnp.float32), gravity], axis=1)
            )
        return bounded(jnp.concatenate(groups))
