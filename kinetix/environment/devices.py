"""A batch of worlds spread over all devices, of this process or of many.

Worlds do not talk to each other, so every device runs the same program on its share of the batch.
On a CPU, ask JAX for as many host devices as there are cores before it starts (the setting
`jax_num_cpu_devices`), since one device does little work in parallel.
"""

from collections.abc import Callable, Sequence
from typing import Any, Final

import jax
import jax.numpy as jnp
import numpy as np
from jax.sharding import Mesh, NamedSharding, PartitionSpec

from kinetix.errors import KinetixError

WORLDS: Final = "worlds"
"""The axis of the mesh of devices."""


def worlds_mesh(devices: Sequence[Any] | None = None) -> Mesh:
    """Put devices in one row: by default all devices of all processes."""
    return Mesh(np.array(jax.devices() if devices is None else devices), (WORLDS,))


def spread(function: Callable[..., Any], *, replicated: tuple[int, ...] = ()) -> Callable[..., Any]:
    """Compile a function of a batch so that every device works on its share.

    Args:
        function: Takes pytrees whose arrays have a leading axis of worlds, and returns such; what
            it computes for a world must not depend on other worlds.
        replicated: Positions of the arguments that all devices get whole (parameters).

    Returns:
        The compiled function. The number of worlds must be a multiple of the number of devices;
        with several processes, arguments come from `place`.
    """
    return jax.jit(in_shares(function, replicated=replicated))


def in_shares(
    function: Callable[..., Any],
    *,
    replicated: tuple[int, ...] = (),
    devices: Sequence[Any] | None = None,
) -> Callable[..., Any]:
    """Split a function of a batch over devices, as a part of a larger program.

    Args:
        function: As for `spread`.
        replicated: As for `spread`.
        devices: Which; None: all devices of all processes.

    Returns:
        A function to be called under `jit`.
    """
    mesh = worlds_mesh(devices)
    if mesh.size == 1:
        return function

    def shares(*arguments: Any) -> Any:
        specs = tuple(
            PartitionSpec() if index in replicated else PartitionSpec(WORLDS)
            for index in range(len(arguments))
        )
        split = jax.shard_map(
            function,
            mesh=mesh,
            in_specs=specs,
            out_specs=PartitionSpec(WORLDS),
            # Loops inside start from constants, which the check takes for replicated values.
            check_vma=False,
        )
        return split(*arguments)

    return shares


def devices_for(worlds: int) -> list[Any]:
    """Choose as many of this process's devices as can have equal shares of some worlds."""
    devices = jax.local_devices()
    count = max(n for n in range(1, len(devices) + 1) if worlds % n == 0)
    return devices[:count]


def place(batch: Any) -> Any:
    """Put this process's worlds on its devices, as its part of the whole batch.

    Args:
        batch: Pytree of arrays with a leading axis of worlds, those of this process.

    Returns:
        The same pytree as arrays of all worlds of all processes.

    Raises:
        KinetixError: The number of worlds is not a multiple of the number of local devices.
    """
    devices = jax.local_device_count()
    sharding = NamedSharding(worlds_mesh(), PartitionSpec(WORLDS))

    def put(x: Any) -> jax.Array:
        if x.shape[0] % devices:
            raise KinetixError(
                f"a batch of {x.shape[0]} worlds: expected a multiple of the {devices} devices"
            )
        if jnp.issubdtype(x.dtype, jax.dtypes.prng_key):
            data = jax.make_array_from_process_local_data(
                sharding, np.asarray(jax.random.key_data(x))
            )
            return jax.random.wrap_key_data(data, impl=jax.random.key_impl(x))
        return jax.make_array_from_process_local_data(sharding, np.asarray(x))

    return jax.tree.map(put, batch)


def own_part(batch: Any) -> Any:
    """This process's worlds of a spread batch, as numpy arrays in their order."""

    def gather(x: jax.Array) -> np.ndarray:
        shards = sorted(x.addressable_shards, key=lambda shard: shard.index[0].start or 0)
        return np.concatenate([np.asarray(shard.data) for shard in shards])

    return jax.tree.map(gather, batch)
