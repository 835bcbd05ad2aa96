"""All cores of a processor: JAX uses one of them unless it is configured before it starts.

JAX sees a processor as so many devices as it was asked for. One device does little work in
parallel, so each core gets one. On a GPU or a TPU none of this matters.
"""

import contextlib
import os
from collections.abc import Callable, Mapping
from typing import Final

from kinetix.errors import KinetixError

CORES: Final = "KINETIX_CORES"
"""Variable with the number of cores to use; 1 leaves everything on one."""
_FLAG: Final = "--xla_force_host_platform_device_count"
_UNSET: Final = -1


def available_cores() -> int:
    """Count the cores that this process may run on."""
    if hasattr(os, "sched_getaffinity"):
        return len(os.sched_getaffinity(0))
    return os.cpu_count() or 1


def wanted_cores(variables: Mapping[str, str] = os.environ) -> int:
    """Read the number of cores to use: the variable `KINETIX_CORES`, else all of them.

    Args:
        variables: The variables of the process.

    Raises:
        KinetixError: The value is not a number of cores.
    """
    text = variables.get(CORES, "").strip()
    return available_cores() if not text else _checked(text, CORES)


def use_all_cores(cores: int | None = None, *, unless_started: bool = False) -> None:
    """Let JAX compute on all cores of the processor; to be called before the first array is made.

    Batches are then spread by `kinetix.vectorize`, and by whatever trains, evaluates or searches. A
    number of devices that was set in one of JAX's own ways stays, unless `cores` is given.

    Args:
        cores: How many; None: the variable `KINETIX_CORES`, else all of them.
        unless_started: Whether a JAX that has started already goes on as it is.

    Raises:
        KinetixError: JAX has started already with another number of devices, or there is no such
            number of cores.
    """
    import jax  # here, so that the package stays free of JAX until somebody wants it

    count = wanted_cores() if cores is None else _checked(str(cores), "cores")
    if cores is None and _set_by_user(jax.config.values["jax_num_cpu_devices"]):
        return
    try:
        jax.config.update("jax_num_cpu_devices", count)
    except RuntimeError:
        if unless_started or jax.local_device_count() == count:
            return
        raise KinetixError(
            f"JAX has started already, with {jax.local_device_count()} × {jax.default_backend()}: "
            "call kinetix.use_all_cores() before the first array is made"
        ) from None


def stay_on_processor() -> None:
    """Let JAX compute on the processor where there is a GPU too, unless `JAX_PLATFORMS` is set.

    For what steps one world at a time and must begin at once; to be called before the first array.
    """
    import jax

    if not jax.config.values["jax_platforms"]:
        jax.config.update("jax_platforms", "cpu")


def narrow_cores(fits: Callable[[int], bool]) -> None:
    """Use fewer cores than were asked for, where work has no equal shares for so many.

    Args:
        fits: Returns whether that many have equal shares.
    """
    import jax

    asked = jax.config.values["jax_num_cpu_devices"]
    count = next((cores for cores in range(asked, 0, -1) if fits(cores)), asked)
    if count != asked:
        with contextlib.suppress(RuntimeError):  # JAX has started: it stays as it is
            jax.config.update("jax_num_cpu_devices", count)


def check_cores(cores: int | None) -> None:
    """Make sure that a number of cores is one; None stands for all of them.

    Raises:
        KinetixError: `cores` is less than one.
    """
    if cores is not None:
        _checked(str(cores), "cores")


def _set_by_user(devices: int) -> bool:
    return devices != _UNSET or _FLAG in os.environ.get("XLA_FLAGS", "")


def _checked(text: str, source: str) -> int:
    if not text.isdecimal() or int(text) < 1:
        raise KinetixError(f"{source} = {text}: expected a number of cores, at least 1")
    return int(text)
