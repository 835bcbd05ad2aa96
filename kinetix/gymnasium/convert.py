"""Our spaces and observations in Gymnasium's form: numpy, and pictures as it shows them."""

from collections.abc import Mapping
from typing import Any

import gymnasium
import numpy as np

from kinetix.environment import spaces

IMAGE = "image"
"""The part of an observation that is a picture."""


def gymnasium_space(space: spaces.Space, name: str = "") -> gymnasium.Space[Any]:
    """Return the set in Gymnasium's form.

    Args:
        space: The set.
        name: Which part of an observation it is; pictures become (height, width, 3), 0 … 255.
    """
    if isinstance(space, spaces.Discrete):
        return gymnasium.spaces.Discrete(space.n)
    if isinstance(space, spaces.MultiDiscrete):
        return gymnasium.spaces.MultiDiscrete(list(space.number_of_dims_per_distribution))
    if isinstance(space, spaces.Binary):
        # Of one axis as a number: some libraries read nothing else.
        return gymnasium.spaces.MultiBinary(
            space.shape[0] if len(space.shape) == 1 else list(space.shape)
        )
    if isinstance(space, spaces.Dict):
        parts = {key: gymnasium_space(part, key) for key, part in space.spaces.items()}
        return gymnasium.spaces.Dict(parts)
    assert isinstance(space, spaces.Box)
    if name == IMAGE:
        width, height, channels = space.shape
        return gymnasium.spaces.Box(0, 255, (height, width, channels), np.uint8)
    return gymnasium.spaces.Box(space.low, space.high, space.shape, np.dtype(space.dtype).type)


def numpy_observation(observation: Any) -> Any:
    """Return an observation, or a batch, as numpy arrays of its own; parts by name as a dictionary.

    The receiver may write into them: JAX's own memory may only be read.
    """
    if hasattr(observation, "_asdict"):
        observation = observation._asdict()
    if isinstance(observation, Mapping):
        parts = {name: part for name, part in observation.items() if part is not None}
        return {name: _array(part, name) for name, part in parts.items()}
    return _array(observation)


def _array(part: Any, name: str = "") -> np.ndarray:
    array = np.asarray(part)
    if name == IMAGE:
        upright = np.moveaxis(array, -3, -2)[..., ::-1, :, :]
        return np.round(upright * 255).astype(np.uint8)
    return array.astype(np.int8 if array.dtype == np.bool_ else array.dtype)
