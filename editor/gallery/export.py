"""Level sets from chosen levels: the same code as `kinetix levelset`, with weights and copies."""

import collections
import contextlib
import dataclasses
import functools
import itertools
import os
from collections.abc import Iterator, Mapping
from pathlib import Path
from typing import Literal

from editor.gallery.filing import stem_of
from kinetix.errors import LevelError
from kinetix.files.atomic import write_with_backup
from kinetix.level.codec import dumps, load_document
from kinetix.level.model import Level, SizeName
from kinetix.level.sets import DEFAULT_SPLIT, LoadedSet, SetLevel, build_set, draw_split, save_set

Form = Literal["file", "folder"]


@dataclasses.dataclass(frozen=True, kw_only=True)
class SetPlan:
    """Form in which a set is to be written."""

    name: str = "levels"
    form: Form = "file"
    """One file that carries its levels, or a folder with the levels beside the manifest."""
    split: float = DEFAULT_SPLIT
    """Share of the levels that go to training."""
    seed: int = 0
    """Seed of the split."""
    size: SizeName | None = None
    """Common capacity; None: the largest of each."""


def plan_of(loaded: LoadedSet) -> SetPlan:
    """Return a plan that writes a set as it is: name, size, and split if that was drawn.

    Levels keep their part as long as they stay the same.
    """
    manifest, count = loaded.manifest, len(loaded.levels)
    train = sum(each.split == "train" for each in loaded.levels)
    return SetPlan(
        name=manifest.name,
        split=train / count if count else DEFAULT_SPLIT,
        seed=manifest.seed,
        size=manifest.size if isinstance(manifest.size, str) else None,
    )


def splits_alike(loaded: LoadedSet, plan: SetPlan) -> bool:
    """Return whether a plan puts every level of a set into the part that it has there."""
    hashes = [each.sha256 for each in loaded.levels]
    drawn = draw_split(hashes, share=plan.split, seed=plan.seed)
    return all(drawn[each.sha256] == each.split for each in loaded.levels)


def export_set(levels: Mapping[Path, float], plan: SetPlan, target: Path) -> LoadedSet:
    """Write a set: equal levels once, none with an error, split by the seed.

    Args:
        levels: Files with their weights, in the order wanted.
        plan: How.
        target: The file, or with `form` "folder" the folder, which gets `set.json` and the levels.

    Returns:
        What was written.

    Raises:
        LevelError: A level is bad, does not fit the size, something cannot be written, or could
            not be read again: then no new file stays. What was overwritten stays as
            `NAME.json.bak`, and older backups of it as `NAME.json.bak2`, `NAME.json.bak3`.
    """
    chosen = [_read(path, weight) for path, weight in levels.items()]
    folder = target.parent if plan.form == "file" else target
    made = build_set(
        chosen, name=plan.name, folder=folder, size=plan.size, split=plan.split, seed=plan.seed
    )
    if plan.form == "file":
        save_set(made, target, inline=True, backup=True)
        return made
    with _new_files(folder) as new:
        placed = _copies(made, folder, new)
        made = build_set(
            placed, name=plan.name, folder=folder, size=plan.size, split=plan.split, seed=plan.seed
        )
        save_set(made, folder / "set.json", backup=True)
    return made


def unpack(loaded: LoadedSet, folder: Path) -> dict[Path, float]:
    """Write the levels that a set carries as files of their own; nothing is overwritten.

    Returns:
        The files with their weights.

    Raises:
        LevelError: A level cannot be written: then none stays.
    """
    levels = tuple(dataclasses.replace(one, name=stem_of(one.name)) for one in loaded.levels)
    named = dataclasses.replace(loaded, levels=levels)
    with _new_files(folder) as new:
        placed = _copies(named, folder, new)
    return {each.path: each.weight for each in placed if each.path is not None}


@contextlib.contextmanager
def _new_files(folder: Path) -> Iterator[list[Path]]:
    """Make a folder and give a list of the files that are new in it: a failure removes them."""
    fresh, new = not os.path.isdir(folder), []
    try:
        folder.mkdir(parents=True, exist_ok=True)
    except OSError as error:
        raise LevelError(f"{folder}: cannot be made: {error.strerror or error}") from error
    try:
        yield new
    except LevelError:
        with contextlib.suppress(OSError):
            for path in new:
                path.unlink(missing_ok=True)
            if fresh:
                folder.rmdir()
        raise


def _copies(made: LoadedSet, folder: Path, new: list[Path]) -> list[SetLevel]:
    """Give every level a file in the folder, under names that differ, and note the new files.

    Levels that lie there stay where they are, and no file gets another content. Names that differ
    in upper and lower case alone are one file on some disks.
    """
    there = {each.path for each in made.levels if each.path and _lies_in(each.path, folder)}
    taken = {"set", *(path.stem.casefold() for path in there)}
    numbers = collections.defaultdict(functools.partial(itertools.count, 2))
    placed = []
    for each in made.levels:
        if each.path in there:
            placed.append(each)
            continue
        name = stem = Path(each.name).name
        while name.casefold() in taken or not _may_have(folder / f"{name}.json", each.level):
            name = f"{stem}_{next(numbers[stem.casefold()])}"
        taken.add(name.casefold())
        path = folder / f"{name}.json"
        if not os.path.lexists(path):
            new.append(path)
            write_with_backup(path, dumps(each.level).encode(), keep_all=True)
        placed.append(dataclasses.replace(each, path=path, name=name, native=True))
    return placed


def _lies_in(path: Path, folder: Path) -> bool:
    """Return whether a level's file is one of the folder's that a set can name."""
    return path.stem.casefold() != "set" and path.parent.resolve() == folder.resolve()


def _may_have(path: Path, level: Level) -> bool:
    """Return whether a level can be written without taking the place of another."""
    return not os.path.lexists(path) or _holds(path, level)


def _holds(path: Path, level: Level) -> bool:
    """Return whether a file has the level already: a set may go where its levels are."""
    try:
        return load_document(path.resolve()).level == level
    except LevelError:
        return False


def _read(path: Path, weight: float) -> SetLevel:
    loaded = load_document(path.resolve())
    return SetLevel(
        name=path.stem,
        level=loaded.level,
        tags=loaded.level.tags,
        weight=weight,
        path=path,
        native=loaded.source is None,
    )
