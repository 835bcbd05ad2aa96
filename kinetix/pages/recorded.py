"""Episodes that the editor recorded (`.npz`), as films."""

from pathlib import Path

import numpy as np

from kinetix.pages.episode_file import read_episode
from kinetix.pages.facts import draws_of, facts_of
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
    draws = draws_of(
        int(arrays["seed"]),
        int(arrays["attempt"]),
        deterministic=bool(arrays["deterministic"]),
    )
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
        facts=facts_of(
            level,
            physics,
            player=player,
            digest=str(arrays.get("digest", "")),
            draws=draws,
            perturbed=bool(arrays["perturbed"]),
        ),
    )
