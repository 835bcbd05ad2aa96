"""Several devices, of one machine or many: each plays its share of the environments.

Playing and learning run `on_each_device`, with random numbers that belong to the environments, not
to the devices; gradients are averaged. So the same seed gives the same training on any number of
devices, but for rounding (and dropout), as long as the number divides the groups that the
minibatches are shuffled in (`shuffle_groups`: powers of two).

Over several machines every process runs the whole program; the first of them, the leader, is the
only one that writes files.
"""

from collections.abc import Callable
from typing import Any, Final

import jax
import numpy as np
from jax.experimental import multihost_utils
from jax.flatten_util import ravel_pytree
from jax.sharding import NamedSharding, PartitionSpec
from jaxtyping import Array

from kinetix.environment.devices import WORLDS, worlds_mesh
from kinetix.errors import KinetixError
from kinetix.training.config import PpoConfig

WHOLE: Final = PartitionSpec()
"""Placement of arrays that every device holds whole."""
OWN: Final = PartitionSpec(WORLDS)
"""Placement of arrays that are split along the first axis."""
OWN_COLUMNS: Final = PartitionSpec(None, WORLDS)
"""Placement of arrays that are split along the second axis, the first being time."""
_MOST_GROUPS: Final = 16


def join(coordinator: str, *, num_processes: int | None, process_id: int | None) -> None:
    """Train together with other processes; to be called before JAX computes anything.

    Args:
        coordinator: Host and port of the first process, as the others reach it, or "auto" where a
            cluster's scheduler provides.
        num_processes: How many processes there are; None: the scheduler knows.
        process_id: Which of them this is, from 0; None: the scheduler knows.

    Raises:
        KinetixError: The processes do not find each other, or the arguments are incomplete.
    """
    address = None if coordinator == "auto" else coordinator
    if address is not None and (num_processes is None or process_id is None):
        raise KinetixError("coordinator: num_processes and process_id are needed too")
    try:
        jax.distributed.initialize(address, num_processes, process_id)
    except (ValueError, RuntimeError) as error:
        raise KinetixError(f"coordinator {coordinator!r}: {error}") from None


def is_leader() -> bool:
    """Return whether this process writes the run's files."""
    return jax.process_index() == 0


def wait_for_all(name: str) -> None:
    """Wait until every process is here.

    Args:
        name: Of the place, the same in every process.
    """
    if jax.process_count() > 1:
        multihost_utils.sync_global_devices(name)


def to_host(tree: Any) -> Any:
    """Return the whole of every array, as numpy arrays, in every process.

    Args:
        tree: Arrays; every process must call this with the same ones.
    """

    def whole(x: Any) -> np.ndarray:
        if isinstance(x, jax.Array) and not (x.is_fully_addressable or x.is_fully_replicated):
            x = multihost_utils.process_allgather(x, tiled=True)
        return np.asarray(x)

    return jax.tree.map(whole, tree)


def placed(tree: Any, placement: PartitionSpec) -> Any:
    """Place arrays on the devices with the given sharding.

    Args:
        tree: Whole numpy arrays, the same in every process.
        placement: `WHOLE`, `OWN` or `OWN_COLUMNS`.
    """

    def put(x: np.ndarray) -> jax.Array:
        # Of nothing every device has the whole.
        sharding = NamedSharding(worlds_mesh(), placement if x.size else WHOLE)
        return jax.make_array_from_callback(x.shape, sharding, lambda index: x[index])

    return jax.tree.map(put, tree)


def on_each_device(function: Callable[..., Any], ins: Any, outs: Any) -> Callable[..., Any]:
    """Run a function on every device, with its share of what is split.

    Args:
        function: Of pytrees; inside, `average`, `own_keys` and `first_share` work.
        ins: `WHOLE`, `OWN` or `OWN_COLUMNS` for each argument.
        outs: The same for the results; what is `WHOLE` must be equal on all devices.

    Returns:
        A function to be called under jit.
    """
    mesh = worlds_mesh()
    if mesh.size == 1:
        return function
    # Loops inside start from constants, which the check takes for replicated values.
    return jax.shard_map(function, mesh=mesh, in_specs=ins, out_specs=outs, check_vma=False)


def average(tree: Any) -> Any:
    """Average over the devices that run this apart from each other.

    Args:
        tree: Arrays of numbers of 32 bits.
    """
    if not _apart():
        return tree
    # All as one array: devices wait for each other once, not for each of a network's layers.
    numbers, restored = ravel_pytree(tree)
    return restored(jax.lax.pmean(numbers, WORLDS))


def everywhere(tree: Any) -> Any:
    """Keep all of a tree on every device, so that what takes it is compiled for that alone.

    Args:
        tree: Arrays; to be called under jit.
    """
    if jax.device_count() == 1:
        return tree
    return jax.lax.with_sharding_constraint(tree, NamedSharding(worlds_mesh(), WHOLE))


def own_keys(key: Array, count: int) -> Array:
    """Draw keys for this device's rows: those that the rows would have on a single device.

    Args:
        key: Random key, the same on all devices.
        count: Rows of this device.
    """
    if not _apart():
        return jax.random.split(key, count)
    keys = jax.random.split(key, count * jax.device_count())
    return jax.lax.dynamic_slice_in_dim(keys, jax.lax.axis_index(WORLDS) * count, count)


def shuffle_groups(environments: int, steps: int, minibatches: int) -> int:
    """Choose in how many groups environments are shuffled, so that no minibatch crosses devices.

    Every minibatch takes equally many from each group, so a device needs no other's.

    Args:
        environments: Over all devices.
        steps: How many rows an environment has that are shuffled one by one.
        minibatches: Parts that each group is split into.
    """
    groups, devices = 1, jax.device_count()
    while groups < _MOST_GROUPS and _even(environments, 2 * groups, steps, minibatches):
        groups *= 2
    return groups if groups % devices == 0 else devices


def _even(environments: int, groups: int, steps: int, minibatches: int) -> bool:
    return environments % groups == 0 and environments // groups * steps % minibatches == 0


def shares() -> int:
    """Count the devices that run this apart from each other."""
    return jax.device_count() if _apart() else 1


def _apart() -> bool:
    return WORLDS in jax.sharding.get_abstract_mesh().manual_axes


def check_divisible(config: PpoConfig) -> None:
    """Refuse a training that cannot be split evenly.

    Args:
        config: The configuration.

    Raises:
        KinetixError: Environments, minibatches or levels to be scored have no equal shares.
    """
    uneven = config.uneven(jax.device_count())
    if uneven:
        raise KinetixError(uneven)
