"""JAX's usual promotion in our own programs, however strict the caller's program is with itself."""

from collections.abc import Iterator
from contextlib import contextmanager

import jax


@contextmanager
def usual_promotion() -> Iterator[None]:
    """Let arrays of other ranks and types meet, where JAX's options would refuse it.

    Some people set `jax_numpy_rank_promotion` to `raise` or `jax_numpy_dtype_promotion` to `strict`
    to find slips in their own code.
    """
    with jax.numpy_rank_promotion("allow"), jax.numpy_dtype_promotion("standard"):
        yield
