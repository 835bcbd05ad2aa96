"""Read and write level files: our format and kinetix-env's, by content. No JAX."""

import contextlib
import dataclasses
import hashlib
import os
import warnings
from pathlib import Path
from typing import Any, Final, Literal

import msgspec

from kinetix.bundled import level_hint, named_levels, refuse_empty, without_permutation
from kinetix.engine.spec import Capacity
from kinetix.errors import LevelError
from kinetix.files.atomic import write_atomically
from kinetix.files.limits import LIMITS, MIB
from kinetix.level.canonical import (
    FORMAT,
    VERSION,
    level_tree,
    tree_text,
    unsayable_paths,
    version_of,
)
from kinetix.level.faults import EnoughFaults, Fault, FaultCollector, fail, found
from kinetix.level.integrity import level_faults
from kinetix.level.json_text import DuplicateKeys, decode_text, parse_json, read_text
from kinetix.level.kinetix_env.document import KinetixEnvDocument, document_from_tree, lost_fields
from kinetix.level.kinetix_env.export import from_level
from kinetix.level.kinetix_env.to_level import to_level
from kinetix.level.migrations import migrate
from kinetix.level.model import Level, Record
from kinetix.level.schema import check_tree
from kinetix.level.sizes import capacity_of

LevelFormat = Literal["kinetix-level", "kinetix-env"]
LEVELSET_FORMAT: Final = "kinetix-levelset"


@dataclasses.dataclass(frozen=True, kw_only=True)
class LoadedLevel:
    """Content of a level file."""

    level: Level
    format: LevelFormat
    """The format of the file."""
    mends: tuple[Fault, ...] = ()
    """Differences from the file that a document cannot represent."""
    lost: tuple[str, ...] = ()
    """Parts of the file that the level does not carry, one sentence each."""
    source: KinetixEnvDocument | None = None
    """kinetix-env's file as it is, slots and leftovers included; None for a native file."""
    path: Path | None = None
    """Path from which it was read."""

    @property
    def capacity(self) -> Capacity:
        """Sizes of the level: those of kinetix-env's file, or the smallest that hold it."""
        return self.source.capacity if self.source else capacity_of(self.level)

    @property
    def warnings(self) -> tuple[str, ...]:
        """Everything in which the level is not the file, one sentence each."""
        return (*(f"mended: {mend}" for mend in self.mends), *self.lost)


def resolve_path(name: str | Path) -> Path:
    """Return the file that a path or the name of a bundled level means.

    A path that exists is taken as it is, any other relative name is looked for among the bundled
    levels (`s/name`); `.json` may be left out, and where no file has the suffix `.permuteN` in its
    name, it is ignored.

    Raises:
        LevelError: The file does not exist.
    """
    if isinstance(name, Level):
        raise LevelError(f"{name!r:.60}: this is a level already, no file")
    if not isinstance(name, str | os.PathLike):
        raise LevelError(f"{name!r:.60}: expected a path or a name, got {type(name).__name__}")
    refuse_empty(name, "a level")
    plain = Path(without_permutation(name))
    written = (Path(name), Path(f"{name}.json"), plain, Path(f"{plain}.json"))
    for path in (*written, named_levels(name)):
        # Not Path.is_file, which raises where a name is too long for the file system.
        if path is not None and os.path.isfile(path):
            return path
    if os.path.isdir(plain) or named_levels(name) is not None:
        raise LevelError(f"{name}: expected a level file, got a folder")
    if os.path.exists(plain):
        raise LevelError(f"{name}: expected a regular file, got a device, pipe or socket")
    if os.path.islink(plain):
        raise LevelError(f"{name}: a link to {os.readlink(plain)}, which leads to no file")
    raise LevelError(
        f"{name}: there is no such file, nor a bundled level of this name{level_hint(name)}"
    )


def load_document(path: str | Path) -> LoadedLevel:
    """Read a level file of either format, with its data beyond the level.

    Args:
        path: A file, or the name of a bundled level such as `s/name`.

    Raises:
        LevelError: The file is missing or bad; one sentence with file and JSON path.
    """
    file = resolve_path(path)
    loaded = loads_document(read_text(file), str(file))
    return dataclasses.replace(loaded, path=file)


def load_level(path: str | Path) -> Level:
    """Read a level file, ours or kinetix-env's, distinguished by content.

    A warning lists what had to be repaired.

    Args:
        path: A file, or the name of a bundled level such as `s/name`.

    Raises:
        LevelError: The file is missing or bad; one sentence with file and JSON path.
    """
    loaded = load_document(path)
    for mend in loaded.mends:
        warnings.warn(f"{path}: mended: {mend}", stacklevel=2)
    return loaded.level


def loads_document(text: str, file: str = "text") -> LoadedLevel:
    """Like `load_document`, from text; the stem of `file` names a level of kinetix-env.

    Raises:
        LevelError: The text is bad; one sentence with file and JSON path.
    """
    tree = parse_json(text, file)
    kind = format_of(tree)
    if kind == FORMAT:
        return LoadedLevel(level=level_from_tree(tree, file), format=FORMAT)
    if kind == "kinetix-env":
        source = document_from_tree(tree, text, file)
        # A file's name may hold bytes that are no text, which a level's may not.
        name = Path(file).stem.encode(errors="replace").decode()[:120] or "level"
        level, mends, lost = to_level(source, name=name)
        return LoadedLevel(level=level, format="kinetix-env", mends=mends, lost=lost, source=source)
    faults = FaultCollector()
    if kind == LEVELSET_FORMAT:
        faults.add("E002", "$.format", "this is a level set, expected a single level")
    elif isinstance(tree, dict) and "format" in tree:
        of_sets = f' ("{LEVELSET_FORMAT}" for a level set)' if "levels" in tree else ""
        faults.expect("E002", "$.format", f'"{FORMAT}"{of_sets}', tree["format"])
    else:
        expected = f'expected a level: an object with "format": "{FORMAT}" or with "env_state"'
        faults.add("E002", "$", expected)
    fail(file, faults.faults)


def format_of(tree: Any) -> str | None:
    """Return the format that a parsed file says it has; None where it is none of ours.

    Args:
        tree: The content of a JSON file.
    """
    if not isinstance(tree, dict):
        return None
    if "format" in tree:
        return tree["format"] if tree["format"] in (FORMAT, LEVELSET_FORMAT) else None
    return "kinetix-env" if "env_state" in tree else None


def loads(text: str | bytes, file: str = "text") -> Level:
    """Return a level from the text of either format.

    Args:
        text: JSON text, or its bytes in UTF-8.
        file: Name for messages.

    Raises:
        LevelError: The text is bad; one sentence with file and JSON path.
    """
    return loads_document(decode_text(text, file) if isinstance(text, bytes) else text, file).level


def level_from_tree(tree: dict[str, Any], file: str, path: str = "$") -> Level:
    """Return a level from the parsed JSON of our format.

    Args:
        tree: The whole object, `format` and `version` included.
        file: Name for messages.
        path: Where the object stands in the file.

    Raises:
        LevelError: The JSON is not a valid level; one sentence with file and JSON path.
    """
    faults = FaultCollector()
    level = None
    with contextlib.suppress(EnoughFaults):
        level = _checked_level(tree, path, faults)
    if level is None or faults.faults:
        fail(file, faults.faults)
    return level


def _checked_level(tree: dict[str, Any], path: str, faults: FaultCollector) -> Level | None:
    if "version" not in tree:
        faults.add("E004", path, 'the key "version" is missing')
        return None
    version = tree["version"]
    if type(version) is not int or version < 1:
        faults.expect("E006", f"{path}.version", f"a whole number 1 ≤ x ≤ {VERSION}", version)
        return None
    if version > VERSION:
        faults.add(
            "E003",
            f"{path}.version",
            f"this file has version {found(version)}, newer than {VERSION}, the newest that this "
            f"program reads; a newer release may open it",
        )
        return None
    # A parsed tree hides that a key stood twice, which `check_tree` refuses.
    body = tree if isinstance(tree, DuplicateKeys) else migrate(tree, version, VERSION)
    body.pop("format", None)
    body.pop("version", None)
    check_tree(body, Level, path, faults)
    if faults.faults:
        return None
    level = msgspec.convert(body, Level)
    if version < version_of(level):
        faults.add(
            "E005",
            f"{path}.version",
            f"names of bodies, joints and thrusters came with version 2, this file says {version}",
        )
    for fault in level_faults(level):
        faults.add(fault.code, path + fault.path[1:], fault.message)
    return level


def dumps(
    level: Level,
    *,
    format: LevelFormat = FORMAT,
    source: KinetixEnvDocument | None = None,
) -> str:
    """Return the text of a level file.

    Args:
        level: The document.
        format: `kinetix-level`: our canonical text. `kinetix-env`: kinetix-env's JSON.
        source: The file of kinetix-env that the level was read from. Where the level still equals
            it, its text comes out byte for byte, unused slots and all.

    Raises:
        LevelError: The format of kinetix-env cannot hold the level, JSON cannot (a number is not
            finite, a text is no Unicode), or the text is larger than a reader takes; whatever else
            is wrong with a level can be saved.
    """
    text = _text_of(level, format, source)
    size, largest = len(text.encode()), LIMITS["level"].largest
    if size > largest:
        hint = "" if format == FORMAT else f", or write it as {FORMAT}"
        raise LevelError(
            f"level {level.name!r} cannot be written: expected at most {largest // MIB} MiB of "
            f"{format}, got {size / MIB:.1f} MiB; give it fewer parts{hint}"
        )
    return text


def _text_of(level: Level, format: LevelFormat, source: KinetixEnvDocument | None) -> str:
    tree = level_tree(level)
    for path in unsayable_paths(tree):
        raise LevelError(f"level {level.name!r} cannot be written: {path} is no JSON value")
    if format == FORMAT:
        return tree_text(tree)
    if format != "kinetix-env":
        raise LevelError(f"format {format!r}: expected 'kinetix-level' or 'kinetix-env'")
    if source is not None and _unchanged(level, source):
        return source.text
    return from_level(level)[0]


def _unchanged(level: Level, source: KinetixEnvDocument) -> bool:
    imported, _, _ = to_level(source, name=level.name)
    return imported.replace(next_id=level.next_id) == level.unnamed()


def save_level(
    level: Level,
    path: str | Path,
    format: LevelFormat = FORMAT,
    *,
    source: KinetixEnvDocument | None = None,
) -> tuple[str, ...]:
    """Write a level file atomically: afterwards it holds the old or the new content, never a mix.

    Args:
        level: The document.
        path: The file; its folder must exist.
        format: As in `dumps`.
        source: As in `dumps`.

    Returns:
        The names of the fields that the format cannot hold; empty for our own format.

    Raises:
        LevelError: `level` is not a level, or one that could not be read again; the file cannot be
            written, or the format cannot hold the level. The file is unchanged then.
    """
    if isinstance(path, Level):
        raise LevelError("the order is save_level(level, path)")
    if not isinstance(path, str | os.PathLike):
        raise LevelError(f"path {path!r:.60}: expected the name of a file")
    path = Path(path)
    if not isinstance(level, Level):
        raise LevelError(
            f"{path}: expected a kinetix.Level to save, got {type(level).__name__}; "
            "kinetix.level_of(state, name=…) makes one of a state"
        )
    check_level(level, f"{path}: this level cannot be written")
    write_atomically(path, dumps(level, format=format, source=source).encode())
    return () if format == FORMAT else lost_fields(level, stem=path.stem)


def check_level(level: Level, name: str) -> None:
    """Refuse a level that no reader would take.

    Args:
        level: A level that was made in Python, where anything can be.
        name: Begins the sentence.

    Raises:
        LevelError: The level has a fault; one sentence with the JSON path of what is wrong.
    """
    level_from_tree(_sayable_tree(level, name), name)


def check_computable(level: Level) -> None:
    """Refuse a level that nothing can be computed of; it may be larger than files allow.

    Args:
        level: A level that was made in Python, where anything can be.

    Raises:
        LevelError: The level has a fault; one sentence with the JSON path of what is wrong.
    """
    name = f"level {level.name!r}"
    tree = _sayable_tree(level, name)
    del tree["format"], tree["version"]
    faults = FaultCollector(beyond_files=True)
    with contextlib.suppress(EnoughFaults):
        check_tree(tree, Level, "$", faults)
    broken = faults.faults or tuple(level_faults(level))
    if broken:
        fail(name, broken)


def _sayable_tree(level: Level, name: str) -> dict[str, Any]:
    """Return a level as JSON, where each of its values has one."""
    for kind in ("bodies", "joints", "thrusters"):
        parts = getattr(level, kind)
        if not (isinstance(parts, tuple) and all(isinstance(part, Record) for part in parts)):
            raise LevelError(f"{name}: $.{kind}: expected a sequence of Kinetix's {kind}")
    tree = level_tree(level)
    for path in unsayable_paths(tree):
        raise LevelError(f"{name}: {path}: expected a finite number, or text that is Unicode")
    return tree


def level_hash(level: Level) -> str:
    """SHA-256 of what a level is, whatever its name, history and solution (hexadecimal).

    The canonical text without names, description, tags, next_id and solution, ids renumbered in
    list order.
    """
    numbers = {entity.id: k for k, entity in enumerate(level.entities(), start=1)}
    tree = level_tree(level.unnamed())
    for key in ("name", "description", "tags", "next_id", "solution"):
        tree.pop(key, None)
    for kind in ("bodies", "joints", "thrusters"):
        for part in tree[kind]:
            for key in ("id", "a", "b", "body"):
                if isinstance(part.get(key), int):
                    part[key] = numbers.get(part[key], -part[key])
    return hashlib.sha256(tree_text(tree).encode()).hexdigest()
