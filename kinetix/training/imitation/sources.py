"""Sources of demonstrations: a teacher's shards, exported episodes, recorded solutions."""

import dataclasses
from collections.abc import Iterator, Sequence
from pathlib import Path
from typing import Final

import jax
import numpy as np

from kinetix.engine.spec import Capacity
from kinetix.environment.params import StaticEnvParams, static_env_params_of
from kinetix.environment.rearrange import expand_state
from kinetix.environment.reset import level_state
from kinetix.errors import KinetixError
from kinetix.files.arrays import read_npz
from kinetix.files.regular import FileError
from kinetix.level.codec import loads
from kinetix.level.model import Level
from kinetix.level.sets import gather_levels
from kinetix.level.sizes import capacity_of
from kinetix.training.imitation.records import SUFFIX, Demonstration, Origin, read_shard

EPISODE_KEYS: Final = ("level", "action", "physics", "outcome", "perturbed", "frame_skip")


@dataclasses.dataclass(frozen=True, kw_only=True)
class Collection:
    """Episodes of one origin."""

    source: str
    """The file or level, for sentences."""
    origin: Origin
    episodes: tuple[Demonstration, ...]


def gather(sources: Sequence[str]) -> Iterator[Collection]:
    """Read all demonstrations that some words mean.

    Args:
        sources: Folders of a teacher's data, `.npz` files (shards, or episodes that the editor
            exported), and levels with recorded solutions: files, names, folders, sets.

    Yields:
        Parts; there are none where a source has no win to learn from.

    Raises:
        KinetixError: A source is missing or damaged.
    """
    for source in sources:
        path = Path(source)
        shards = sorted(path.rglob(f"*{SUFFIX}")) if path.is_dir() else []
        if shards:
            yield from (_file(shard) for shard in shards)
        elif path.suffix == SUFFIX:
            yield _file(path)
        else:
            yield from _solutions(source)


def origin_of(sources: Sequence[str]) -> Origin:
    """Return the smallest origin that all demonstrations fit: the largest of each capacity.

    Raises:
        KinetixError: There is nothing to learn from, or the parts do not belong together.
    """
    origins = list(dict.fromkeys(part.origin for part in gather(sources) if part.episodes))
    if not origins:
        raise KinetixError(
            f"{', '.join(sources)}: no win to learn from; expected data of `kinetix teach`, won "
            "episodes that the editor exported, or levels with a recorded solution"
        )
    for name in ("physics", "frame_skip"):
        found = sorted({str(getattr(origin, name)) for origin in origins})
        if len(found) > 1:
            raise KinetixError(
                f"{', '.join(sources)}: expected one {name} in all demonstrations, got "
                f"{' and '.join(found)}"
            )
    sizes = [dataclasses.asdict(origin.capacity) for origin in origins]
    widest = Capacity(**{name: max(size[name] for size in sizes) for name in sizes[0]})
    return dataclasses.replace(origins[0], capacity=widest)


def demonstrations(
    sources: Sequence[str], static_env_params: StaticEnvParams
) -> list[Demonstration]:
    """Return all demonstrations, in slots of one size.

    Args:
        sources: As for `gather`.
        static_env_params: Of the environment in which they are to be played.

    Raises:
        KinetixError: One does not fit; the sentence says which.
    """
    found: list[Demonstration] = []
    for part in gather(sources):
        for episode in part.episodes:
            state = episode.state
            if part.origin.capacity != static_env_params.capacity:
                state = expand_state(state, static_env_params, name=part.source)
                state = jax.tree.map(np.asarray, state)
            found.append(dataclasses.replace(episode, state=state))
    return found


def _file(path: Path) -> Collection:
    """A shard, or an episode that the editor exported."""
    try:
        arrays = read_npz(path, "demonstrations")
    except FileError as error:
        raise KinetixError(f"{path}: expected demonstrations: {error.reason}") from error
    if "about" in arrays:
        origin, episodes = read_shard(path)
        return Collection(source=str(path), origin=origin, episodes=tuple(episodes))
    missing = [name for name in EPISODE_KEYS if name not in arrays]
    if missing:
        raise KinetixError(
            f"{path}: expected demonstrations, or an episode that the editor exported: "
            f"{missing[0]!r} is missing"
        )
    level = loads(str(arrays["level"]), f"{path}: level")
    won = str(arrays["outcome"]) == "won" and not bool(arrays["perturbed"])
    actions = np.asarray(arrays["action"])
    if actions.ndim != 2 or actions.shape[1:] != (6,):
        raise KinetixError(f"{path}: action has the shape {actions.shape}; expected rows of 6")
    return _of_level(
        str(path),
        level,
        actions if won else actions[:0],
        physics=str(arrays["physics"]),
        frame_skip=int(arrays["frame_skip"]),
    )


def _solutions(source: str) -> Iterator[Collection]:
    """The recorded solutions of levels."""
    for each in gather_levels([source]):
        solution = each.level.solution
        if solution is not None:
            rows = np.array(list(solution.unrolled()), np.int8).reshape(-1, 6)
            yield _of_level(
                each.name,
                each.level,
                rows,
                physics=solution.physics,
                frame_skip=solution.frame_skip,
            )


def _of_level(
    source: str, level: Level, actions: np.ndarray, *, physics: str, frame_skip: int
) -> Collection:
    origin = Origin(capacity=capacity_of(level), physics=physics, frame_skip=frame_skip)
    if not len(actions):
        return Collection(source=source, origin=origin, episodes=())
    static = static_env_params_of(origin.capacity, frame_skip=frame_skip, physics=physics)
    state = jax.tree.map(np.asarray, level_state(level, static))
    episode = Demonstration(state=state, actions=actions.astype(np.int8))
    return Collection(source=source, origin=origin, episodes=(episode,))
