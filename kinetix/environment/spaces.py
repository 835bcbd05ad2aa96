"""What an action or an observation can be: the two enumerations and the descriptions of sets.

The classes have the attributes that gymnax's spaces have (`n`, `shape`, `dtype`, `low`, `high`,
`sample(key)`, `contains(x)`), so that code written for those runs on these.
"""

import abc
import dataclasses
import enum
from collections.abc import Mapping
from typing import Any

import jax
import jax.numpy as jnp
import numpy as np
from jaxtyping import Array, Bool


class ActionType(enum.Enum):
    """The kinds of action; the values are the names in configurations."""

    DISCRETE = "discrete"
    CONTINUOUS = "continuous"
    MULTI_DISCRETE = "multi_discrete"


class ObservationType(enum.Enum):
    """The kinds of observation; the values are the names in configurations."""

    PIXELS = "pixels"
    SYMBOLIC_FLAT = "symbolic_flat"
    SYMBOLIC_FLAT_PADDED = "symbolic_flat_padded"
    SYMBOLIC_ENTITY = "symbolic_entity"
    BLIND = "blind"


class Space(abc.ABC):
    """A set of values of one structure."""

    @abc.abstractmethod
    def sample(self, key: Array) -> Any:
        """A value drawn uniformly where the space is bounded."""

    @abc.abstractmethod
    def contains(self, x: Any) -> Bool[Array, ""]:
        """Whether a value of the right structure lies in the space: one truth value."""


@dataclasses.dataclass(frozen=True, kw_only=True)
class Discrete(Space):
    """The integers 0 … n − 1."""

    n: int
    shape: tuple[int, ...] = ()
    dtype: Any = jnp.int32

    def sample(self, key: Array) -> Array:
        """One integer, uniform."""
        return jax.random.randint(key, self.shape, 0, self.n, self.dtype)

    def contains(self, x: Any) -> Bool[Array, ""]:
        """Whether every entry is 0 … n − 1."""
        return jnp.all((jnp.asarray(x) >= 0) & (jnp.asarray(x) < self.n))


@dataclasses.dataclass(frozen=True, kw_only=True)
class MultiDiscrete(Space):
    """A vector of integers, each with its own number of classes."""

    number_of_dims_per_distribution: tuple[int, ...]
    """Classes per entry."""
    dtype: Any = jnp.int32

    @property
    def n(self) -> int:
        """How many logits a policy needs."""
        return sum(self.number_of_dims_per_distribution)

    @property
    def shape(self) -> tuple[int, ...]:
        """(entries,)."""
        return (len(self.number_of_dims_per_distribution),)

    def sample(self, key: Array) -> Array:
        """Every entry uniform over its classes."""
        classes = jnp.asarray(self.number_of_dims_per_distribution, self.dtype)
        return jax.random.randint(key, self.shape, 0, classes, self.dtype)

    def contains(self, x: Any) -> Bool[Array, ""]:
        """Whether every entry is one of its classes."""
        x = jnp.asarray(x)
        return jnp.all((x >= 0) & (x < np.asarray(self.number_of_dims_per_distribution)))


@dataclasses.dataclass(frozen=True, kw_only=True)
class Box(Space):
    """Arrays of one shape between two bounds (numbers, or tuples along the last axis)."""

    low: float | tuple[float, ...]
    high: float | tuple[float, ...]
    shape: tuple[int, ...]
    dtype: Any = jnp.float32

    def sample(self, key: Array) -> Array:
        """Every entry uniform between the bounds; unbounded entries from a standard normal."""
        low = jnp.broadcast_to(jnp.asarray(self.low, jnp.float32), self.shape)
        high = jnp.broadcast_to(jnp.asarray(self.high, jnp.float32), self.shape)
        bounded = jnp.isfinite(low) & jnp.isfinite(high)
        uniform = jax.random.uniform(key, self.shape)
        inside = jnp.where(bounded, low, 0) + uniform * jnp.where(bounded, high - low, 0)
        outside = jnp.clip(jax.random.normal(key, self.shape), low, high)
        return jnp.where(bounded, inside, outside).astype(self.dtype)

    def contains(self, x: Any) -> Bool[Array, ""]:
        """Whether every entry lies between the bounds, both included."""
        x = jnp.asarray(x)
        return jnp.all((x >= jnp.asarray(self.low)) & (x <= jnp.asarray(self.high)))


@dataclasses.dataclass(frozen=True, kw_only=True)
class Binary(Space):
    """Boolean arrays of one shape."""

    shape: tuple[int, ...]
    dtype: Any = jnp.bool_

    def sample(self, key: Array) -> Array:
        """Every entry a fair coin."""
        return jax.random.bernoulli(key, shape=self.shape)

    def contains(self, x: Any) -> Bool[Array, ""]:
        """Whether the array is boolean."""
        return jnp.asarray(jnp.asarray(x).dtype == jnp.bool_)


@dataclasses.dataclass(frozen=True, kw_only=True)
class Dict(Space):
    """Named parts, each with a space of its own."""

    spaces: Mapping[str, Space]

    def sample(self, key: Array) -> dict[str, Any]:
        """Every part drawn from its space."""
        keys = jax.random.split(key, len(self.spaces))
        return {
            name: space.sample(k)
            for (name, space), k in zip(self.spaces.items(), keys, strict=True)
        }

    def contains(self, x: Any) -> Bool[Array, ""]:
        """Whether every part lies in its space; parts are looked up as items or as attributes."""
        parts = x if isinstance(x, Mapping) else {name: getattr(x, name) for name in self.spaces}
        return jnp.all(
            jnp.stack([space.contains(parts[name]) for name, space in self.spaces.items()])
        )
