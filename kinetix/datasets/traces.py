"""Episodes that the editor saved (`.npz`), as data."""

from pathlib import Path

import numpy as np

from kinetix.datasets.episode import CONTROLS, RecordedEpisode
from kinetix.environment.outcome import OUTCOMES
from kinetix.errors import KinetixError
from kinetix.files.arrays import read_npz
from kinetix.level.codec import loads
from kinetix.level.model import Level


def episode_of_trace(path: Path) -> RecordedEpisode:
    """Return an episode that the editor saved.

    Args:
        path: Written by the editor.

    Returns:
        The episode; `replays.checked` finds out whether its controls reproduce it.

    Raises:
        KinetixError: The file is missing, is no such episode, does not begin at the start, or has
            no end.
    """
    arrays = read_npz(path, "trace")
    try:
        level = loads(str(arrays["level"]), f"{path}: level")
        return episode_of_arrays(arrays, level, str(path))
    except KeyError as error:
        raise KinetixError(f"{path}: expected an episode of the editor: {error} is missing") from (
            error
        )
    except (ValueError, TypeError, IndexError) as error:
        raise KinetixError(f"{path}: expected an episode of the editor: {error}") from error


def episode_of_arrays(arrays: dict[str, np.ndarray], level: Level, name: str) -> RecordedEpisode:
    """Return an episode that the editor holds.

    Args:
        arrays: Its moments, as the editor saves them.
        level: The level that it was played on.
        name: How messages call it.

    Raises:
        KinetixError: The episode does not begin at the start, or has no end.
        KeyError: An array is missing.
        ValueError: An array has the wrong shape.
    """
    steps, unified = arrays["step"], arrays["unified"]
    if unified.shape != (len(steps), CONTROLS) or arrays["reward"].shape != steps.shape:
        raise ValueError(f"expected {CONTROLS} controls in every moment")
    if int(steps[0]) != 0 or np.any(np.diff(steps) != 1):
        raise KinetixError(
            f"{name}: does not begin at the level's start, so its controls do not tell it"
        )
    outcome = str(arrays["outcome"])
    if outcome not in OUTCOMES:
        raise KinetixError(f"{name}: was saved before the episode ended; play it to its end")
    control = unified[1:].astype(np.float32)
    if not np.isfinite(control).all():
        raise ValueError("its controls are not all finite")
    player = str(arrays["player"])
    return RecordedEpisode(
        level=level,
        control=np.clip(control, -1, 1),
        reward=arrays["reward"][1:].astype(np.float32),
        outcome=outcome,
        physics=str(arrays["physics"]),
        frame_skip=int(arrays["frame_skip"]),
        source="agent" if player and not bool(arrays["perturbed"]) else "person",
        player=player,
        digest=str(arrays.get("digest", "")),
        seed=int(arrays["seed"]),
        attempt=int(arrays["attempt"]),
        deterministic=bool(arrays["deterministic"]),
    )
