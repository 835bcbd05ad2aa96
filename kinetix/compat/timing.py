"""kinetix-env's small helpers of scripts."""

import logging
import time
from collections.abc import Callable
from typing import Any

import jax


def time_function(function: Callable[[], Any], name: str = "") -> Any:
    """Call a function, print how long it took until its result was there, and return the result.

    Args:
        function: Takes no arguments.
        name: What is printed before the time.
    """
    began = time.perf_counter()
    result = jax.block_until_ready(function())
    print(f"{name or 'function'}: {time.perf_counter() - began:.3f} s")  # noqa: T201
    return result


def get_logger() -> logging.Logger:
    """Return the logger of scripts."""
    return logging.getLogger("kinetix")
