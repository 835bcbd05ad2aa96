"""Episodes that the editor recorded (`.npz`), as films."""

from pathlib import Path

import numpy as np

from kinetix.level.codec import level_hash
from kinetix.pages.episode_file import read_episode
from kinetix.pages.film import Film

STEPS_PER_SECOND = 60
"""Engine steps in real time."""


def film_of_file(path: Path) -> Film:
    """Return the film of a recorded episode.

    Args:
        path: Written by the editor.

    Raises:
        KinetixError: The file is missing, or not an episode; one sentence.
    """
    level, arrays = read_episode(path)
    step = arrays["step"]
    player, physics = str(arrays["player"]), str(arrays["physics"])
    draws = f"attempt {int(arrays['attempt'])}, seed {int(arrays['seed'])}"
    facts = [("level", f"{level.name}, {level_hash(level)[:12]}"), ("physics", physics)]
    facts += [("player", player), ("draws", draws)] if player else []
    return Film(
        level=level,
        title=player or "A person",
        seconds=(step - step[0]) * int(arrays["frame_skip"]) / STEPS_PER_SECOND,
        position=arrays["position"],
        angle=arrays["angle"],
        actions=np.nan_to_num(arrays["unified"]).reshape(len(step), -1),
        value=arrays["value"].astype(float),
        entropy=arrays["entropy"].astype(float),
        outcome=str(arrays["outcome"]),
        facts=tuple(facts),
    )
