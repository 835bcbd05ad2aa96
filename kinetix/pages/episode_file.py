"""The arrays of a recorded episode (`.npz`), compared with its level and with each other."""

import os
from pathlib import Path
from typing import Final

import numpy as np

from kinetix.errors import KinetixError
from kinetix.files.arrays import read_npz
from kinetix.files.regular import FileError
from kinetix.level.codec import loads
from kinetix.level.model import MAX_STEPS, Level

_TEXTS: Final = ("outcome", "physics", "player")
_SCALARS: Final = (*_TEXTS, "perturbed", "seed", "attempt", "deterministic", "frame_skip")
_COLUMNS: Final = (
    "reward",
    "total_reward",
    "distance",
    "kinetic_energy",
    "potential_energy",
    "value",
    "entropy",
)
_RANGES: Final = {
    "step": (0, MAX_STEPS),
    "frame_skip": (1, 1000),
    "seed": (-(2**63), 2**63 - 1),
    "attempt": (0, 2**31 - 1),
}


def read_episode(path: Path) -> tuple[Level, dict[str, np.ndarray]]:
    """Read an episode that the editor recorded.

    Args:
        path: The file.

    Returns:
        Its level, and the arrays by name: as many moments as `step` has, bodies, joints and
        thrusters as the level has, poses and velocities finite.

    Raises:
        KinetixError: The file is missing, or not an episode; one sentence.
    """
    try:
        arrays = read_npz(path, "trace")
    except FileError as error:
        if not os.path.isfile(path):
            raise
        raise _unexpected(path, error.reason) from error
    try:
        level = loads(str(arrays["level"]), f"{path}: level")
        _check(arrays, level)
    except KeyError as error:
        raise _unexpected(path, f"{error} is missing") from error
    except (ValueError, TypeError) as error:
        raise _unexpected(path, str(error)) from error
    return level, arrays


def _unexpected(path: Path, reason: str) -> KinetixError:
    return KinetixError(f"{path}: expected an episode of the editor: {reason}")


def _check(arrays: dict[str, np.ndarray], level: Level) -> None:
    """Compare every array's type, shape and range with the number of moments and the level."""
    steps = arrays["step"]
    if steps.ndim != 1 or not 1 <= len(steps) <= MAX_STEPS + 1:
        raise ValueError(f"expected 1 to {MAX_STEPS + 1} moments")
    count, bodies = len(steps), len(level.bodies)
    shapes: dict[str, tuple[int | None, ...]] = {
        "position": (count, bodies, 2),
        "velocity": (count, bodies, 2),
        "angle": (count, bodies),
        "angular_velocity": (count, bodies),
        "motor": (count, len(level.joints)),
        "thruster": (count, len(level.thrusters)),
        "momentum": (count, 2),
        "action": (count - 1, None),
        **dict.fromkeys(("unified", "intention"), (count, None)),
        **dict.fromkeys(_COLUMNS, (count,)),
        **dict.fromkeys(_SCALARS, ()),
    }
    for name, shape in shapes.items():
        array = arrays[name]
        fits = array.ndim == len(shape) and all(
            wanted is None or length == wanted
            for length, wanted in zip(array.shape, shape, strict=True)
        )
        if not fits:
            raise ValueError(f"its states do not belong to its level: {name} is {array.shape}")
        if (array.dtype.kind == "U") != (name in _TEXTS):
            raise ValueError(f"{name} has the type {array.dtype}")
    if arrays["unified"].shape != arrays["intention"].shape:
        raise ValueError("unified and intention have different widths")
    for name, (low, high) in _RANGES.items():
        if not np.all((arrays[name] >= low) & (arrays[name] <= high)):
            raise ValueError(f"expected {name} from {low} to {high}")
    for name in ("step", "position", "angle", "velocity", "angular_velocity", "motor", "thruster"):
        if not np.isfinite(arrays[name]).all():
            raise ValueError(f"{name} is not finite")
