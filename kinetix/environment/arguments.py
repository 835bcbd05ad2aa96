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
    """Return what it is in a few words: its type, or the shape of an array.

    Python's numbers are arrays without a shape once they are traced.
    """
    if not hasattr(value, "dtype"):
        return type(value).__name__
    if shape := jnp.shape(value):
        return f"an array of shape {shape}"
    return "a random key" if jnp.issubdtype(value.dtype, jax.dtypes.prng_key) else "a number"
