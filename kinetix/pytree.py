"""The one way to declare a JAX dataclass in this project."""

import dataclasses
from typing import Any, TypeVar, dataclass_transform

import jax
import numpy as np
from flax import struct

T = TypeVar("T")


def static(**options: Any) -> Any:
    """Return a field that is part of the structure: compared and hashed, never traced.

    Args:
        **options: Those of `dataclasses.field`, such as `default`.

    Returns:
        The field.
    """
    return struct.field(pytree_node=False, **options)


@dataclass_transform(frozen_default=True, kw_only_default=True, field_specifiers=(static,))
def pytree(cls: type[T]) -> type[T]:
    """Make a frozen, keyword-only dataclass that JAX treats as a pytree.

    The class gains `replace(**changes)` unless it has its own. Fields made with `static(...)` are
    part of the structure (compared and hashed, never traced).

    Args:
        cls: A class whose annotations are its fields.

    Returns:
        The registered class.
    """
    own = cls.__dict__.get("replace")
    made: Any = struct.dataclass(cls, kw_only=True)
    if own is not None:
        made.replace = own
    # JAX unflattens through __init__ with placeholders, which a type-checking hook would refuse.
    made.__no_type_check__ = True
    return made


def hashable(values: Any) -> Any:
    """Return a tuple in place of a list or an array; anything else as it is."""
    if isinstance(values, list | np.ndarray | jax.Array):
        return tuple(np.asarray(values).tolist())
    return values


def on_device(tree: Any) -> Any:
    """Return a tree whose arrays are JAX's, without compiling anything.

    `jnp.asarray` compiles a program for every shape. Numpy's arrays are copied first, as JAX may
    use their memory, in which others could write later.

    Args:
        tree: Arrays of numpy or JAX.
    """
    copied = jax.tree.map(lambda x: x.copy() if isinstance(x, np.ndarray) else x, tree)
    return jax.device_put(copied)


def typed_like(new: T, old: T) -> T:
    """Return a tree of arrays in the number types of another, as the carry of a loop needs it.

    With JAX's 64-bit mode on, constants are wider than what a loop began with.

    Args:
        new: Arrays.
        old: A tree of the same structure.
    """
    return jax.tree.map(lambda x, like: x.astype(like.dtype), new, old)


def short_repr(self: Any) -> str:
    """Return a record as text with only the fields that differ from their defaults."""
    fields = dataclasses.fields(self)
    shown = [
        f"{field.name}={value!r}"
        for field in fields
        if not isinstance(value := getattr(self, field.name), type(field.default))
        or value != field.default
    ]
    return f"{type(self).__name__}({', '.join(shown)})"
