"""Names of level sets, and of the levels beside them that they name."""

import os
from collections.abc import Iterable, Sequence
from pathlib import Path

from editor.gallery.filing import bundled
from kinetix.errors import LevelError
from kinetix.level.json_text import parse_json, read_text


def sets_naming(paths: Sequence[Path], sets: Iterable[Path]) -> list[Path]:
    """Return the sets that name one of some files by its path.

    Args:
        paths: Level files.
        sets: Where to look; those that came with the app name none of the user's levels.
    """
    asked = {os.path.realpath(path) for path in paths}
    return [
        each
        for each in sets
        # A set reaches no farther than the folder above its own.
        if any(path.is_relative_to(each.parent.parent) for path in paths)
        and not bundled(each)
        and asked & _named(each)
    ]


def set_name(path: Path) -> str:
    """Return what a set is called in lists: by its file, or by the folder that it fills."""
    return path.parent.name if path.stem == "set" else path.stem


def _named(file: Path) -> set[str]:
    """Return the files that a set names; none where it cannot be read."""
    try:
        text = read_text(file, "set")
        if '"path"' not in text:  # it carries its levels, which can be many
            return set()
        tree = parse_json(text, str(file))
    except LevelError:
        return set()
    levels = tree.get("levels") if isinstance(tree, dict) else None
    entries = levels if isinstance(levels, list) else []
    paths = [entry.get("path") for entry in entries if isinstance(entry, dict)]
    return {os.path.realpath(file.parent / path) for path in paths if isinstance(path, str)}
