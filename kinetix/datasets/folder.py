"""A data set: a folder of shards and a manifest with their hashes, to which episodes are added."""

import contextlib
import dataclasses
import hashlib
import itertools
import os
from collections.abc import Iterable, Iterator
from pathlib import Path
from typing import Final

import msgspec

from kinetix.datasets.episode import Origin, RecordedEpisode
from kinetix.datasets.shard import FORMAT, VERSION, misfit_of, pack, read_ids, read_shard
from kinetix.errors import KinetixError
from kinetix.files.atomic import write_atomically
from kinetix.files.folders import begun_folder
from kinetix.files.json_text import read_json
from kinetix.files.regular import read_bytes
from kinetix.version import __version__
from kinetix.wording import misfit, plural

MANIFEST: Final = "dataset.json"
SHARD_STEPS: Final = 262_144
"""Environment steps after which a new shard begins (about 2 MB)."""
_BRING_BACK: Final = "bring the file back, or begin another data set"


class ShardEntry(msgspec.Struct, frozen=True, kw_only=True):
    """A shard in the manifest."""

    file: str
    sha256: str
    episodes: int
    steps: int
    origins: tuple[Origin, ...] | None = None
    """Of the episodes that are won; None in what earlier versions wrote."""


class Manifest(msgspec.Struct, frozen=True, kw_only=True):
    """Content of `dataset.json`."""

    format: str
    version: int
    written_by: str = ""
    shards: tuple[ShardEntry, ...] = ()

    @property
    def episodes(self) -> int:
        """Episodes in all shards."""
        return sum(shard.episodes for shard in self.shards)

    @property
    def steps(self) -> int:
        """Environment steps in all shards."""
        return sum(shard.steps for shard in self.shards)


@dataclasses.dataclass(frozen=True, kw_only=True)
class Added:
    """Result of adding episodes."""

    added: int
    known: int
    """Left out, because the data set has the very same."""
    empty: int
    """Left out, because they have no step."""
    unfit: tuple[str, ...] = ()
    """A sentence per episode that is left out because it could not be read again."""


def read_manifest(folder: Path) -> Manifest:
    """Return the manifest of a data set.

    Args:
        folder: The data set.

    Raises:
        KinetixError: The folder is not a data set, or its manifest is bad; one sentence.
    """
    path = folder / MANIFEST
    if not os.path.isfile(path):
        raise KinetixError(f"{folder}: expected a data set of episodes ({MANIFEST}), found none")
    try:
        manifest = msgspec.convert(read_json(path, "kept"), Manifest)
    except msgspec.ValidationError as error:
        raise KinetixError(f"{path}: {misfit(error)}") from None
    if manifest.format != FORMAT:
        raise KinetixError(f"{path}: $.format: expected {FORMAT!r}, got {manifest.format!r}")
    if manifest.version != VERSION:
        raise KinetixError(f"{path}: $.version: expected {VERSION}, got {manifest.version}")
    for k, shard in enumerate(manifest.shards):
        if Path(shard.file).name != shard.file:
            raise KinetixError(f"{path}: $.shards[{k}].file: expected a name without a folder")
    return manifest


def read_dataset(folder: Path) -> Iterator[RecordedEpisode]:
    """Read the episodes of a data set, shard after shard.

    Args:
        folder: The data set.

    Raises:
        KinetixError: The folder is not a data set, or a shard is missing, damaged, or differs from
            the manifest; one sentence.
    """
    for k, shard in enumerate(read_manifest(folder).shards):
        path = folder / shard.file
        if hashlib.sha256(read_bytes(path, "episodes")).hexdigest() != shard.sha256:
            raise KinetixError(
                f"{path}: is not the file that {MANIFEST} names (SHA-256 differs); {_BRING_BACK}"
            )
        episodes = read_shard(path)
        held = len(episodes), sum(episode.length for episode in episodes)
        if held != (shard.episodes, shard.steps):
            raise KinetixError(
                f"{folder / MANIFEST}: $.shards[{k}]: expected {_counted(*held)} as in "
                f"{shard.file}, got {_counted(shard.episodes, shard.steps)}; {_BRING_BACK}"
            )
        yield from episodes


def _counted(episodes: int, steps: int) -> str:
    return f"{plural(episodes, 'episode')} and {plural(steps, 'step')}"


def win_origins(folder: Path) -> Iterator[Origin]:
    """Return the origins of the won episodes of a data set, from the manifest where it has them.

    Args:
        folder: The data set.

    Raises:
        KinetixError: The folder is not a data set, or a shard is missing or damaged; one sentence.
    """
    for shard in read_manifest(folder).shards:
        if shard.origins is not None:
            yield from shard.origins
        else:
            yield from _origins(read_shard(folder / shard.file))


def add_episodes(folder: Path, episodes: Iterable[RecordedEpisode]) -> Added:
    """Add episodes to a data set, which is made if needed.

    Whatever ends it early, Ctrl+C too, what was taken until then is written; a kill loses a shard.

    Args:
        folder: The data set; a new or an empty folder, or one.
        episodes: Taken one by one; those that are there already are left out, and those that could
            not be read again.

    Raises:
        KinetixError: The folder holds something else, another process writes to it, or the disk
            refuses.
    """
    with _opened(folder) as manifest:
        return DatasetWriter(folder, manifest).add(episodes)


@contextlib.contextmanager
def writing(folder: Path) -> Iterator["DatasetWriter"]:
    """Open a data set for adding episodes many times; it is there from now on, if empty.

    Args:
        folder: The data set; a new or an empty folder, or one.

    Raises:
        KinetixError: The folder holds something else, or another process writes to it.
    """
    with _opened(folder) as manifest:
        _write_manifest(folder, manifest)
        yield DatasetWriter(folder, manifest)


class DatasetWriter:
    """Adds episodes to a data set: each shard is complete before the manifest names it."""

    def __init__(self, folder: Path, manifest: Manifest) -> None:
        """Take note of the episodes that are there.

        Args:
            folder: The data set, locked.
            manifest: Its manifest.
        """
        self._folder, self._manifest = folder, manifest
        shards = (folder / shard.file for shard in manifest.shards)
        try:
            self._known = {name for path in shards for name in read_ids(path)}
        except KinetixError as error:
            raise KinetixError(f"{error}; {_BRING_BACK}") from None

    def add(self, episodes: Iterable[RecordedEpisode]) -> Added:
        """Write episodes; afterwards all that were taken are on disk, also where taking one failed.

        Args:
            episodes: As for `add_episodes`.
        """
        waiting: list[RecordedEpisode] = []
        unfit: list[str] = []
        steps = added = twice = empty = 0
        try:
            for episode in episodes:
                if episode.identity in self._known or not episode.length:
                    twice, empty = twice + bool(episode.length), empty + (not episode.length)
                    continue
                if why := misfit_of(episode):
                    unfit.append(f"{episode.level.name}: left out: {why}")
                    continue
                self._known.add(episode.identity)
                waiting.append(episode)
                steps, added = steps + episode.length, added + 1
                if steps >= SHARD_STEPS:
                    self._write(waiting)
                    waiting, steps = [], 0
        finally:
            if waiting:
                self._write(waiting)
        return Added(added=added, known=twice, empty=empty, unfit=tuple(unfit))

    def _write(self, episodes: list[RecordedEpisode]) -> None:
        data = pack(episodes)
        shards = self._manifest.shards
        # A file that no manifest names may be all that is left of somebody's episodes.
        numbers = itertools.count(len(shards))
        names = (f"episodes-{number:05d}.npz" for number in numbers)
        name = next(name for name in names if not os.path.lexists(self._folder / name))
        write_atomically(self._folder / name, data)
        entry = ShardEntry(
            file=name,
            sha256=hashlib.sha256(data).hexdigest(),
            episodes=len(episodes),
            steps=sum(episode.length for episode in episodes),
            origins=_origins(episodes),
        )
        self._manifest = _manifest((*shards, entry))
        _write_manifest(self._folder, self._manifest)


def _manifest(shards: tuple[ShardEntry, ...]) -> Manifest:
    return Manifest(format=FORMAT, version=VERSION, written_by=__version__, shards=shards)


def unlisted_shards(folder: Path) -> list[Path]:
    """Return the shards that lie in a data set and that its manifest does not name.

    Args:
        folder: The data set.

    Raises:
        KinetixError: The folder is not a data set.
    """
    listed = {shard.file for shard in read_manifest(folder).shards}
    return sorted(path for path in folder.glob("*.npz") if path.name not in listed)


def _origins(episodes: Iterable[RecordedEpisode]) -> tuple[Origin, ...]:
    return tuple(dict.fromkeys(each.origin for each in episodes if each.outcome == "won"))


@contextlib.contextmanager
def _opened(folder: Path) -> Iterator[Manifest]:
    """Make the folder if needed, and hold its lock."""
    with begun_folder(folder, "another recording"):
        if os.path.isfile(folder / MANIFEST):
            yield read_manifest(folder)
            return
        if any(not entry.name.startswith(".") for entry in folder.iterdir()):
            raise KinetixError(
                f"{folder}: is not empty and holds no data set of episodes; choose another"
            )
        yield _manifest(())


def _write_manifest(folder: Path, manifest: Manifest) -> None:
    write_atomically(folder / MANIFEST, msgspec.json.format(msgspec.json.encode(manifest)))
