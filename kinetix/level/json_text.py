"""Strict and bounded reading of JSON text: nothing in a hostile file costs much time or memory."""

import json
from pathlib import Path
from typing import Any, Final

from kinetix.errors import LevelError
from kinetix.level.faults import Fault, fail

MAX_FILE_BYTES: Final = 8 * 2**20
"""Larger files are refused unread; the largest published level has 52 kB."""


class DuplicateKeys(dict[str, Any]):
    """An object that named a key twice; `key` is the first such key."""

    key: str = ""


def read_text(path: Path, *, limit: int = MAX_FILE_BYTES) -> str:
    """The text of a file.

    Raises:
        LevelError: It cannot be read, is larger than `limit` bytes, or is not UTF-8.
    """
    try:
        with path.open("rb") as file:
            data = file.read(limit + 1)
    except OSError as error:
        raise LevelError(f"{path}: cannot be read: {error.strerror or error}") from error
    if len(data) > limit:
        fail(str(path), [_fault("$", f"expected a file of at most {limit >> 20} MiB")])
    return decode_text(data, str(path))


def decode_text(data: bytes, file: str) -> str:
    """Bytes as UTF-8 text.

    Raises:
        LevelError: They are not UTF-8.
    """
    try:
        return data.decode("utf-8")
    except UnicodeDecodeError as error:
        fail(
            file,
            [
                _fault(
                    "$", f"expected UTF-8 text, got byte {error.start} as 0x{data[error.start]:02x}"
                )
            ],
        )


def parse_json(text: str, file: str) -> Any:
    """Parse JSON.

    Objects that name a key twice become `DuplicateKeys`. NaN and infinities are read as such, so
    that the checks after this one can say where they stand.

    Raises:
        LevelError: The text is not JSON (with line and column) or nested too deeply.
    """
    if text.startswith("\ufeff"):
        fail(file, [_fault("$", "expected no byte-order mark")])
    try:
        return json.loads(text, object_pairs_hook=_object)
    except json.JSONDecodeError as error:
        where = f"line {error.lineno} column {error.colno}"
        fail(file, [_fault("$", f"not JSON, {where}: {error.msg.removesuffix(' at')}")])
    except RecursionError:
        fail(file, [_fault("$", "not a level: arrays or objects are nested too deeply")])
    except ValueError:  # Python refuses to read integers of more than 4300 digits
        fail(file, [_fault("$", "not a level: a number has thousands of digits")])


def _object(pairs: list[tuple[str, Any]]) -> dict[str, Any]:
    made = dict(pairs)
    if len(made) == len(pairs):
        return made
    repeated = DuplicateKeys(made)
    seen: set[str] = set()
    for key, _ in pairs:
        if key in seen:
            repeated.key = key
            break
        seen.add(key)
    return repeated


def _fault(path: str, message: str) -> Fault:
    return Fault(code="E001", path=path, message=message)
