"""Bounded parsing of JSON: depth, digits, repeated keys, numbers that are not finite."""

import json
import math
import re
from collections.abc import Iterator
from pathlib import Path
from typing import Any, Final

from kinetix.files.limits import DEPTH, LARGEST_INTEGER, Kind
from kinetix.files.names import is_text
from kinetix.files.regular import FileError, read_text

# A string that does not end counts as one: otherwise every quote in it would be tried in turn.
_STRINGS: Final = re.compile(r'"[^"\\]*+(?:\\.[^"\\]*+)*+(?:"|\\?\Z)', re.DOTALL)
_PAIRS: Final = re.compile(r"\[\]|\{\}")
_NO_BRACKETS: Final = re.compile(r"[^\[\]{}]+")


class DuplicateKeys(dict[str, Any]):
    """An object that named a key twice; `key` is the first such key."""

    key: str = ""


def read_json(path: Path, kind: Kind) -> Any:
    """Read a JSON file strictly: see `parse_strictly`.

    Raises:
        FileError: The file cannot be read, or is not valid.
    """
    return parse_strictly(read_text(path, kind), path)


def read_object(path: Path, kind: Kind) -> dict[str, Any]:
    """Like `read_json`, of a file whose top level is an object.

    Raises:
        FileError: The file cannot be read, is not valid, or does not hold an object.
    """
    tree = read_json(path, kind)
    if not isinstance(tree, dict):
        raise FileError(path, f"$: expected an object, got {type(tree).__name__}")
    return tree


def parse_strictly(text: str, file: str | Path) -> Any:
    """Parse JSON and refuse what other readers would understand in another way.

    Args:
        text: JSON text.
        file: Its name, for the sentence.

    Raises:
        FileError: The text is not JSON, is nested too deeply, names a key twice, or has a number
            that is not finite or beyond 64 bits, or text that is not Unicode; the message says
            where.
    """
    tree = parse(text, file)
    for path, problem in _oddities(tree, "$"):
        raise FileError(file, f"{path}: {problem}")
    return tree


def parse(text: str, file: str | Path) -> Any:
    """Parse JSON, leaving to the caller what a schema can say better.

    Objects that name a key twice become `DuplicateKeys`. NaN and infinities are read as such, so
    that the checks after this one can say where they stand.

    Args:
        text: JSON text.
        file: Its name, for the sentence.

    Raises:
        FileError: The text is not JSON (with line and column), or is nested too deeply.
    """
    if text.startswith("\ufeff"):
        raise FileError(file, "expected no byte-order mark")
    if _too_deep(text):
        raise FileError(file, f"arrays or objects are nested too deeply (more than {DEPTH} levels)")
    try:
        return json.loads(text, object_pairs_hook=_object)
    except json.JSONDecodeError as error:
        where = f"line {error.lineno} column {error.colno}"
        raise FileError(file, f"not JSON, {where}: {error.msg.removesuffix(' at')}") from None
    except RecursionError:  # the caller itself stands deep
        raise FileError(file, "arrays or objects are nested too deeply") from None
    except ValueError:  # Python refuses to read integers of more than 4300 digits
        raise FileError(file, "a number has thousands of digits") from None


def _too_deep(text: str) -> bool:
    """Return whether brackets stand more than `DEPTH` deep; for no JSON any answer will do.

    Innermost pairs are taken away again and again: far less work than a loop over characters.
    """
    brackets = _NO_BRACKETS.sub("", _STRINGS.sub("", text))
    for _ in range(DEPTH):
        inner = _PAIRS.sub("", brackets)
        if len(inner) == len(brackets):
            return False  # what is left does not match: the parser says where
        brackets = inner
    return bool(brackets)


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


def _oddities(value: Any, path: str) -> Iterator[tuple[str, str]]:
    """Yield places of a tree that other readers would understand in another way, and why."""
    if isinstance(value, dict):
        if isinstance(value, DuplicateKeys):
            yield f"{path}.{value.key[:60]}", "the key stands twice"
        for name, part in value.items():
            yield from _oddities(name, path)
            yield from _oddities(part, f"{path}.{name[:60]}")
    elif isinstance(value, list):
        for k, part in enumerate(value):
            yield from _oddities(part, f"{path}[{k}]")
    elif isinstance(value, str) and not is_text(value):
        yield path, "expected Unicode text, got half of a surrogate pair"
    elif isinstance(value, float) and not math.isfinite(value):
        yield path, "expected a finite number"
    elif isinstance(value, int) and abs(value) > LARGEST_INTEGER:
        yield path, "expected a whole number of at most 64 bits"
