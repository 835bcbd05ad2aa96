"""The part of the world in a picture. Centre and zoom are traced: panning compiles nothing."""

import jax.numpy as jnp
from jaxtyping import Array, Float

from kinetix.pytree import pytree

ARENA_SIZE = (5.0, 5.0)
"""Width and height of the playable square [m]; its lower left corner is the origin."""


@pytree
class Camera:
    """An upright view of the world."""

    centre: Float[Array, "2"]
    """World point in the middle of the picture [m]."""
    pixels_per_metre: Float[Array, ""]
    """Zoom [px/m]."""


def fit_arena(width: int, height: int, margin: float = 0.0) -> Camera:
    """Return the camera that shows the whole playable square as large as possible.

    Args:
        width: Width of the picture [px].
        height: Height of the picture [px].
        margin: Free border round the square [m].
    """
    scale = min(width / (ARENA_SIZE[0] + 2 * margin), height / (ARENA_SIZE[1] + 2 * margin))
    return Camera(
        centre=jnp.array([side / 2 for side in ARENA_SIZE], jnp.float32),
        pixels_per_metre=jnp.array(scale, jnp.float32),
    )


def to_pixels(
    point: Float[Array, "*s 2"], camera: Camera, width: int, height: int
) -> Float[Array, "*s 2"]:
    """World points [m] in pixels: x to the right, y down, the corner of the picture at (0, 0)."""
    from_centre = (point - camera.centre) * camera.pixels_per_metre
    return jnp.stack([width / 2 + from_centre[..., 0], height / 2 - from_centre[..., 1]], axis=-1)


def to_world(
    pixel: Float[Array, "*s 2"], camera: Camera, width: int, height: int
) -> Float[Array, "*s 2"]:
    """Return the place in the world of a pixel; the inverse of `to_pixels`."""
    from_centre = jnp.stack([pixel[..., 0] - width / 2, height / 2 - pixel[..., 1]], axis=-1)
    return from_centre / camera.pixels_per_metre + camera.centre


__all__ = ["ARENA_SIZE", "Camera", "fit_arena", "to_pixels", "to_world"]
