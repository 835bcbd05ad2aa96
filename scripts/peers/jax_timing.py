"""Timing of compiled loops over batches of worlds, for the peers that are written in JAX."""

import statistics
import time
from collections.abc import Callable
from typing import Any

import jax
import jax.numpy as jnp
import numpy as np

RUNS = 5
"""Timed runs a figure; the median counts."""
SECONDS = 0.5
"""A run is made about as long as this."""


def stacked(trees: list[Any]) -> Any:
    """Trees of one shape as one, with a leading axis. By numpy: nothing has to be compiled."""
    return jax.tree.map(
        lambda *leaves: jnp.asarray(np.stack([np.asarray(x) for x in leaves])), *trees
    )


def time_loop(
    loop: Callable[..., Any], batch: int, *arguments: Any, first: int = 16, about: float = SECONDS
) -> dict[str, Any]:
    """Seconds per step and world of a loop: the median of five runs after a warm-up.

    Args:
        loop: Takes the arguments and an array of one whole number, how many steps to take.
        batch: Number of worlds.
        arguments: Pytrees with a leading axis of worlds; shared out among the devices there are.
        first: How many steps the warm-up takes, and a run of a loop that is slow.
        about: How long a run is made [s].
    """
    compiled, placed, devices = _over_devices(loop, batch, arguments)
    steps = first

    def seconds(steps: int) -> float:
        start = time.perf_counter()
        jax.block_until_ready(compiled(*placed, jnp.full(1, steps)))
        return time.perf_counter() - start

    compile_s = seconds(steps)
    while (taken := seconds(steps)) < about / 2:
        steps = max(2 * steps, int(steps * about / taken))
    runs = [seconds(steps) for _ in range(RUNS)]
    return {
        "seconds_per_step": statistics.median(runs) / steps / batch,
        "compile_s": compile_s,
        "devices": devices,
    }


def _over_devices(
    loop: Callable[..., Any], batch: int, arguments: tuple[Any, ...]
) -> tuple[Callable[..., Any], tuple[Any, ...], int]:
    count = jax.device_count()
    if count == 1 or batch % count:
        return jax.jit(loop), arguments, 1
    mesh = jax.make_mesh((count,), ("worlds",))
    parts = jax.sharding.PartitionSpec("worlds")
    placed = jax.device_put(arguments, jax.sharding.NamedSharding(mesh, parts))
    shared = jax.shard_map(
        loop,
        mesh=mesh,
        in_specs=(*([parts] * len(arguments)), jax.sharding.PartitionSpec()),
        out_specs=parts,
        check_vma=False,
    )
    return jax.jit(shared), placed, count
