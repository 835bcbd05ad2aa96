"""Episodes as one `.npz` file: plain arrays that any numpy reads, no objects."""

import io
import json
from collections.abc import Sequence
from pathlib import Path
from typing import Any, Final

import numpy as np

from kinetix.datasets.episode import CONTROLS, SOURCES, RecordedEpisode
from kinetix.environment.outcome import OUTCOMES
from kinetix.errors import KinetixError
from kinetix.files.arrays import read_npz
from kinetix.level.codec import dumps, level_hash, loads
from kinetix.level.model import MAX_STEPS, Level

FORMAT: Final = "kinetix-episodes"
VERSION: Final = 1
SCHEMA: Final[dict[str, str]] = {
    "schema": "this table as JSON, with format and version",
    "level": "levels in our format, one JSON text after the other, as UTF-8 bytes",
    "level_end": "where each level's text ends",
    "level_hash": "SHA-256 of each level's content",
    "episode_id": "16 hexadecimal digits of level, physics, frame skip and controls",
    "episode_level": "index of the episode's level",
    "episode_end": "where the episode's steps end in control, action, reward and done",
    "outcome": "won, lost, timeout or broken",
    "physics": "physics preset or solver",
    "frame_skip": "engine steps (1/60 s) per environment step",
    "source": "person, agent or solver",
    "player": "the agent's name",
    "digest": "SHA-256 of the agent's parameters",
    "seed": "of the agent's draws",
    "attempt": "number of the attempt",
    "deterministic": "whether the likeliest actions were taken",
    "replays": "whether the controls alone end the episode the same way in the same step",
    "action_mask": "per episode, which entries of an action drive anything",
    "control": "per step, -1 to 1 per motor binding, then 0 to 1 per thruster binding",
    "action": "per step, the nearest multi-discrete action (motors 0, 1, 2; thrusters 0, 1)",
    "reward": "per step",
    "done": "per step, whether the episode ended with it",
}
"""Names of the arrays and what they hold."""


def pack(episodes: Sequence[RecordedEpisode]) -> bytes:
    """Return episodes as the bytes of a shard; equal levels are written once.

    Args:
        episodes: At least one, each of at least one step.
    """
    index: dict[str, int] = {}
    texts: list[bytes] = []
    levels = []
    for episode in episodes:
        key = level_hash(episode.level)
        if key not in index:
            index[key] = len(texts)
            texts.append(dumps(episode.level).encode())
        levels.append(index[key])
    head = {"format": FORMAT, "version": VERSION, "arrays": SCHEMA}
    arrays: dict[str, Any] = {
        "schema": np.array(json.dumps(head)),
        "level": np.frombuffer(b"".join(texts), np.uint8),
        "level_end": np.cumsum([len(text) for text in texts]),
        "level_hash": np.array(list(index)),
        "episode_level": np.array(levels, np.int32),
        **_played(episodes),
    }
    packed = io.BytesIO()
    np.savez_compressed(packed, **arrays)  # pyright: ignore[reportArgumentType]
    return packed.getvalue()


def _played(episodes: Sequence[RecordedEpisode]) -> dict[str, np.ndarray]:
    """Return the arrays of a shard about its episodes, not their levels."""
    lengths = [episode.length for episode in episodes]
    done = np.zeros(sum(lengths), bool)
    done[np.cumsum(lengths) - 1] = True
    arrays: dict[str, np.ndarray] = {
        "episode_id": np.array([episode.identity for episode in episodes]),
        "episode_end": np.cumsum(lengths),
        "frame_skip": np.array([episode.frame_skip for episode in episodes], np.int32),
        "seed": np.array([episode.seed for episode in episodes], np.int64),
        "attempt": np.array([episode.attempt for episode in episodes], np.int64),
        "action_mask": np.stack([episode.action_mask for episode in episodes]),
        "control": np.concatenate([episode.control for episode in episodes]).astype(np.float32),
        "action": np.concatenate([episode.action for episode in episodes]),
        "reward": np.concatenate([episode.reward for episode in episodes]).astype(np.float32),
        "done": done,
    }
    for name in ("outcome", "physics", "source", "player", "digest", "deterministic", "replays"):
        arrays[name] = np.array([getattr(episode, name) for episode in episodes])
    return arrays


def misfit_of(episode: RecordedEpisode) -> str | None:
    """Return why `read_shard` would refuse a shard with an episode; None where it would not.

    Args:
        episode: Of at least one step.
    """
    one_level = {"level": np.zeros(1), "level_end": np.ones(1), "level_hash": np.zeros(1)}
    try:
        _check_shapes({**one_level, "episode_level": np.zeros(1), **_played([episode])})
    except (ValueError, TypeError, OverflowError) as error:
        return str(error)
    return None


def read_ids(path: Path) -> tuple[str, ...]:
    """Return the identities of a shard's episodes.

    Raises:
        KinetixError: The file cannot be read, or is not a shard.
    """
    arrays = read_npz(path, "episodes", only=("schema", "episode_id"))
    _check_schema(arrays, path)
    return tuple(str(name) for name in arrays["episode_id"])


def read_shard(path: Path) -> list[RecordedEpisode]:
    """Return the episodes of a shard.

    Args:
        path: Written by `pack`.

    Raises:
        KinetixError: The file is missing, damaged, or no shard; one sentence.
    """
    arrays = read_npz(path, "episodes")
    try:
        _check_schema(arrays, path)
        _check_shapes(arrays)
        levels = _levels(arrays, path)
        return _episodes(arrays, levels)
    except KeyError as error:
        raise KinetixError(f"{path}: expected a shard of episodes: {error} is missing") from error
    except (ValueError, TypeError, IndexError, OverflowError) as error:
        raise KinetixError(f"{path}: expected a shard of episodes: {error}") from error


def _check_schema(arrays: dict[str, np.ndarray], path: Path) -> None:
    try:
        head = json.loads(str(arrays["schema"]))
        name, version = head["format"], head["version"]
    except (KeyError, TypeError, ValueError):
        raise KinetixError(f"{path}: expected a shard of episodes, found other arrays") from None
    if name != FORMAT:
        raise KinetixError(f"{path}: expected the format {FORMAT!r}, got {name!r}")
    if version != VERSION:
        raise KinetixError(
            f"{path}: version {version} is not read here (expected {VERSION}); a newer Kinetix may"
        )


def _check_shapes(arrays: dict[str, np.ndarray]) -> None:
    """Compare shapes, types and ranges with each other before anything is cut out."""
    ends, level_ends = arrays["episode_end"], arrays["level_end"]
    count, steps = len(ends), len(arrays["control"])
    for name, rows in ((ends, steps), (level_ends, len(arrays["level"]))):
        if name.ndim != 1 or not len(name) or int(name[-1]) != rows:
            raise ValueError("its parts do not end where its arrays end")
        if np.any(np.diff(name, prepend=0) < 1):
            raise ValueError("a part of it is empty")
    if np.max(np.diff(ends, prepend=0)) > MAX_STEPS:
        raise ValueError(f"an episode has more than {MAX_STEPS} steps")
    shapes: dict[str, tuple[int, ...]] = {
        "control": (steps, CONTROLS),
        "action": (steps, CONTROLS),
        "reward": (steps,),
        "done": (steps,),
        "action_mask": (count, CONTROLS),
        "level_hash": (len(level_ends),),
        **dict.fromkeys(_OF_EPISODE, (count,)),
    }
    for name, shape in shapes.items():
        if arrays[name].shape != shape:
            raise ValueError(f"{name} has the shape {arrays[name].shape}, expected {shape}")
    _check_values(arrays)


def _check_values(arrays: dict[str, np.ndarray]) -> None:
    if not np.isfinite(arrays["control"]).all() or np.abs(arrays["control"]).max() > 1:
        raise ValueError("control is not within -1 to 1")
    if not np.isin(arrays["outcome"], OUTCOMES).all():
        raise ValueError(f"expected outcomes from {', '.join(OUTCOMES)}")
    if not np.isin(arrays["source"], SOURCES).all():
        raise ValueError(f"expected sources from {', '.join(SOURCES)}")
    which = arrays["episode_level"]
    if np.any((which < 0) | (which >= len(arrays["level_end"]))):
        raise ValueError("an episode names a level that is not there")


_OF_EPISODE: Final = (
    "episode_id",
    "episode_level",
    "outcome",
    "physics",
    "frame_skip",
    "source",
    "player",
    "digest",
    "seed",
    "attempt",
    "deterministic",
    "replays",
)


def _levels(arrays: dict[str, np.ndarray], path: Path) -> list[Level]:
    text, levels, start = arrays["level"].tobytes(), [], 0
    for end, expected in zip(arrays["level_end"].tolist(), arrays["level_hash"], strict=True):
        level = loads(text[start:end].decode(), f"{path}: level {len(levels)}")
        if level_hash(level) != str(expected):
            raise ValueError(f"level {len(levels)} is not the one that its hash names")
        levels.append(level)
        start = end
    return levels


def _episodes(arrays: dict[str, np.ndarray], levels: list[Level]) -> list[RecordedEpisode]:
    episodes, start = [], 0
    for k, end in enumerate(arrays["episode_end"].tolist()):
        episode = RecordedEpisode(
            level=levels[int(arrays["episode_level"][k])],
            control=arrays["control"][start:end],
            reward=arrays["reward"][start:end],
            outcome=OUTCOMES[OUTCOMES.index(str(arrays["outcome"][k]))],  # pyright: ignore
            physics=str(arrays["physics"][k]),
            frame_skip=int(arrays["frame_skip"][k]),
            source=SOURCES[SOURCES.index(str(arrays["source"][k]))],  # pyright: ignore
            player=str(arrays["player"][k]),
            digest=str(arrays["digest"][k]),
            seed=int(arrays["seed"][k]),
            attempt=int(arrays["attempt"][k]),
            deterministic=bool(arrays["deterministic"][k]),
            replays=bool(arrays["replays"][k]),
        )
        if episode.identity != str(arrays["episode_id"][k]):
            raise ValueError(f"episode {k} is not the one that its identity names")
        episodes.append(episode)
        start = end
    return episodes
