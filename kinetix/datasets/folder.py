"""A data set: a folder of shards and a manifest with their hashes, to which episodes are added."""

import dataclasses
import hashlib
from collections.abc import Iterable, Iterator
from pathlib import Path
from typing import Final

import msgspec

from kinetix.datasets.episode import RecordedEpisode
from kinetix.datasets.shard import FORMAT, VERSION, pack, read_ids, read_shard
from kinetix.errors import KinetixError
from kinetix.files.json_text import read_json
from kinetix.files.lock import locked_folder
from kinetix.files.regular import read_bytes
from kinetix.level.atomic import write_atomically
from kinetix.version import __version__

MANIFEST: Final = "dataset.json"
SHARD_STEPS: Final = 262_144
"""Environment steps after which a new shard begins (about 2 MB)."""


class ShardEntry(msgspec.Struct, frozen=True, kw_only=True):
    """A shard in the manifest."""

    file: str
    sha256: str
    episodes: int
    steps: int


class Manifest(msgspec.Struct, frozen=True, kw_only=True):
    """Content of `dataset.json`."""

    format: str = FORMAT
    version: int = VERSION
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


def read_manifest(folder: Path) -> Manifest:
    """Return what a data set says of itself.

    Args:
        folder: The data set.

    Raises:
        KinetixError: There is no data set, or its manifest is bad; one sentence.
    """
    path = folder / MANIFEST
    if not path.is_file():
        raise KinetixError(f"{folder}: expected a data set of episodes ({MANIFEST}), found none")
    try:
        manifest = msgspec.convert(read_json(path, "kept"), Manifest)
    except msgspec.ValidationError as error:
        raise KinetixError(f"{path}: {error}") from None
    if manifest.format != FORMAT:
        raise KinetixError(f"{path}: $.format: expected {FORMAT!r}, got {manifest.format!r}")
    if manifest.version != VERSION:
        raise KinetixError(f"{path}: $.version: expected {VERSION}, got {manifest.version}")
    for k, shard in enumerate(manifest.shards):
        if Path(shard.file).name != shard.file:
            raise KinetixError(f"{path}: $.shards[{k}].file: expected a name without a folder")
    return manifest


def read_dataset(folder: Path, *, check: bool = True) -> Iterator[RecordedEpisode]:
    """Read the episodes of a data set, shard after shard.

    Args:
        folder: The data set.
        check: Compare each shard with its hash first.

    Raises:
        KinetixError: There is no data set, or a shard is missing or damaged; one sentence.
    """
    for shard in read_manifest(folder).shards:
        path = folder / shard.file
        if check and hashlib.sha256(read_bytes(path, "episodes")).hexdigest() != shard.sha256:
            raise KinetixError(f"{path}: is not the file that {MANIFEST} names (SHA-256 differs)")
        yield from read_shard(path)


def add_episodes(folder: Path, episodes: Iterable[RecordedEpisode]) -> Added:
    """Add episodes to a data set, which is made where there is none; stopping loses one shard.

    Each shard is complete on disk before the manifest names it.

    Args:
        folder: The data set; a new or an empty folder, or one.
        episodes: Taken one by one; those that are there already are left out.

    Raises:
        KinetixError: The folder holds something else, another process writes to it, or the disk
            refuses.
    """
    manifest = _opened(folder)
    with locked_folder(folder, "another recording"):
        known = {name for shard in manifest.shards for name in read_ids(folder / shard.file)}
        waiting: list[RecordedEpisode] = []
        steps = added = twice = empty = 0
        for episode in episodes:
            if episode.identity in known or not episode.length:
                twice, empty = twice + bool(episode.length), empty + (not episode.length)
                continue
            known.add(episode.identity)
            waiting.append(episode)
            steps, added = steps + episode.length, added + 1
            if steps >= SHARD_STEPS:
                manifest = _write(folder, manifest, waiting)
                waiting, steps = [], 0
        if waiting:
            manifest = _write(folder, manifest, waiting)
    return Added(added=added, known=twice, empty=empty)


def _opened(folder: Path) -> Manifest:
    try:
        folder.mkdir(parents=True, exist_ok=True)
        entries = [entry for entry in folder.iterdir() if not entry.name.startswith(".")]
    except OSError as error:
        raise KinetixError(f"{folder}: cannot be written: {error.strerror or error}") from error
    if (folder / MANIFEST).is_file() or not entries:
        return read_manifest(folder) if entries else Manifest()
    raise KinetixError(f"{folder}: is not empty and holds no data set of episodes; choose another")


def _write(folder: Path, manifest: Manifest, episodes: list[RecordedEpisode]) -> Manifest:
    data = pack(episodes)
    name = f"episodes-{len(manifest.shards):05d}.npz"
    write_atomically(folder / name, data)
    entry = ShardEntry(
        file=name,
        sha256=hashlib.sha256(data).hexdigest(),
        episodes=len(episodes),
        steps=sum(episode.length for episode in episodes),
    )
    manifest = Manifest(written_by=__version__, shards=(*manifest.shards, entry))
    write_atomically(folder / MANIFEST, msgspec.json.format(msgspec.json.encode(manifest)))
    return manifest
