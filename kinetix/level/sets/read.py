"""Level sets read from files: strictly, with every fault of every level named."""

import contextlib
from pathlib import Path
from typing import Any

import msgspec

from kinetix.errors import LevelError
from kinetix.level.canonical import record_tree, unsayable_paths
from kinetix.level.codec import (
    LEVELSET_FORMAT,
    level_from_tree,
    load_document,
    resolve_path,
)
from kinetix.level.faults import EnoughFaults, FaultCollector, fail, found
from kinetix.level.json_text import DuplicateKeys, parse_json, read_text
from kinetix.level.model import Level
from kinetix.level.schema import check_tree
from kinetix.level.sets.manifest import (
    MAX_LEVELS,
    VERSION,
    LevelSet,
    LoadedSet,
    SetEntry,
    SetLevel,
)
from kinetix.level.sets.paths import plain_name, within_reach


def is_set_file(path: Path) -> bool:
    """Return whether a JSON file is a level set; a file that cannot be read is not."""
    try:
        text = read_text(path, "set")
        if f'"{LEVELSET_FORMAT}"' not in text:  # parsing most levels would be wasted
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


def read_set(path: str | Path) -> tuple[LoadedSet, dict[str, LevelError]]:
    """Like `load_set`, but the levels are taken as they are, and damaged files left out.

    Returns:
        The set, and by the path in it what is wrong with each level that cannot be read.

    Raises:
        LevelError: The set itself is bad.
    """
    file = resolve_path(path)
    manifest, inline = _manifest_in(read_text(file, "set"), str(file))
    levels, unreadable = [], {}
    for k, entry in enumerate(manifest.levels):
        try:
            levels.append(_level_of(entry, inline.get(k), file.parent))
        except LevelError as error:
            unreadable[str(entry.path)] = error
    return LoadedSet(manifest=manifest, levels=tuple(levels), path=file), unreadable


def check_manifest(manifest: LevelSet, file: str) -> None:
    """Refuse a manifest that could not be read again.

    Args:
        manifest: To be written.
        file: Name for messages.

    Raises:
        LevelError: Something in it is out of range, or it has too many levels.
    """
    faults = FaultCollector()
    tree = record_tree(manifest)
    with contextlib.suppress(EnoughFaults):
        for path in unsayable_paths(tree):
            faults.add("E006", path, "expected text that UTF-8 can hold, and finite numbers")
        check_tree(tree, LevelSet, "$", faults)
    if faults.faults:
        fail(file, faults.faults)


def loads_set(text: str, file: str, *, folder: Path) -> LoadedSet:
    """Read a set from text, as `load_set` does from a file.

    Args:
        text: The manifest.
        file: Name for messages.
        folder: What paths in the manifest are relative to.

    Raises:
        LevelError: As for `load_set`.
    """
    manifest, inline = _manifest_in(text, file)
    faults = FaultCollector()
    levels = []
    with contextlib.suppress(EnoughFaults):
        levels = _listed_levels(manifest, inline, folder, faults)
    if faults.faults:
        fail(file, faults.faults)
    return LoadedSet(manifest=manifest, levels=tuple(levels), path=Path(file))


def _manifest_in(text: str, file: str) -> tuple[LevelSet, dict[int, Level]]:
    """Return a manifest and, by their places, the levels that it carries itself."""
    tree = parse_json(text, file)
    faults = FaultCollector()
    manifest, inline = None, {}
    with contextlib.suppress(EnoughFaults):
        manifest, inline = _read_manifest(tree, file, faults)
    if manifest is None or faults.faults:
        fail(file, faults.faults)
    return manifest, inline


def _listed_levels(
    manifest: LevelSet, inline: dict[int, Level], folder: Path, faults: FaultCollector
) -> list[SetLevel]:
    levels = []
    for k, entry in enumerate(manifest.levels):
        try:
            each = _level_of(entry, inline.get(k), folder)
        except LevelError as error:
            faults.add("E007", f"$.levels[{k}].path", str(error))
            continue
        if each.sha256 != entry.sha256:
            message = f"expected the level with this hash, got one with {each.sha256}"
            faults.add("E007", f"$.levels[{k}].sha256", f"{message}{_changed(entry)}")
        levels.append(each)
    return levels


def _level_of(entry: SetEntry, inline: Level | None, folder: Path) -> SetLevel:
    """Return a level of a set, whatever its hash.

    Args:
        entry: What the manifest says of it.
        inline: The level, where the manifest carries it.
        folder: The manifest's.

    Raises:
        LevelError: The file cannot be read, or is out of the set's reach.
    """
    if entry.path is None:
        assert inline is not None
        level, where, native, name = inline, None, True, inline.name
    elif not within_reach(entry.path):
        raise LevelError(
            f"expected a path inside the folder above the set, got {found(entry.path)}"
        )
    else:
        where = folder / entry.path
        loaded = load_document(where if where.is_absolute() else Path.cwd() / where)
        level, native, name = loaded.level, loaded.source is None, plain_name(entry.path)
    return SetLevel(
        name=name,
        level=level,
        tags=entry.tags,
        weight=entry.weight,
        split=entry.split,
        path=where,
        native=native,
    )


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


def _without_level(
    entry: Any, index: int, file: str, inline: dict[int, Level], faults: FaultCollector
) -> Any:
    """Return an entry without its inline level, which goes to `inline`."""
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


def _changed(entry: SetEntry) -> str:
    if entry.path is None:
        return ""
    return f": {entry.path} has changed since the set was built; build the set again"
