"""Episodes wherever they are: data sets, kinetix-env's layout, the editor's files, solutions."""

import dataclasses
import os
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any, Final, Literal, TypeVar

from kinetix.bundled import refuse_empty
from kinetix.datasets.episode import Origin, RecordedEpisode, solution_episode
from kinetix.datasets.folder import MANIFEST, read_dataset, read_manifest, win_origins
from kinetix.datasets.offline import ORIGINS, is_offline, read_offline
from kinetix.datasets.traces import episode_of_trace
from kinetix.errors import KinetixError
from kinetix.level.sets import SetLevel, read_levels
from kinetix.wording import plural

SUFFIX: Final = ".npz"
"""Of shards and of episodes that the editor saved."""
_NO_LEVELS: Final = (MANIFEST, ORIGINS)
"""Files beside shards."""
T = TypeVar("T")
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
class _Places:
    """Places of the episodes that a word means."""

    datasets: list[Path]
    """Folders of data sets."""
    exports: list[Path]
    """Folders of kinetix-env's layout."""
    traces: list[Path]
    """Files that the editor saved, and archives of arrays that are none."""
    levels: list[SetLevel]
    """Levels, with a recorded solution or without."""
    named: bool
    """True if the word is the place itself: what is wrong with it is an error."""
    passed_over: tuple[str, ...] = ()
    """A message per file below a folder that is named like a level or data set but is not one."""
    unlike: frozenset[Path] = frozenset()
    """Folders of data sets with a bad manifest; their shards are not reported again."""

    def sound(self, items: Iterator[T], tell: Callable[[str], Any]) -> Iterator[T]:
        """Yield items until one is damaged: reported below a folder, raised elsewhere."""
        try:
            yield from items
        except KinetixError as error:
            if self.named:
                raise
            tell(str(error))

    def outside(self, tell: Callable[[str], Any]) -> Iterator[FoundEpisode]:
        """Read the episodes that are not in data sets one by one."""
        for folder in self.exports:
            for episode in self.sound(read_offline(folder), tell):
                yield FoundEpisode(episode=episode, place="offline", name=str(folder))
        for path, episode in self.saved():
            if isinstance(episode, RecordedEpisode):
                yield FoundEpisode(episode=episode, place="trace", name=str(path))
        for each in self.levels:
            episode = solution_episode(each.level)
            if episode is not None:
                yield FoundEpisode(episode=episode, place="solution", name=each.name)

    def saved(self) -> Iterator[tuple[Path, RecordedEpisode | KinetixError]]:
        """Read the files that the editor saved, or report faults of those below a folder."""
        for path in self.traces:
            try:
                yield path, episode_of_trace(path)
            except KinetixError as error:
                if self.named:
                    raise
                if path.parent not in self.unlike:
                    yield path, error


def untold(sentence: str) -> None:
    """Discard a message; it has been reported already."""


def episodes_of(source: str, tell: Callable[[str], Any] = untold) -> Iterator[FoundEpisode]:
    """Read all episodes that a word means.

    Args:
        source: A data set, a folder of kinetix-env's layout, an episode that the editor saved
            (`.npz`) or a folder of all of these, or levels with a recorded solution: a file, a
            name, a folder, a set. Below a folder, what `check_source` tells is passed over.
        tell: Takes a sentence per data set or export below a folder whose rest is passed over, as a
            shard is damaged.

    Raises:
        KinetixError: The source is missing or damaged.
    """
    places = _places(source)
    for folder in places.datasets:
        for episode in places.sound(read_dataset(folder), tell):
            yield FoundEpisode(episode=episode, place="dataset", name=str(folder))
    yield from places.outside(tell)


def check_source(source: str) -> tuple[str, ...]:
    """Raise what `episodes_of` would, before anything is played; shards are not read.

    Returns:
        A sentence per file below a folder that is called a level, an episode or a data set and is
        none, and one about levels without a solution: they are passed over.
    """
    places = _places(source)
    saved = (str(each) for _, each in places.saved() if isinstance(each, KinetixError))
    unsolved = sum(each.level.solution is None for each in places.levels)
    told = (f"{source}: {plural(unsolved, 'level')} without a recorded solution",)
    return (*places.passed_over, *saved, *(told if unsolved else ()))


def origins_of(source: str) -> Iterator[Origin]:
    """Return the origins of the won episodes that a word means, some of them several times.

    Args:
        source: As for `episodes_of`.

    Raises:
        KinetixError: The source is missing or damaged.
    """
    places = _places(source)
    for folder in places.datasets:
        yield from places.sound(win_origins(folder), untold)
    for found in places.outside(untold):
        if found.episode.outcome == "won":
            yield found.episode.origin


def _places(source: str) -> _Places:
    """Find the places of episodes at and below a path; below a data set there are no others."""
    refuse_empty(source, "episodes, levels or a data set")
    path = Path(source)
    if os.path.isfile(path / MANIFEST):
        read_manifest(path)
        return _Places(datasets=[path], exports=[], traces=[], levels=[], named=True)
    is_folder = os.path.isdir(path)
    datasets, unlike = _datasets(path) if is_folder else ([], {})
    saved = sorted(path.rglob("*")) if is_folder else [path]
    saved = [each for each in saved if each.suffix.lower() == SUFFIX]
    around = sorted({each.parent for each in saved}.difference(datasets)) if is_folder else []
    exports = [folder for folder in around if is_offline(folder)]
    if path in exports:
        return _Places(datasets=[], exports=[path], traces=[], levels=[], named=True)
    traces = [each for each in saved if each.parent not in (*datasets, *exports)]
    levels, unreadable = [], []
    if path.suffix.lower() != SUFFIX:
        levels, unreadable = _levels(source, required=not (traces or datasets or exports))
    return _Places(
        datasets=datasets,
        exports=exports,
        traces=traces,
        levels=levels,
        named=not is_folder,
        passed_over=(*unlike.values(), *unreadable),
        unlike=frozenset(unlike),
    )


def _datasets(path: Path) -> tuple[list[Path], dict[Path, str]]:
    """Return the data sets below a folder, and what is wrong with others, by their folders."""
    datasets, unlike = [], {}
    for file in sorted(path.rglob(MANIFEST)):
        try:
            read_manifest(file.parent)
            datasets.append(file.parent)
        except KinetixError as error:
            unlike[file.parent] = str(error)
    return datasets, unlike


def _levels(source: str, *, required: bool) -> tuple[list[SetLevel], list[str]]:
    """Levels, and what is wrong with others; a folder of other episodes need not have any."""
    try:
        levels, unreadable = read_levels([source])
    except KinetixError:
        if required:
            raise
        return [], []
    told = [str(error) for file, error in unreadable.items() if Path(file).name not in _NO_LEVELS]
    return levels, told
