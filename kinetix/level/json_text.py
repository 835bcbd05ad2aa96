"""Reading of level files: the bounded readers of `kinetix.files`, with errors of levels."""

from pathlib import Path
from typing import Any

from kinetix.errors import LevelError
from kinetix.files import json_text, regular
from kinetix.files.json_text import DuplicateKeys
from kinetix.files.limits import Kind
from kinetix.files.regular import FileError
from kinetix.level.faults import Fault

__all__ = ["DuplicateKeys", "decode_text", "parse_json", "read_text"]


def read_text(path: Path, kind: Kind = "level") -> str:
    """Return the text of a file.

    Raises:
        LevelError: The file cannot be read, is too large, or is not UTF-8.
    """
    try:
        return regular.read_text(path, kind)
    except FileError as error:
        raise _level_error(error) from error


def decode_text(data: bytes, file: str) -> str:
    """Decode bytes as UTF-8 text.

    Raises:
        LevelError: The bytes are not UTF-8.
    """
    try:
        return regular.decode_text(data, file)
    except FileError as error:
        raise _level_error(error) from error


def parse_json(text: str, file: str) -> Any:
    """Parse JSON as `kinetix.files.json_text.parse` does.

    Raises:
        LevelError: The text is not JSON (with line and column) or nested too deeply.
    """
    try:
        return json_text.parse(text, file)
    except FileError as error:
        raise _level_error(error) from error


def _level_error(error: FileError) -> LevelError:
    fault = Fault(code="E001", path="$", message=error.reason)
    return LevelError(f"{error.file}: {fault}", (fault,))
