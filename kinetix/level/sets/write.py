"""Level sets written to files, atomically."""

import os
from pathlib import Path

from kinetix.errors import LevelError
from kinetix.files.atomic import write_atomically, write_with_backup
from kinetix.files.limits import LIMITS, MIB
from kinetix.level.canonical import level_tree, record_tree, tree_text
from kinetix.level.codec import LEVELSET_FORMAT, load_document
from kinetix.level.sets.manifest import LONGEST_NAME, VERSION, LoadedSet
from kinetix.level.sets.read import check_manifest, is_set_file


def dumps_set(loaded: LoadedSet, *, inline: bool = False) -> str:
    """Return the canonical text of a set.

    Args:
        loaded: The set.
        inline: Whether the levels themselves stand in it instead of paths; levels without a file
            and those out of the set's reach always do.

    Raises:
        LevelError: The set could not be read again: its name is too long, or it has too many
            levels.
    """
    check_manifest(loaded.manifest, f"set {loaded.manifest.name[:LONGEST_NAME]!r}")
    tree = {"format": LEVELSET_FORMAT, "version": VERSION} | record_tree(loaded.manifest)
    tree["levels"] = []
    for entry, each in zip(loaded.manifest.levels, loaded.levels, strict=True):
        part = record_tree(entry)
        if inline or entry.path is None:
            part.pop("path", None)
            part = {"level": level_tree(each.level)} | part
        tree["levels"].append(part)
    return tree_text(tree)


def inline_losses(loaded: LoadedSet, *, inline: bool = False) -> list[str]:
    """Return what is lost of kinetix-env files when their levels are written into a set's file.

    Args:
        loaded: The set.
        inline: As for `dumps_set`.

    Returns:
        One sentence per such file that has more than its level, or that was repaired.

    Raises:
        LevelError: A file is gone or damaged since it was read.
    """
    told: list[str] = []
    for entry, each in zip(loaded.manifest.levels, loaded.levels, strict=True):
        if each.native or each.path is None or not (inline or entry.path is None):
            continue
        if warnings := load_document(each.path).warnings:
            told.append(f"{each.path}: put into the set; {'; '.join(warnings)}")
    return told


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
        LevelError: The file cannot be written, could not be read again, or there is a file that is
            no set, such as one of the levels.
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
