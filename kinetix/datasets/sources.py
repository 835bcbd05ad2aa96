"""Episodes wherever they are: data sets, kinetix-env's layout, the editor's files, solutions."""

import dataclasses
import os
from collections.abc import Iterator
from pathlib import Path
from typing import Final, Literal

from kinetix.bundled import refuse_empty
from kinetix.datasets.episode import Origin, RecordedEpisode, solution_episode
from kinetix.datasets.folder import MANIFEST, read_dataset, read_manifest, win_origins
from kinetix.datasets.offline import ORIGINS, is_offline, read_offline
from kinetix.datasets.traces import episode_of_trace
from kinetix.errors import KinetixError
from kinetix.level.sets import SetLevel, gather_levels, read_levels

SUFFIX: Final = ".npz"
"""Of shards and of episodes that the editor saved."""
_NO_LEVELS: Final = (MANIFEST, ORIGINS)
"""Files beside shards."""
Place = Literal["dataset", "offline", "trace", "solution"]
"""Kind of file that an episode was found in."""


@dataclasses.dataclass(frozen=True, kw_only=True)
class FoundEpisode:
    """An episode and where it was found."""

    episode: RecordedEpisode
    place: Place
    name: str
    """The file, folder or level, for sentences."""


@dataclasses.dataclass(frozen=True, kw_only=True)
class _Others:
    """Episodes that are not in a data set."""

    exports: list[Path]
    """Folders of kinetix-env's layout."""
    traces: list[Path]
    """Files that the editor saved."""
    levels: list[SetLevel]
    """Levels, with a recorded solution or without."""
    passed_over: tuple[str, ...] = ()
    """A sentence per file that is called a level and is none."""

    def episodes(self) -> Iterator[FoundEpisode]:
        """Read them one by one."""
        for folder in self.exports:
            for episode in read_offline(folder):
                yield FoundEpisode(episode=episode, place="offline", name=str(folder))
        for path in self.traces:
            yield FoundEpisode(episode=episode_of_trace(path), place="trace", name=str(path))
        for each in self.levels:
            episode = solution_episode(each.level)
            if episode is not None:
                yield FoundEpisode(episode=episode, place="solution", name=each.name)


def episodes_of(source: str) -> Iterator[FoundEpisode]:
    """Read all episodes that a word means.

    Args:
        source: A data set, a folder of kinetix-env's layout, an episode that the editor saved
            (`.npz`) or a folder of all of these, or levels with a recorded solution: a file, a
            name, a folder, a set.

    Raises:
        KinetixError: The source is missing or damaged.
    """
    folders = _datasets(source)
    for folder in folders:
        for episode in read_dataset(folder):
            yield FoundEpisode(episode=episode, place="dataset", name=str(folder))
    yield from _others(source, folders).episodes()


def check_source(source: str) -> tuple[str, ...]:
    """Raise what `episodes_of` would, before anything is played; shards are not read.

    Returns:
        A sentence per file that is called a level and is none: they are passed over.
    """
    folders = _datasets(source)
    for folder in folders:
        read_manifest(folder)
    others = _others(source, folders)
    for path in others.traces:
        episode_of_trace(path)
    return others.passed_over


def origins_of(source: str) -> Iterator[Origin]:
    """Return the origins of the won episodes that a word means, some of them several times.

    Args:
        source: As for `episodes_of`.

    Raises:
        KinetixError: The source is missing or damaged.
    """
    folders = _datasets(source)
    for folder in folders:
        yield from win_origins(folder)
    for found in _others(source, folders).episodes():
        if found.episode.outcome == "won":
            yield found.episode.origin


def _datasets(source: str) -> list[Path]:
    """The folders of data sets at and below a path; nothing is looked for below a data set."""
    refuse_empty(source, "episodes, levels or a data set")
    path = Path(source)
    if os.path.isfile(path / MANIFEST):
        return [path]
    return sorted(each.parent for each in path.rglob(MANIFEST)) if os.path.isdir(path) else []


def _others(source: str, folders: list[Path]) -> _Others:
    """Find the episodes that are not in a data set; folders are those of data sets."""
    path = Path(source)
    if path in folders:
        return _Others(exports=[], traces=[], levels=[])
    inside = sorted(path.rglob(f"*{SUFFIX}")) if os.path.isdir(path) else []
    places = sorted({each.parent for each in inside}.difference(folders))
    exports = [place for place in places if is_offline(place)]
    if path in exports:
        return _Others(exports=[path], traces=[], levels=[])
    saved = inside if os.path.isdir(path) else [path]
    traces = [
        each for each in saved if each.suffix == SUFFIX and each.parent not in (*folders, *exports)
    ]
    levels, passed_over = [], ()
    if path.suffix != SUFFIX:
        levels, passed_over = _levels(source, required=not (traces or folders or exports))
    return _Others(exports=exports, traces=traces, levels=levels, passed_over=passed_over)


def _levels(source: str, *, required: bool) -> tuple[list[SetLevel], tuple[str, ...]]:
    """Levels, and what is wrong with others; a folder of other episodes need not have any."""
    if required:
        return gather_levels([source]), ()
    try:
        levels, unreadable = read_levels([source])
    except KinetixError:
        return [], ()
    told = (str(error) for path, error in unreadable.items() if Path(path).name not in _NO_LEVELS)
    return levels, tuple(told)
