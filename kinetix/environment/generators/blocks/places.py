"""Places on bodies that are there: where a joint or a thruster is attached."""

import jax.numpy as jnp
from jaxtyping import Array, Float, Int

from kinetix.environment.generators.draws import between
from kinetix.environment.generators.figures import Figures, bounds, pick


def place_within(
    figures: Figures, u: Float[Array, "q n"], v: Float[Array, "q n"], *, triangles: bool
) -> Float[Array, "q 2 n"]:
    """Return a place uniform in a polygon; the centre of a circle [m, body's frame]."""
    low, high = bounds(figures)
    place = jnp.stack(
        [
            between(u, low[..., 0, :], high[..., 0, :]),
            between(v, low[..., 1, :], high[..., 1, :]),
        ],
        axis=-2,
    )
    if triangles:
        # Folding the unit square along its diagonal keeps the density uniform.
        outside = u + v > 1
        s = jnp.where(outside, 1 - u, u)[..., None, :]
        t = jnp.where(outside, 1 - v, v)[..., None, :]
        first, second, third = (figures.vertices[..., k, :, :] for k in range(3))
        within = first + s * (second - first) + t * (third - first)
        place = jnp.where((figures.vertex_count == 3)[..., None, :], within, place)
    return jnp.where(figures.circle[..., None, :], 0.0, place)


def pick_figures(figures: Figures, index: Int[Array, "q n"]) -> Figures:
    """Return the bodies of these rows, one a proposal."""
    return Figures(
        **{name: pick(getattr(figures, name), index) for name in figures.__dataclass_fields__}
    )
