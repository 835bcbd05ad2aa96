"""Level sets put together: equal levels once, none with an error, split by a seed."""

import dataclasses
import hashlib
from collections.abc import Sequence
from pathlib import Path

from kinetix.errors import LevelError
from kinetix.level.faults import refuse_all
from kinetix.level.model import SizeHint, SizeName
from kinetix.level.sets.manifest import (
    DEFAULT_SPLIT,
    LevelSet,
    LoadedSet,
    SetEntry,
    SetLevel,
    Split,
)
from kinetix.level.sets.parts import distinct
from kinetix.level.sets.paths import path_in_set
from kinetix.level.sets.problems import set_level_issues
from kinetix.level.sizes import needed_capacity
from kinetix.version import __version__


def build_set(
    levels: Sequence[SetLevel],
    *,
    name: str,
    folder: Path,
    size: SizeName | SizeHint | None = None,
    split: float = DEFAULT_SPLIT,
    seed: int = 0,
) -> LoadedSet:
    """Return a set of levels: equal ones once, none with an error, split by the seed.

    Args:
        levels: What goes in; of equal levels (by hash) the first stays, with the largest weight of
            them.
        name: Name of the set.
        folder: Where the set will be saved; paths are relative to it.
        size: Common capacity, when it shall be other than the largest of each.
        split: Share of the levels that go to training, 0 … 1.
        seed: What the split is drawn from.

    Raises:
        LevelError: A level has an error, or does not fit the common capacity.
    """
    chosen = _once(levels)
    _refuse_errors(chosen)
    entries = tuple(
        SetEntry(
            path=None if each.path is None else path_in_set(each.path, folder),
            sha256=each.sha256,
            tags=each.tags,
            weight=each.weight,
        )
        for each in chosen
    )
    made = LoadedSet(
        manifest=LevelSet(name=name, size=size, engine_version=__version__, levels=entries),
        levels=tuple(chosen),
    )
    _refuse_larger(made)
    return split_set(made, split=split, seed=seed)


def _once(levels: Sequence[SetLevel]) -> list[SetLevel]:
    """Return equal levels once: the first, with the largest weight of them."""
    largest: dict[str, float] = {}
    for each in levels:
        largest[each.sha256] = max(each.weight, largest.get(each.sha256, 0.0))
    kept = distinct(levels)
    return [dataclasses.replace(each, weight=largest[each.sha256]) for each in kept]


def _refuse_errors(levels: Sequence[SetLevel]) -> None:
    """Refuse levels with errors, and name them at once.

    Raises:
        LevelError: Some levels have errors.
    """
    wrong = []
    for each in levels:
        errors = [issue for issue in set_level_issues(each) if issue.severity == "error"]
        if errors:
            first = errors[0]
            wrong.append(f"{each.path or each.name}: {first.path}: {first.code} {first.message}")
    refuse_all(wrong, of=len(levels), what="levels have errors")


def _refuse_larger(made: LoadedSet) -> None:
    """Refuse a level that does not fit the set's size.

    Raises:
        LevelError: A level does not fit.
    """
    capacity = made.capacity if made.levels else None
    for each in made.levels:
        if capacity is not None and not capacity.covers(needed_capacity(each.level)):
            raise LevelError(f"{each.path or each.name}: does not fit the size of the set")


def split_set(loaded: LoadedSet, *, split: float, seed: int) -> LoadedSet:
    """Return the set with a new random split; levels keep their paths as the set names them.

    Raises:
        LevelError: The share is not between 0 and 1.
    """
    chosen = draw_split([each.sha256 for each in loaded.levels], share=split, seed=seed)
    levels = tuple(dataclasses.replace(each, split=chosen[each.sha256]) for each in loaded.levels)
    entries = tuple(entry.replace(split=chosen[entry.sha256]) for entry in loaded.manifest.levels)
    manifest = loaded.manifest.replace(seed=seed, levels=entries)
    return dataclasses.replace(loaded, manifest=manifest, levels=levels)


def draw_split(hashes: Sequence[str], *, share: float, seed: int) -> dict[str, Split]:
    """Return the levels for training; the split depends on hashes and seed alone.

    Both parts get a level where there are two or more and the share is neither 0 nor 1; a level
    alone is for training then.

    Raises:
        LevelError: The share is not between 0 and 1.
    """
    if not 0.0 <= share <= 1.0:
        raise LevelError(f"split {share}: expected 0 ≤ x ≤ 1")
    ranked = sorted(hashes, key=lambda one: hashlib.sha256(f"{seed}:{one}".encode()).digest())
    count = round(share * len(ranked))
    if 0.0 < share < 1.0 and ranked:
        count = max(min(count, len(ranked) - 1), 1)
    return {one: "train" if k < count else "eval" for k, one in enumerate(ranked)}
