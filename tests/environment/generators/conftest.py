"""Drafts that several tests look at, drawn once."""

import jax
import numpy as np
import pytest

from kinetix.environment.generators.draft import Draft
from kinetix.environment.generators.params import UEDParams
from kinetix.environment.generators.sample import draw_levels
from kinetix.level.sizes import SIZES

LEVELS = 8192


@pytest.fixture(scope="session")
def drafts() -> dict[str, Draft]:
    """Random levels of each size with the default options, as numpy arrays."""
    keys = jax.random.split(jax.random.PRNGKey(1), LEVELS)
    ued = UEDParams()
    found = {}
    for size in ("s", "m", "l"):
        draw = jax.jit(lambda keys, size=size: draw_levels(keys, SIZES[size], ued))
        found[size] = jax.tree.map(np.asarray, draw(keys))
    return found
