"""Episodes that the editor recorded (`.npz`), as films."""

from pathlib import Path
from typing import Any

import numpy as np

from kinetix.errors import KinetixError
from kinetix.files.arrays import read_npz
from kinetix.level.codec import level_hash, loads
from kinetix.pages.film import Film

STEPS_PER_SECOND = 60
"""Engine steps in real time."""


def film_of_file(path: Path) -> Film:
    """Return the film of a recorded episode.

    Args:
        path: Written by the editor.

    Raises:
        KinetixError: The file is missing, or is no such episode; one sentence.
    """
    arrays = read_npz(path, "trace")
    try:
        return _film(arrays, path)
    except KeyError as error:
        raise KinetixError(f"{path}: expected an episode of the editor: {error} is missing") from (
            error
        )
    except (ValueError, TypeError, IndexError) as error:
        raise KinetixError(f"{path}: expected an episode of the editor: {error}") from error


def _film(arrays: dict[str, Any], path: Path) -> Film:
    level = loads(str(arrays["level"]), f"{path}: level")
    step, angle = arrays["step"], arrays["angle"]
    bodies = len(level.bodies)
    if angle.shape != (len(step), bodies) or arrays["position"].shape != (*angle.shape, 2):
        raise ValueError("its states do not belong to its level")
    if not (np.isfinite(angle).all() and np.isfinite(arrays["position"]).all()):
        raise ValueError("its states are not all finite")
    player, physics = str(arrays["player"]), str(arrays["physics"])
    draws = f"attempt {int(arrays['attempt'])}, seed {int(arrays['seed'])}"
    facts = [("level", f"{level.name}, {level_hash(level)[:12]}"), ("physics", physics)]
    facts += [("player", player), ("draws", draws)] if player else []
    return Film(
        level=level,
        title=player or "A person",
        seconds=(step - step[0]) * int(arrays["frame_skip"]) / STEPS_PER_SECOND,
        position=arrays["position"],
        angle=angle,
        actions=np.nan_to_num(arrays["unified"]).reshape(len(step), -1),
        value=arrays["value"].astype(float),
        entropy=arrays["entropy"].astype(float),
        outcome=str(arrays["outcome"]),
        facts=tuple(facts),
    )
