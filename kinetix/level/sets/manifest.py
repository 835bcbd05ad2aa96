"""The manifest of a level set: its levels, their weights, and the split into train and eval."""

import dataclasses
import functools
from collections.abc import Iterable
from pathlib import Path
from typing import Annotated, Final, Literal

from msgspec import Meta

from kinetix.engine.spec import Capacity
from kinetix.errors import LevelError
from kinetix.level.codec import level_hash
from kinetix.level.model import Level, Record, SizeHint, SizeName, Tag
from kinetix.level.sizes import SIZES, capacity_of

Split = Literal["train", "eval"]

VERSION: Final = 1
MAX_LEVELS: Final = 10_000
"""Most levels of a set: a bound against hostile files."""
LONGEST_NAME: Final = 120
"""Characters of a set's name."""
DEFAULT_SPLIT: Final = 0.8


class SetEntry(Record, frozen=True, kw_only=True):
    """One level of a set, by the path of its file or (with `path` None) inline."""

    path: Annotated[
        str | None,
        Meta(description="Relative to the set's folder", extra={"optional": True}),
    ] = None
    sha256: Annotated[
        str,
        Meta(
            min_length=64,
            max_length=64,
            description="Hash of the level, whatever the form of its file",
        ),
    ]
    tags: tuple[Tag, ...] = ()
    weight: Annotated[
        float, Meta(ge=1e-6, le=1e6, description="Relative probability in training")
    ] = 1.0
    split: Split = "train"


class LevelSet(Record, frozen=True, kw_only=True):
    """A manifest."""

    name: Annotated[str, Meta(min_length=1, max_length=LONGEST_NAME)]
    size: Annotated[
        SizeName | SizeHint | None,
        Meta(description="Common capacity; none: the largest of each", extra={"optional": True}),
    ] = None
    seed: Annotated[int, Meta(description="Seed of the split")] = 0
    engine_version: Annotated[
        str, Meta(max_length=120, description="Version of Kinetix that wrote the set")
    ] = ""
    levels: Annotated[tuple[SetEntry, ...], Meta(max_length=MAX_LEVELS)] = ()


@dataclasses.dataclass(frozen=True, kw_only=True)
class SetLevel:
    """A level that was loaded from a set, a folder or a file."""

    name: str
    """Name in reports: the path below the folder or set, without suffix."""
    level: Level
    tags: tuple[str, ...] = ()
    weight: float = 1.0
    split: Split | None = None
    """Part of its set; None where it is of none: folders and files are not split."""
    path: Path | None = None
    """Its file; None when it was inline."""
    native: bool = True
    """False where the file is kinetix-env's, whose slots and leftovers a document does not keep."""

    @functools.cached_property
    def sha256(self) -> str:
        """`level_hash` of the level."""
        return level_hash(self.level)

    @property
    def played(self) -> Level | Path:
        """The level to play: the document, or kinetix-env's file, which has more data."""
        return self.level if self.native or self.path is None else self.path


@dataclasses.dataclass(frozen=True, kw_only=True)
class LoadedSet:
    """A manifest with its levels."""

    manifest: LevelSet
    levels: tuple[SetLevel, ...]
    path: Path | None = None

    @property
    def capacity(self) -> Capacity:
        """The common capacity: the manifest's, else the largest of each level's."""
        size = self.manifest.size
        if isinstance(size, str):
            return SIZES[size]
        if size is not None:
            return Capacity(
                polygons=size.polygons,
                circles=size.circles,
                joints=size.joints,
                thrusters=size.thrusters,
            )
        return common_capacity(each.level for each in self.levels)


def common_capacity(levels: Iterable[Level]) -> Capacity:
    """Return the element-wise largest capacity of several levels.

    Raises:
        LevelError: No level is given.
    """
    capacity: Capacity | None = None
    for level in levels:
        own = capacity_of(level)
        capacity = own if capacity is None else capacity.union(own)
    if capacity is None:
        raise LevelError("expected at least one level, got none")
    return capacity
