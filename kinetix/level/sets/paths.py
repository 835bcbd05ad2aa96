"""Paths of the levels of a set: relative to its folder, and never outside of the folder above."""

import os
from pathlib import Path

from kinetix.files.names import is_text


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
    """Return how a set names a level; None where it must stand in the set.

    That is where it is out of reach, and where its name is not text that JSON can hold.
    """
    name = relative_path(path, folder)
    return name if within_reach(name) and is_text(name) else None


def relative_path(path: Path, folder: Path) -> str:
    """Return a path as a manifest in `folder` has it, with forward slashes."""
    return Path(os.path.relpath(path.resolve(), folder.resolve())).as_posix()


def plain_name(path: str) -> str:
    """Name of a level in reports, after its path."""
    return path.removesuffix(".json")
