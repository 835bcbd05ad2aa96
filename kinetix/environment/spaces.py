"""Spaces of actions and observations: the two enumerations and the descriptions of sets.

The classes have the attributes that gymnax's spaces have (`n`, `shape`, `dtype`, `low`, `high`,
`sample(key)`, `contains(x)`), so that code written for those runs on these. Where gymnax has been
imported they are instances of its classes too, which its wrappers ask for; nothing here needs it.
"""

import abc
import dataclasses
import enum
import functools
import sys
from collections.abc import Callable, Mapping
from typing import Any, ClassVar, Final, Self

import jax
import jax.numpy as jnp
import numpy as np
from jaxtyping import Array, Bool

from kinetix.errors import KinetixError
from kinetix.lazy import lazy_names


class _Kind(enum.Enum):
    """A choice with a name in configurations."""

    def __eq__(self, other: object) -> bool:
        """Return whether it is this member, or an environment's own kind of the same name."""
        if self is other or isinstance(other, enum.Enum | str):
            return self is other
        return getattr(other, "value", None) == self.value

    __hash__ = enum.Enum.__hash__

    @classmethod
    def from_string(cls, name: "str | _Kind") -> Self:
        """Return the member with a name; a member stays as it is, an environment's own becomes it.

        Raises:
            KinetixError: No member has this name; the message lists them.
        """
        try:
            name = getattr(name, "value", name)
            return cls(name.lower() if isinstance(name, str) else name)
        except ValueError:
            names = ", ".join(member.value for member in cls)
            raise KinetixError(f"{name!r}: expected one of {names}") from None


class ActionType(_Kind):
    """The kinds of action; the values are the names in configurations."""

    DISCRETE = "discrete"
    CONTINUOUS = "continuous"
    MULTI_DISCRETE = "multi_discrete"


class ObservationType(_Kind):
    """The kinds of observation; the values are the names in configurations."""

    PIXELS = "pixels"
    SYMBOLIC_FLAT = "symbolic_flat"
    SYMBOLIC_FLAT_PADDED = "symbolic_flat_padded"
    SYMBOLIC_ENTITY = "symbolic_entity"
    BLIND = "blind"


_GYMNAX: Final = "gymnax.environments.spaces"


@functools.cache
def _with_base(kind: type, base: type) -> type:
    """Return the class itself, with another base: instances of it are instances of both."""
    return type(kind.__name__, (kind, base), {"__module__": kind.__module__})


class Space(abc.ABC):
    """A set of values of one structure."""

    gymnax_name: ClassVar[str] = "Space"
    """Return the corresponding class of gymnax."""

    def __new__(cls, *arguments: Any, **options: Any) -> Self:
        """Make an instance that is one of gymnax's class as well, where gymnax is there."""
        gymnax = sys.modules.get(_GYMNAX)
        if gymnax is None:
            return object.__new__(cls)
        return object.__new__(_with_base(cls, getattr(gymnax, cls.gymnax_name)))

    @abc.abstractmethod
    def sample(self, key: Array) -> Any:
        """Return a value drawn uniformly where the space is bounded."""

    @abc.abstractmethod
    def contains(self, x: Any) -> Bool[Array, ""]:
        """Return whether a value of the right structure lies in the space: one truth value."""


@dataclasses.dataclass(frozen=True, kw_only=True)
class Discrete(Space):
    """The integers 0 … n − 1."""

    gymnax_name: ClassVar[str] = "Discrete"

    n: int
    shape: tuple[int, ...] = ()
    dtype: Any = jnp.int32

    def sample(self, key: Array) -> Array:
        """Draw an integer uniformly."""
        return jax.random.randint(key, self.shape, 0, self.n, self.dtype)

    def contains(self, x: Any) -> Bool[Array, ""]:
        """Return whether every entry is a whole number 0 … n − 1."""
        return _contained(x, self.shape, lambda x: _is_class(x, self.n))


@dataclasses.dataclass(frozen=True, kw_only=True)
class MultiDiscrete(Space):
    """A vector of integers, each with its own number of classes."""

    gymnax_name: ClassVar[str] = "Box"

    number_of_dims_per_distribution: tuple[int, ...]
    """Classes per entry."""
    dtype: Any = jnp.int32

    @property
    def low(self) -> np.ndarray:
        """The least class of every entry: zeros."""
        return np.zeros(self.shape, np.int32)

    @property
    def high(self) -> np.ndarray:
        """The greatest class of every entry."""
        return np.array(self.number_of_dims_per_distribution, np.int32) - 1

    @property
    def n(self) -> int:
        """Number of logits that a policy needs."""
        return sum(self.number_of_dims_per_distribution)

    @property
    def shape(self) -> tuple[int, ...]:
        """(entries,)."""
        return (len(self.number_of_dims_per_distribution),)

    def sample(self, key: Array) -> Array:
        """Return every entry uniform over its classes."""
        classes = jnp.asarray(self.number_of_dims_per_distribution, self.dtype)
        return jax.random.randint(key, self.shape, 0, classes, self.dtype)

    def contains(self, x: Any) -> Bool[Array, ""]:
        """Return whether every entry is one of its classes."""
        classes = np.asarray(self.number_of_dims_per_distribution)
        return _contained(x, self.shape, lambda x: _is_class(x, classes))


def _contained(x: Any, shape: tuple[int, ...], good: Callable[[Array], Array]) -> Bool[Array, ""]:
    """Return whether an array has a shape, and every entry of it is good."""
    x = jnp.asarray(x)
    return jnp.all(good(x)) if x.shape == shape else jnp.zeros((), bool)


def _is_class(x: Array, classes: int | np.ndarray) -> Array:
    return (x >= 0) & (x < classes) & (x == jnp.floor(x))


@dataclasses.dataclass(frozen=True, kw_only=True, eq=False)
class Box(Space):
    """Arrays of one shape between two bounds (numbers, or arrays along the last axis)."""

    gymnax_name: ClassVar[str] = "Box"

    low: Any
    high: Any
    shape: tuple[int, ...]
    dtype: Any = jnp.float32

    def __post_init__(self) -> None:
        """Keep bounds that are sequences as arrays."""
        for name in ("low", "high"):
            if not np.isscalar(getattr(self, name)):
                object.__setattr__(self, name, np.asarray(getattr(self, name), np.float32))

    def __eq__(self, other: object) -> bool:
        """Return whether both are the same set."""
        if not isinstance(other, Box):
            return NotImplemented
        same = (self.shape, np.dtype(self.dtype)) == (other.shape, np.dtype(other.dtype))
        return same and all(
            np.array_equal(getattr(self, name), getattr(other, name)) for name in ("low", "high")
        )

    def __hash__(self) -> int:
        """Hash the shape and the type."""
        return hash((self.shape, np.dtype(self.dtype)))

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
        """Return whether every entry lies between the bounds, both included."""
        low, high = jnp.asarray(self.low), jnp.asarray(self.high)
        return _contained(x, self.shape, lambda x: (x >= low) & (x <= high))


@dataclasses.dataclass(frozen=True, kw_only=True)
class Binary(Space):
    """Boolean arrays of one shape."""

    gymnax_name: ClassVar[str] = "Box"
    low: ClassVar[int] = 0
    high: ClassVar[int] = 1

    shape: tuple[int, ...]
    dtype: Any = jnp.bool_

    def sample(self, key: Array) -> Array:
        """Return every entry a fair coin."""
        return jax.random.bernoulli(key, shape=self.shape)

    def contains(self, x: Any) -> Bool[Array, ""]:
        """Return whether the array is boolean."""
        return _contained(x, self.shape, lambda x: jnp.asarray(x.dtype == jnp.bool_))


@dataclasses.dataclass(frozen=True, kw_only=True)
class Dict(Space):
    """Named parts, each with a space of its own."""

    gymnax_name: ClassVar[str] = "Dict"

    spaces: Mapping[str, Space]

    @property
    def num_spaces(self) -> int:
        """Number of parts."""
        return len(self.spaces)

    def sample(self, key: Array) -> dict[str, Any]:
        """Return every part drawn from its space."""
        keys = jax.random.split(key, len(self.spaces))
        return {
            name: space.sample(k)
            for (name, space), k in zip(self.spaces.items(), keys, strict=True)
        }

    def contains(self, x: Any) -> Bool[Array, ""]:
        """Return whether every part, an item or an attribute, lies in its space."""
        parts = x if isinstance(x, Mapping) else {name: getattr(x, name) for name in self.spaces}
        return jnp.all(
            jnp.stack([space.contains(parts[name]) for name, space in self.spaces.items()])
        )


__getattr__ = lazy_names(__name__)[0]
