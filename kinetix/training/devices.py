"""Several devices: environments are split over them, everything else follows.

The program stays the one that a single device runs; the compiler splits it along the arrays that
are constrained here and averages what has to be averaged. So the same seed gives the same training
on any number of devices, but for rounding.
"""

import functools
from typing import Any

import jax
import numpy as np
from jax.sharding import Mesh, NamedSharding, PartitionSpec

from kinetix.errors import KinetixError

_AXIS = "environments"


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
