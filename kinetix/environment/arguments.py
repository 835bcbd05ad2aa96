"""Types of arguments: which ones JAX takes, and how error messages name them."""

from typing import Any

import jax
import jax.numpy as jnp
import numpy as np

NUMBERS = int | np.generic | np.ndarray | jax.Array
"""Types whose values a check can read; of these only a tracer has none."""


def is_array(value: Any) -> bool:
    """Return whether JAX takes it as an array of numbers."""
    if isinstance(value, np.ndarray | np.generic):
        return value.dtype == bool or jnp.issubdtype(value.dtype, jnp.number)
    return isinstance(value, int | float | jax.Array | jax.ShapeDtypeStruct)


def kind_of(value: Any) -> str:
    """Return what it is in a few words: its type, or the shape of an array."""
    shape = jnp.shape(value) if hasattr(value, "dtype") else None
    return type(value).__name__ if shape is None else f"an array of shape {shape}"
