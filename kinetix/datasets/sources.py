"""Episodes wherever they are: data sets, kinetix-env's layout, the editor's files, solutions."""

import dataclasses
from collections.abc import Iterator
from pathlib import Path
from typing import Final, Literal

from kinetix.datasets.episode import Origin, RecordedEpisode, solution_episode
from kinetix.datasets.folder import MANIFEST, read_dataset, win_origins
from kinetix.datasets.offline import is_offline, read_offline
from kinetix.datasets.traces import episode_of_trace
from kinetix.errors import KinetixError
from kinetix.level.sets import gather_levels

SUFFIX: Final = ".npz"
"""Of shards and of episodes that the editor saved."""
Place = Literal["dataset", "offline", "trace", "solution"]
"""Kind of file that an episode was found in."""


@dataclasses.dataclass(frozen=True, kw_only=True)
class FoundEpisode:
    """An episode and where it was found."""

    episode: RecordedEpisode
    place: Place
    name: str
    """The file, folder or level, for sentences."""


def episodes_of(source: str) -> Iterator[FoundEpisode]:
    """Read all episodes that a word means.

    Args:
        source: A data set, a folder of kinetix-env's layout, an episode that the editor saved
            (`.npz`) or a folder of them, or levels with a recorded solution: a file, a name, a
            folder, a set.

    Raises:
        KinetixError: The source is missing or damaged.
    """
    path = Path(source)
    if (path / MANIFEST).is_file():
        yield from _found(read_dataset(path), "dataset", source)
        return
    below = sorted(each.parent for each in path.rglob(MANIFEST)) if path.is_dir() else []
    for folder in below:
        yield from _found(read_dataset(folder), "dataset", str(folder))
    if is_offline(path):
        yield from _found(read_offline(path), "offline", source)
        return
    saved = sorted(path.rglob(f"*{SUFFIX}")) if path.is_dir() else [path]
    traces = [each for each in saved if each.suffix == SUFFIX and each.parent not in below]
    for each in traces:
        yield FoundEpisode(episode=episode_of_trace(each), place="trace", name=str(each))
    if path.suffix != SUFFIX:
        yield from _solutions(source, required=not traces and not below)


def origins_of(source: str) -> Iterator[Origin]:
    """Return the origins of the won episodes that a word means, some of them several times.

    Args:
        source: As for `episodes_of`.

    Raises:
        KinetixError: The source is missing or damaged.
    """
    path = Path(source)
    if (path / MANIFEST).is_file():
        yield from win_origins(path)
        return
    for found in episodes_of(source):
        if found.episode.outcome == "won":
            yield found.episode.origin


def _found(episodes: Iterator[RecordedEpisode], place: Place, name: str) -> Iterator[FoundEpisode]:
    return (FoundEpisode(episode=each, place=place, name=name) for each in episodes)


def _solutions(source: str, *, required: bool) -> Iterator[FoundEpisode]:
    """The recorded solutions of levels; a folder of other episodes need not have any level."""
    try:
        levels = gather_levels([source])
    except KinetixError:
        if required:
            raise
        return
    for each in levels:
        episode = solution_episode(each.level)
        if episode is not None:
            yield FoundEpisode(episode=episode, place="solution", name=each.name)
