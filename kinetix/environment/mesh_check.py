"""Ways of sharing arrays among devices at which JAX would fail in the midst of a program."""

from collections.abc import Mapping
from typing import Any

import jax
from jax.sharding import AxisType

from kinetix.errors import KinetixError


def refuse_mesh(arguments: tuple[Any, ...], named: Mapping[str, Any]) -> None:
    """Refuse a mesh with explicit axes, and a `jax.shard_map` that checks what varies.

    Loops of a step start from constants, which JAX takes for equal on all devices, and its tables
    are read and written in ways that have no explicit sharding.

    Args:
        arguments: Of a method; the first array of the first argument is checked.
        named: Its keyword arguments, checked if there are no others.

    Raises:
        KinetixError: The arrays lie on such a mesh; the message says what to do.
    """
    axes = set(jax.sharding.get_abstract_mesh().axis_types)
    first = next(iter((*arguments, *named.values())), None)
    leaf = next(iter(jax.tree.leaves(first)), None)
    if isinstance(leaf, jax.Array):
        kind: Any = jax.typeof(leaf)
        if _varies(kind):
            raise KinetixError(
                "an environment within jax.shard_map: pass check_vma=False to it, or let "
                "kinetix.vectorize(env) share the worlds"
            )
        axes |= set(kind.sharding.mesh.axis_types)
    if AxisType.Explicit in axes:
        raise KinetixError(
            "a mesh with explicit axes: make it with jax.make_mesh(…, "
            "axis_types=(jax.sharding.AxisType.Auto,)), or let kinetix.vectorize(env) share the "
            "worlds"
        )


def _varies(kind: Any) -> bool:
    """Return whether `jax.shard_map` follows on which devices an array differs."""
    followed = getattr(kind, "manual_axis_type", None)  # since JAX 0.10
    return bool(getattr(kind, "vma", ()) if followed is None else followed.varying)
