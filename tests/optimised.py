"""Compiling as users do."""

import contextlib
from collections.abc import Iterator

import jax

_SWITCH = "jax_disable_most_optimizations"


@contextlib.contextmanager
def optimised() -> Iterator[None]:
    """Compile with all optimisations: for what computes much longer than it compiles."""
    before = jax.config.values[_SWITCH]
    jax.config.update(_SWITCH, False)
    try:
        yield
    finally:
        jax.config.update(_SWITCH, before)
