"""Several devices, of one machine or many: environments are split over them, the rest follows.

The program stays the one that a single device runs; the compiler splits it along the arrays that
are constrained here and averages what has to be averaged. So the same seed gives the same training
on any number of devices, but for rounding.

Over several machines every process runs the whole program; the first of them, the leader, is the
only one that writes files.
"""

import functools
from typing import Any

import jax
import numpy as np
from jax.experimental import multihost_utils
from jax.sharding import Mesh, NamedSharding, PartitionSpec

from kinetix.errors import KinetixError

_AXIS = "environments"


def join(coordinator: str, *, num_processes: int | None, process_id: int | None) -> None:
    """Train together with other processes; to be called before JAX computes anything.

    Args:
        coordinator: Host and port of the first process, as the others reach it, or "auto" where a
            cluster's scheduler tells.
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
    """Whether this process writes the run's files."""
    return jax.process_index() == 0


def wait_for_all(name: str) -> None:
    """Wait until every process is here.

    Args:
        name: Of the place, the same in every process.
    """
    if jax.process_count() > 1:
        multihost_utils.sync_global_devices(name)


def to_host(tree: Any) -> Any:
    """The whole of every array, as numpy arrays, in every process.

    Args:
        tree: Arrays; every process must call this with the same ones.
    """

    def whole(x: Any) -> np.ndarray:
        if isinstance(x, jax.Array) and not (x.is_fully_addressable or x.is_fully_replicated):
            x = multihost_utils.process_allgather(x, tiled=True)
        return np.asarray(x)

    return jax.tree.map(whole, tree)


def over_devices(tree: Any) -> Any:
    """Split every array of a tree along its first axis over all devices.

    Args:
        tree: Arrays whose first axis counts environments; to be called under jit.
    """
    if jax.device_count() == 1:
        return tree
    return jax.lax.with_sharding_constraint(tree, _split())


def check_divisible(environments: int) -> None:
    """Refuse a number of environments that cannot be split evenly.

    Args:
        environments: How many there are over all devices.

    Raises:
        KinetixError: It is no multiple of the number of devices.
    """
    if environments % jax.device_count():
        count = jax.device_count()
        raise KinetixError(
            f"num_train_envs = {environments} must be a multiple of the {count} devices"
        )


@functools.cache
def _split() -> NamedSharding:
    return NamedSharding(Mesh(np.asarray(jax.devices()), (_AXIS,)), PartitionSpec(_AXIS))
