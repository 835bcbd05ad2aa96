"""The training state on disk: exact, so that a run can go on as if nothing had happened."""

from pathlib import Path
from typing import Any, Final

import jax
import numpy as np

from kinetix.agents.arrays import read_arrays, write_arrays

STATE: Final = "state"
"""The directory beside `params/`."""


def save_state(directory: Path, state: Any) -> None:
    """Write every array of a state.

    Args:
        directory: The checkpoint; `state/` is made in it.
        state: Any pytree of numpy arrays.
    """
    leaves = jax.tree.leaves(state)
    write_arrays(directory / STATE, {_name(index): leaf for index, leaf in enumerate(leaves)})


def load_state(directory: Path, like: Any) -> Any:
    """Read what `save_state` wrote.

    Args:
        directory: The checkpoint.
        like: A state of the same structure, or its shapes.

    Returns:
        The state as numpy arrays, which are the same in all processes that train together.

    Raises:
        CheckpointError: It is damaged, or has another structure.
    """
    leaves, structure = jax.tree.flatten(like)
    shapes = {
        _name(index): jax.ShapeDtypeStruct(np.shape(leaf), leaf.dtype)
        for index, leaf in enumerate(leaves)
    }
    arrays = read_arrays(directory / STATE, shapes)
    return jax.tree.unflatten(structure, [arrays[_name(index)] for index in range(len(leaves))])


def _name(index: int) -> str:
    return f"leaf_{index:05d}"
