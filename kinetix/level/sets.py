"""Level sets: manifests of levels with weights and a split into train and eval.

README.md describes the file. Free of JAX.
"""

import contextlib
import dataclasses
import itertools
import os
from collections.abc import Iterable, Iterator, Sequence
from pathlib import Path
from typing import Annotated, Any, Final, Literal

import msgspec
from msgspec import Meta

from kinetix.bundled import named_levels, refuse_empty
from kinetix.engine.spec import Capacity
from kinetix.errors import LevelError
from kinetix.files.limits import LIMITS, MIB
from kinetix.level.atomic import write_atomically, write_with_backup
from kinetix.level.canonical import level_tree, record_tree, tree_text
from kinetix.level.codec import (
    LEVELSET_FORMAT,
    level_from_tree,
    level_hash,
    load_document,
    resolve_path,
)
from kinetix.level.faults import EnoughFaults, FaultCollector, fail, found, refuse_all
from kinetix.level.json_text import DuplicateKeys, parse_json, read_text
from kinetix.level.model import Level, Record, SizeHint, SizeName, Tag
from kinetix.level.schema import check_tree
from kinetix.level.sizes import SIZES, capacity_of
from kinetix.wording import plural

Split = Literal["train", "eval"]

VERSION: Final = 1
MAX_LEVELS: Final = 10_000
"""Most levels of a set: a bound against hostile files."""
DEFAULT_SPLIT: Final = 0.8


class SetEntry(Record, frozen=True, kw_only=True):
    """One level of a set, by the path of its file or (with `path` None) inline."""

    path: Annotated[
        str | None,
        Meta(description="Relative to the set's folder", extra={"optional": True}),
    ] = None
    sha256: Annotated[str, Meta(min_length=64, max_length=64)]
    """`level_hash` of the level."""
    tags: tuple[Tag, ...] = ()
    weight: Annotated[float, Meta(ge=1e-6, le=1e6)] = 1.0
    """Relative probability in training."""
    split: Split = "train"


class LevelSet(Record, frozen=True, kw_only=True):
    """A manifest."""

    name: Annotated[str, Meta(min_length=1, max_length=120)]
    size: Annotated[
        SizeName | SizeHint | None,
        Meta(description="Common capacity; none: the largest of each", extra={"optional": True}),
    ] = None
    seed: int = 0
    """Seed of the split."""
    engine_version: Annotated[str, Meta(max_length=120)] = ""
    """The version that wrote the set."""
    levels: Annotated[tuple[SetEntry, ...], Meta(max_length=MAX_LEVELS)] = ()


@dataclasses.dataclass(frozen=True, kw_only=True)
class SetLevel:
    """A level that was loaded from a set, a folder or a file."""

    name: str
    """Name in reports: the path below the folder or set, without suffix."""
    level: Level
    sha256: str
    tags: tuple[str, ...] = ()
    weight: float = 1.0
    split: Split | None = None
    """Part of its set; None where it is of none: folders and files are not split."""
    path: Path | None = None
    """Its file; None when it was inline."""


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
    """The element-wise largest capacity of several levels.

    Raises:
        LevelError: There is no level.
    """
    capacity: Capacity | None = None
    for level in levels:
        own = capacity_of(level)
        capacity = own if capacity is None else capacity.union(own)
    if capacity is None:
        raise LevelError("expected at least one level, got none")
    return capacity


def is_set_file(path: Path) -> bool:
    """Return whether a JSON file is a level set; a file that cannot be read is none."""
    try:
        text = read_text(path, "set")
        if f'"{LEVELSET_FORMAT}"' not in text:  # most files are levels: tell them without parsing
            return False
        tree = parse_json(text, str(path))
    except LevelError:
        return False
    return isinstance(tree, dict) and tree.get("format") == LEVELSET_FORMAT


def load_set(path: str | Path) -> LoadedSet:
    """Read a level set and all its levels, and check every hash.

    Raises:
        LevelError: The set or one of its levels is bad, or a level is not the one that was listed.
    """
    file = resolve_path(path)
    return loads_set(read_text(file, "set"), str(file), folder=file.parent)


def loads_set(text: str, file: str, *, folder: Path) -> LoadedSet:
    """Like `load_set`, from text.

    Args:
        text: The manifest.
        file: Name for messages.
        folder: What paths in the manifest are relative to.

    Raises:
        LevelError: As for `load_set`.
    """
    tree = parse_json(text, file)
    faults = FaultCollector()
    manifest, inline = None, {}
    with contextlib.suppress(EnoughFaults):
        manifest, inline = _read_manifest(tree, file, faults)
    if manifest is None or faults.faults:
        fail(file, faults.faults)
    levels = []
    with contextlib.suppress(EnoughFaults):
        levels = _listed_levels(manifest, inline, folder, faults)
    if faults.faults:
        fail(file, faults.faults)
    return LoadedSet(manifest=manifest, levels=tuple(levels), path=Path(file))


def _listed_levels(
    manifest: LevelSet, inline: dict[int, Level], folder: Path, faults: FaultCollector
) -> list[SetLevel]:
    levels = []
    for k, entry in enumerate(manifest.levels):
        if entry.path is None:
            level, where = inline[k], None
        elif not within_reach(entry.path):
            message = f"expected a path inside the folder above the set, got {found(entry.path)}"
            faults.add("E007", f"$.levels[{k}].path", message)
            continue
        else:
            where = folder / entry.path
            try:
                level = load_document(where if where.is_absolute() else Path.cwd() / where).level
            except LevelError as error:
                faults.add("E007", f"$.levels[{k}].path", str(error))
                continue
        own = level_hash(level)
        if own != entry.sha256:
            message = f"expected the level with this hash, got one with {own}{_changed(entry)}"
            faults.add("E007", f"$.levels[{k}].sha256", message)
        levels.append(
            SetLevel(
                name=level.name if entry.path is None else _plain_name(entry.path),
                level=level,
                sha256=own,
                tags=entry.tags,
                weight=entry.weight,
                split=entry.split,
                path=where,
            )
        )
    return levels


def _plain_name(path: str) -> str:
    return path.removesuffix(".json")


def _read_manifest(
    tree: Any, file: str, faults: FaultCollector
) -> tuple[LevelSet | None, dict[int, Level]]:
    if not isinstance(tree, dict) or tree.get("format") != LEVELSET_FORMAT:
        faults.add("E002", "$", f'expected an object with "format": "{LEVELSET_FORMAT}"')
        return None, {}
    version = tree.get("version")
    if type(version) is not int or version < 1:
        faults.expect("E006", "$.version", f"a whole number 1 ≤ x ≤ {VERSION}", version)
        return None, {}
    if version > VERSION:
        faults.add("E003", "$.version", f"this set has a newer version than {VERSION}")
        return None, {}
    body = tree if isinstance(tree, DuplicateKeys) else dict(tree)
    body.pop("format", None)
    body.pop("version", None)
    inline: dict[int, Level] = {}
    entries = body.get("levels")
    if isinstance(entries, list) and len(entries) <= MAX_LEVELS:
        body["levels"] = [
            _without_level(entry, k, file, inline, faults) for k, entry in enumerate(entries)
        ]
    check_tree(body, LevelSet, "$", faults)
    if faults.faults:
        return None, {}
    manifest = msgspec.convert(body, LevelSet)
    seen: dict[str, int] = {}
    for k, entry in enumerate(manifest.levels):
        if entry.sha256 in seen:
            message = f"expected a hash of its own, levels[{seen[entry.sha256]}] has it too"
            faults.add("E008", f"$.levels[{k}].sha256", message)
        seen.setdefault(entry.sha256, k)
    return manifest, inline


def _changed(entry: SetEntry) -> str:
    if entry.path is None:
        return ""
    return f": {entry.path} has changed since the set was built; build the set again"


def _without_level(
    entry: Any, index: int, file: str, inline: dict[int, Level], faults: FaultCollector
) -> Any:
    """An entry without its inline level, which goes to `inline`."""
    path = f"$.levels[{index}]"
    if not isinstance(entry, dict):
        return entry
    if ("path" in entry) == ("level" in entry):
        faults.add("E004", path, 'expected either "path" or "level"')
        return entry
    if "level" not in entry:
        return entry
    if not isinstance(entry["level"], dict):
        faults.expect("E006", f"{path}.level", "an object", entry["level"])
    else:
        inline[index] = level_from_tree(entry["level"], file, f"{path}.level")
    rest = entry if isinstance(entry, DuplicateKeys) else dict(entry)
    del rest["level"]
    return rest


def level_files(folder: Path) -> Iterator[Path]:
    """Yield everything below a folder that is called a level, in the order of names.

    Level sets are left out; links that lead nowhere are not, so that they are told.
    """
    for path in json_files(folder):
        if not os.path.isdir(path) and not (os.path.isfile(path) and is_set_file(path)):
            yield path


def json_files(folder: Path) -> list[Path]:
    """Return what is called JSON below a folder, in the order of names.

    Folders that are hidden, or hold an agent or a training run, are left out.
    """
    found: list[Path] = []
    for place, inner, names in os.walk(folder):
        inner[:] = [name for name in inner if not name.startswith(".")]
        if "agent.json" in names or ("config.toml" in names and "checkpoints" in inner):
            inner.clear()
        else:
            found += [Path(place) / name for name in names if name.endswith(".json")]
    return sorted(found)


def place_of(source: str | Path) -> Path:
    """The path itself if there is something, else the bundled file or folder of that name."""
    path = Path(source)
    return path if os.path.exists(path) else named_levels(source) or path


def gather_levels(sources: Sequence[str | Path]) -> list[SetLevel]:
    """The levels that a command line means: folders, files, names of bundled levels, level sets.

    Args:
        sources: Each a folder (every level below it), a level file or a level set, or the name of
            one that is bundled: `s/first_flight`, `levels/s`, `sets/s`.

    Returns:
        The levels in this order, each with a name of its own: of several called `x`, which two
        folders or two titles may be, the second is `x (2)`.

    Raises:
        LevelError: Something is missing or bad, or there is no level at all.
    """
    levels, unreadable = read_levels(sources)
    refuse_all(
        [str(error) for error in unreadable.values()],
        of=len(levels) + len(unreadable),
        what="files cannot be read",
    )
    return levels


def read_levels(
    sources: Sequence[str | Path],
) -> tuple[list[SetLevel], dict[str, LevelError]]:
    """Like `gather_levels`, but the damaged files of a folder do not keep its others away.

    Returns:
        The levels, and by name what is wrong with each file of a folder that could not be read.

    Raises:
        LevelError: A source is missing, or is a damaged level or level set itself; or there is no
            level at all.
    """
    levels: list[SetLevel] = []
    unreadable: dict[str, LevelError] = {}
    for source in sources:
        refuse_empty(source, "a folder, a level or a level set")
        path = place_of(source)
        if os.path.isdir(path):
            for file in level_files(path):
                try:
                    levels.append(_from_file(file, file.relative_to(path)))
                except LevelError as error:
                    unreadable[str(file)] = error
            continue
        path = resolve_path(source)
        if is_set_file(path):
            levels += load_set(path).levels
        else:
            levels.append(_from_file(path, Path(source)))
    if not levels and not unreadable:
        named = ", ".join(map(str, sources)) or "no level was named"
        raise LevelError(f"{named}: expected levels, found none")
    return _told_apart(levels), unreadable


def _told_apart(levels: Sequence[SetLevel]) -> list[SetLevel]:
    """Return the levels with names that differ: results are told by name."""
    given = {each.name for each in levels}
    taken: set[str] = set()
    found: list[SetLevel] = []
    for each in levels:
        numbered = (f"{each.name} ({number})" for number in itertools.count(2))
        names = itertools.chain([each.name], (name for name in numbered if name not in given))
        name = next(name for name in names if name not in taken)
        taken.add(name)
        found.append(each if name == each.name else dataclasses.replace(each, name=name))
    return found


def distinct(levels: Iterable[SetLevel]) -> list[SetLevel]:
    """Return the levels without those that equal an earlier one (by hash)."""
    first: dict[str, SetLevel] = {}
    for each in levels:
        first.setdefault(each.sha256, each)
    return list(first.values())


def training_part(levels: Sequence[SetLevel]) -> list[SetLevel]:
    """Return what may be trained on: all but the evaluation parts of sets.

    Raises:
        LevelError: That is nothing.
    """
    chosen = [each for each in levels if each.split != "eval"]
    if levels and not chosen:
        raise LevelError(
            f"{plural(len(levels), 'level')} for evaluation, none to train on: draw the split "
            "anew with `kinetix levelset split SET --seed 0`, or give the levels without a set"
        )
    return chosen


def evaluation_part(levels: Sequence[SetLevel]) -> list[SetLevel]:
    """Return the evaluation parts of sets; all levels where there is none."""
    return [each for each in levels if each.split == "eval"] or list(levels)


def _from_file(path: Path, name: Path) -> SetLevel:
    level = load_document(path).level
    return SetLevel(
        name=_plain_name(name.as_posix()),
        level=level,
        sha256=level_hash(level),
        tags=level.tags,
        path=path,
    )


def within_reach(path: str) -> bool:
    """Return whether a set may name a file by this path: relative, and at most one folder up.

    So `sets/all.json` may name `../s/lamp.json`, and a set that was sent to somebody cannot have
    other files of theirs read.
    """
    plain_path = path.replace("\\", "/")
    if plain_path.startswith("/") or ":" in plain_path.split("/")[0]:
        return False
    return not f"{os.path.normpath(plain_path)}/".startswith("../../")


def path_in_set(path: Path, folder: Path) -> str | None:
    """Return how a set names a level; None where it is out of reach and must stand in the set."""
    name = relative_path(path, folder)
    return name if within_reach(name) else None


def relative_path(path: Path, folder: Path) -> str:
    """A path as a manifest in `folder` says it, with forward slashes."""
    return Path(os.path.relpath(path.resolve(), folder.resolve())).as_posix()


def dumps_set(loaded: LoadedSet, *, inline: bool = False) -> str:
    """Canonical text of a set.

    Args:
        loaded: The set.
        inline: Whether the levels themselves stand in it instead of paths; levels without a file
            and those out of the set's reach always do.
    """
    tree = {"format": LEVELSET_FORMAT, "version": VERSION} | record_tree(loaded.manifest)
    tree["levels"] = []
    for entry, each in zip(loaded.manifest.levels, loaded.levels, strict=True):
        part = record_tree(entry)
        if inline or entry.path is None:
            part.pop("path", None)
            part = {"level": level_tree(each.level)} | part
        tree["levels"].append(part)
    return tree_text(tree)


def save_set(
    loaded: LoadedSet, path: str | Path, *, inline: bool = False, backup: bool = False
) -> bool:
    """Write a set atomically.

    Args:
        loaded: The set.
        path: Its file.
        inline: As for `dumps_set`.
        backup: Whether another set that the file held stays beside it as `NAME.bak`, and an
            older such backup as `NAME.bak2`.

    Returns:
        Whether there is such a backup now.

    Raises:
        LevelError: The file cannot be written, would be too large to be read, or there is a file
            that is no set, such as one of the levels.
    """
    if os.path.isfile(path) and not is_set_file(Path(path)):
        raise LevelError(f"{path}: there is a file that is no level set; choose another name")
    data = dumps_set(loaded, inline=inline).encode()
    largest = LIMITS["set"].largest
    if len(data) > largest:
        raise LevelError(
            f"{path}: a set of more than {largest // MIB} MiB could not be read again; put it "
            "beside its levels, without --inline"
        )
    if backup:
        return write_with_backup(Path(path), data, keep_all=True)
    write_atomically(Path(path), data)
    return False
