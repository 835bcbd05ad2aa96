"""Compiling without holding the other threads up: the window goes on drawing meanwhile.

What a worker does in Python, tracing above all, gives way every millisecond, and XLA compiles
without the interpreter. Two things stop every thread at once for 0.1 to 0.4 s: a full garbage
collection, of which tracing provokes several and which finds next to nothing, and writing a
compiled program to the cache on disk.
"""

import contextlib
import gc
import math
from collections.abc import Iterator
from typing import Final

import jax

_NEVER: Final = 2**30
"""As many collections of the middle generation have to come before a full one."""
_CACHED: Final = "jax_persistent_cache_min_compile_time_secs"
"""Programs that took longer to compile than this are written to the cache on disk."""


@contextlib.contextmanager
def without_pauses() -> Iterator[None]:
    """Leave full collections out; the small ones go on and find what tracing leaves behind."""
    young, middle, old = gc.get_threshold()
    gc.set_threshold(young, middle, _NEVER)
    try:
        yield
    finally:
        # What is left makes up the compiled step: later collections need not walk through it.
        gc.freeze()
        # Of two workers the one that ends last must not keep the other one's setting.
        gc.set_threshold(young, middle, old if old != _NEVER else 10)


@contextlib.contextmanager
def not_stored() -> Iterator[None]:
    """Keep programs out of the cache on disk: those of one level, which would only pile up."""
    before = getattr(jax.config, _CACHED)
    jax.config.update(_CACHED, math.inf)
    try:
        yield
    finally:
        jax.config.update(_CACHED, before)
