"""kinetix-env's draws of numbers and places."""

import jax
import jax.numpy as jnp
from jaxtyping import Array, Float, Int


def sample_uniform(
    rng: Array,
    minval: float | Array,
    maxval: float | Array,
    minval_exclude: float | Array | None = None,
    maxval_exclude: float | Array | None = None,
) -> Float[Array, "..."]:
    """Draw evenly between two bounds, outside of an inner interval where one is given.

    Args:
        rng: Random key.
        minval: Lower bound; arrays are drawn entry by entry.
        maxval: Upper bound.
        minval_exclude: Lower end of the interval that is left out.
        maxval_exclude: Upper end of it.
    """
    if minval_exclude is None or maxval_exclude is None:
        shape = jnp.broadcast_shapes(jnp.shape(minval), jnp.shape(maxval))
        return jax.random.uniform(rng, shape, minval=minval, maxval=maxval)
    return sample_uniform_and_exclude(rng, minval, maxval, minval_exclude, maxval_exclude)


def sample_uniform_and_exclude(
    rng: Array,
    minval: float | Array,
    maxval: float | Array,
    minval_exclude: float | Array,
    maxval_exclude: float | Array,
) -> Float[Array, "..."]:
    """Draw evenly between two bounds, outside of an inner interval; see `sample_uniform`."""
    shape = jnp.broadcast_shapes(*map(jnp.shape, (minval, maxval, minval_exclude, maxval_exclude)))
    below = jnp.asarray(minval_exclude) - minval
    drawn = jax.random.uniform(rng, shape, maxval=below + maxval - maxval_exclude)
    return jnp.where(drawn < below, minval + drawn, maxval_exclude + drawn - below)


def random_position_on_triangle(rng: Array, vertices: Float[Array, "3 2"]) -> Float[Array, "2"]:
    """Draw a place evenly over a triangle.

    Args:
        rng: Random key.
        vertices: Its corners [m]; further ones are passed over.
    """
    first, second = jax.random.uniform(rng, (2,))
    # The half of the parallelogram beyond the triangle is turned over onto it.
    over = first + second > 1.0
    first, second = jnp.where(over, 1.0 - first, first), jnp.where(over, 1.0 - second, second)
    a, b, c = vertices[0], vertices[1], vertices[2]
    return a + first * (b - a) + second * (c - a)


def random_position_on_rectangle(rng: Array, vertices: Float[Array, "4 2"]) -> Float[Array, "2"]:
    """Draw a place evenly over a rectangle that may be turned, from its corners in order [m]."""
    first, second = jax.random.uniform(rng, (2,))
    origin = vertices[0]
    return origin + first * (vertices[1] - origin) + second * (vertices[3] - origin)


def random_position_on_polygon(
    rng: Array,
    vertices: Float[Array, "v 2"],
    n_vertices: int | Int[Array, ""],
    static_env_params: object,
) -> Float[Array, "2"]:
    """Draw a place evenly over a triangle or rectangle.

    Args:
        rng: Random key.
        vertices: Corners [m]; unused ones at the end.
        n_vertices: 3 or 4.
        static_env_params: Taken for kinetix-env's sake.
    """
    del static_env_params
    triangle = random_position_on_triangle(rng, vertices)
    return jnp.where(
        jnp.asarray(n_vertices) == 3, triangle, random_position_on_rectangle(rng, vertices)
    )


def random_position_on_circle(
    rng: Array, radius: float | Array, on_centre_chance: float | Array
) -> Float[Array, "2"]:
    """Draw a place evenly over a circle about (0, 0).

    Args:
        rng: Random key.
        radius: Of the circle [m].
        on_centre_chance: Probability that it is the centre.
    """
    place_key, centre_key = jax.random.split(rng)
    share, turn = jax.random.uniform(place_key, (2,))
    angle = 2.0 * jnp.pi * turn
    place = radius * jnp.sqrt(share) * jnp.array([jnp.cos(angle), jnp.sin(angle)])
    return jnp.where(jax.random.bernoulli(centre_key, on_centre_chance), 0.0, place)
