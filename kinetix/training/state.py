"""The training state on disk: exact, so that a run can go on as if nothing had happened."""

from pathlib import Path
from typing import Any, Final

import jax
import numpy as np

from kinetix.agents.arrays import digest, read_arrays, write_arrays

STATE: Final = "state"
"""The directory beside `params/`."""


def save_state(directory: Path, state: Any) -> str:
    """Write every array of a state.

    Args:
        directory: The checkpoint; `state/` is made in it.
        state: Any pytree of numpy arrays.

    Returns:
        SHA-256 of all of them.
    """
    leaves = enumerate(jax.tree.leaves(state))
    # Orbax takes no empty arrays, such as the limits of levels that have none.
    kept = {_name(index): leaf for index, leaf in leaves if np.size(leaf)}
    write_arrays(directory / STATE, kept)
    return digest(kept)


def load_state(directory: Path, like: Any) -> tuple[Any, str]:
    """Read what `save_state` wrote.

    Args:
        directory: The checkpoint.
        like: A state of the same structure, or its shapes.

    Returns:
        The state as numpy arrays, which are the same in all processes that train together, and
        the SHA-256 of what was read.

    Raises:
        CheckpointError: It is damaged, or has another structure.
    """
    leaves, structure = jax.tree.flatten(like)
    shapes = {
        _name(index): jax.ShapeDtypeStruct(np.shape(leaf), leaf.dtype)
        for index, leaf in enumerate(leaves)
    }
    stored = {name: shape for name, shape in shapes.items() if shape.size}
    arrays = read_arrays(directory / STATE, stored)
    found = [
        arrays[name] if name in arrays else np.empty(shape.shape, shape.dtype)
        for name, shape in shapes.items()
    ]
    return jax.tree.unflatten(structure, found), digest(arrays)


def _name(index: int) -> str:
    return f"leaf_{index:05d}"
