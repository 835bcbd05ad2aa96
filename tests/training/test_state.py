"""The training state comes back from disk as it was."""

from pathlib import Path

import jax
import numpy as np

from kinetix.training.state import load_state, save_state


def test_every_array_comes_back_those_without_entries_too(tmp_path: Path) -> None:
    state = {
        "key": np.array([1, 2], np.uint32),
        "limits": np.empty((8, 0), np.float32),
        "nested": (np.float32(0.5), np.zeros((0,), np.int32), np.ones((2, 3), bool)),
    }
    written = save_state(tmp_path, state)
    found, read = load_state(tmp_path, jax.tree.map(np.zeros_like, state))
    assert read == written
    assert jax.tree.structure(found) == jax.tree.structure(state)
    for one, other in zip(jax.tree.leaves(found), jax.tree.leaves(state), strict=True):
        np.testing.assert_array_equal(one, other)
        assert one.dtype == other.dtype
        assert one.shape == other.shape
