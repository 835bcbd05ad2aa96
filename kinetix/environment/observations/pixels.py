"""A picture."""

import dataclasses
from typing import ClassVar, NamedTuple

import jax.numpy as jnp
from jaxtyping import Array, Float

from kinetix.environment.observations.base import AbstractObservation
from kinetix.environment.observations.features import Feature
from kinetix.environment.observations.rows import GRAVITY_SCALE, gravity_feature
from kinetix.environment.spaces import Box, Dict
from kinetix.environment.state import EnvState
from kinetix.render.pixels import make_render_pixels_rl

MAX_GRAVITY = 100.0
"""Largest gravity that a level can have [m/s²]."""


class PixelObservation(NamedTuple):
    """Observation of `PixelObservations`."""

    image: Float[Array, "w h 3"]
    """0 … 1, axes x, y, channel, y up; show it with `transpose(1, 0, 2)[::-1]`."""
    global_info: Float[Array, " 1"]
    """Vertical gravity / 10."""


@dataclasses.dataclass(frozen=True, kw_only=True)
class PixelObservations(AbstractObservation):
    """The picture of the level, `screen_dim // downscale` pixels, one frame."""

    name: ClassVar[str] = "pixels"
    worlds_last: ClassVar[bool] = False

    @property
    def space(self) -> Dict:
        """Image and gravity."""
        static = self.layout.static_env_params
        width, height = (side // static.downscale for side in static.screen_dim)
        bound = MAX_GRAVITY / GRAVITY_SCALE
        return Dict(
            spaces={
                "image": Box(low=0.0, high=1.0, shape=(width, height, 3)),
                "global_info": Box(low=-bound, high=bound, shape=(1,)),
            }
        )

    @property
    def columns(self) -> dict[str, tuple[Feature, ...]]:
        """Colour channels, and gravity."""
        channels = tuple(Feature(name=name) for name in ("red", "green", "blue"))
        return {"image": channels, "global_info": (self.layout.gravity,)}

    def __call__(self, state: EnvState) -> PixelObservation:
        """Return the picture of one state."""
        render = make_render_pixels_rl(self.layout.env_params, self.layout.static_env_params)
        return PixelObservation(
            image=render(state),
            global_info=jnp.nan_to_num(gravity_feature(state)[None]),
        )
