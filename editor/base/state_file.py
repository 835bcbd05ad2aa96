"""One JSON object in the user's state folder: what the editor keeps from one run to the next."""

import json
from collections.abc import Mapping
from pathlib import Path
from typing import Any

from kinetix.errors import LevelError
from kinetix.files.atomic import write_atomically
from kinetix.files.json_text import parse
from kinetix.files.regular import FileError, read_text


def read_state(path: Path) -> dict[str, Any]:
    """Return the content of a file; nothing where it is absent, broken or no JSON object."""
    try:
        tree = parse(read_text(path, "kept"), path)
    except FileError:
        return {}
    return tree if isinstance(tree, dict) else {}


def write_state(path: Path, tree: Mapping[str, Any]) -> None:
    """Write a file whole, making its folder where there is none.

    Raises:
        LevelError: It cannot be written.
    """
    try:
        path.parent.mkdir(parents=True, exist_ok=True)
    except OSError as error:
        raise LevelError(f"{path}: cannot be saved: {error.strerror or error}") from error
    write_atomically(path, json.dumps(tree, indent=1).encode())
