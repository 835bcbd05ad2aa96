"""Programs that JAX keeps out of its cache on disk; `editor.worker.yielding` has other pauses."""

import math
from collections.abc import Callable
from typing import Final

import jax

from kinetix.shared_setting import Meanwhile

_CACHED: Final = "jax_persistent_cache_min_compile_time_secs"
"""Programs that took longer to compile than this are written to the cache on disk."""


def _nothing_stored() -> Callable[[], None]:
    before = getattr(jax.config, _CACHED)
    jax.config.update(_CACHED, math.inf)
    return lambda: jax.config.update(_CACHED, before)


not_stored: Final = Meanwhile(_nothing_stored)
"""Keep programs out of the cache of JAX: `editor.worker.simulation.disk` keeps those of steps."""
