"""Episodes wherever they are: data sets, kinetix-env's layout, the editor's files, solutions."""

import dataclasses
import os
from collections.abc import Iterator
from pathlib import Path
from typing import Final, Literal

from kinetix.bundled import refuse_empty
from kinetix.datasets.episode import Origin, RecordedEpisode, solution_episode
from kinetix.datasets.folder import MANIFEST, read_dataset, read_manifest, win_origins
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
    folders = _datasets(source)
    for folder in folders:
        for episode in read_dataset(folder):
            yield FoundEpisode(episode=episode, place="dataset", name=str(folder))
    yield from _others(source, folders)


def check_source(source: str) -> None:
    """Raise what `episodes_of` would, before anything is played; shards are not read."""
    folders = _datasets(source)
    for folder in folders:
        read_manifest(folder)
    if not is_offline(Path(source)):
        for _ in _others(source, folders):
            pass


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
    for found in _others(source, folders):
        if found.episode.outcome == "won":
            yield found.episode.origin


def _datasets(source: str) -> list[Path]:
    """The folders of data sets at and below a path; nothing is looked for below a data set."""
    refuse_empty(source, "episodes, levels or a data set")
    path = Path(source)
    if os.path.isfile(path / MANIFEST):
        return [path]
    return sorted(each.parent for each in path.rglob(MANIFEST)) if os.path.isdir(path) else []


def _others(source: str, folders: list[Path]) -> Iterator[FoundEpisode]:
    """Episodes that are not in a data set."""
    path = Path(source)
    if path in folders:
        return
    if is_offline(path):
        for episode in read_offline(path):
            yield FoundEpisode(episode=episode, place="offline", name=source)
        return
    saved = sorted(path.rglob(f"*{SUFFIX}")) if os.path.isdir(path) else [path]
    traces = [each for each in saved if each.suffix == SUFFIX and each.parent not in folders]
    for each in traces:
        yield FoundEpisode(episode=episode_of_trace(each), place="trace", name=str(each))
    if path.suffix != SUFFIX:
        yield from _solutions(source, required=not traces and not folders)


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
