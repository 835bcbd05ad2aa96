"""Plane vectors whose components are arrays of any broadcastable shape, worlds last."""

import jax.numpy as jnp
from jaxtyping import Array, Float, Shaped

from kinetix.pytree import pytree

Scalar = Float[Array, "..."] | float


@pytree
class Vec:
    """A plane vector: two arrays of one shape. Kernels read like formulas with it."""

    x: Shaped[Array, "..."]
    y: Shaped[Array, "..."]

    def __add__(self, other: "Vec") -> "Vec":
        return Vec(x=self.x + other.x, y=self.y + other.y)

    def __sub__(self, other: "Vec") -> "Vec":
        return Vec(x=self.x - other.x, y=self.y - other.y)

    def __neg__(self) -> "Vec":
        return Vec(x=-self.x, y=-self.y)

    def __mul__(self, scale: Scalar) -> "Vec":
        return Vec(x=self.x * scale, y=self.y * scale)

    def __truediv__(self, scale: Scalar) -> "Vec":
        return Vec(x=self.x / scale, y=self.y / scale)

    def __getitem__(self, index: object) -> "Vec":
        return Vec(x=self.x[index], y=self.y[index])


def vec(array: Float[Array, "rows 2 *n"]) -> Vec:
    """Split an array whose second axis is (x, y) into its components."""
    return Vec(x=array[:, 0], y=array[:, 1])


def unvec(v: Vec) -> Float[Array, "rows 2 *n"]:
    """Return the array that `vec` took apart."""
    return jnp.stack([v.x, v.y], axis=1)


def dot(a: Vec, b: Vec) -> Float[Array, "..."]:
    """Return the scalar product."""
    return a.x * b.x + a.y * b.y


def cross(a: Vec, b: Vec) -> Float[Array, "..."]:
    """Return the out-of-plane component of a × b: a_x b_y − a_y b_x."""
    return a.x * b.y - a.y * b.x


def spin(omega: Scalar, r: Vec) -> Vec:
    """ω × r: the velocity of a point at r on a body that turns with ω."""
    return Vec(x=-omega * r.y, y=omega * r.x)


def rotate(cos: Scalar, sin: Scalar, v: Vec) -> Vec:
    """Turn a vector by the angle with this cosine and sine."""
    return Vec(x=cos * v.x - sin * v.y, y=sin * v.x + cos * v.y)


def length(v: Vec) -> Float[Array, "..."]:
    """Return the Euclidean length."""
    return jnp.sqrt(dot(v, v))


def where(condition: Shaped[Array, "..."], a: Vec, b: Vec) -> Vec:
    """Choose by component."""
    return Vec(x=jnp.where(condition, a.x, b.x), y=jnp.where(condition, a.y, b.y))


def nonzero(x: Float[Array, "..."]) -> Float[Array, "..."]:
    """Return the same, with exact zeros replaced by 1, for use as a denominator."""
    return jnp.where(x == 0, 1, x)
