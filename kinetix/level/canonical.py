"""Canonical text of documents: equal levels are equal bytes."""

import json
import math
from collections.abc import Iterator
from typing import Any, Final

import msgspec
import numpy as np

from kinetix.files.names import is_text
from kinetix.level.model import Level, Record, round_real

FORMAT: Final = "kinetix-level"
VERSION: Final = 2
"""The newest version of the format. Each level is written in the oldest one that can hold it."""

_INDENT: Final = "  "
_ON_ONE_LINE: Final = frozenset(
    {"shape", "motor", "limits", "mass_properties", "floor", "left_wall", "right_wall", "ceiling"}
)


def real_text(value: float) -> str:
    """The shortest decimal that reads back to the same binary32 value, with point or exponent.

    A reader parses the text as binary64 and rounds; where those two roundings would miss, the full
    binary64 digits are written.
    """
    short = str(np.float32(value))
    return short if round_real(float(short)) == value else repr(float(value))


def record_tree(record: Record) -> dict[str, Any]:
    """Return a part of the model as dictionaries and lists, in the order of the format's tables."""
    tree: dict[str, Any] = {}
    if record.__struct_config__.tag is not None:
        tree[str(record.__struct_config__.tag_field)] = record.__struct_config__.tag
    defaults = _optional_keys(type(record))
    for name in record.__struct_fields__:
        value = getattr(record, name)
        if value is not None or name not in defaults:
            tree[name] = _value_tree(value)
    return tree


def version_of(level: Level) -> int:
    """Return the oldest version of the format that can hold a level: names came with version 2."""
    return 2 if any(entity.name is not None for entity in level.entities()) else 1


def level_tree(level: Level) -> dict[str, Any]:
    """Return a level as it stands in a file, format and version included."""
    return {"format": FORMAT, "version": version_of(level)} | record_tree(level)


def unsayable_paths(tree: Any, path: str = "$") -> Iterator[str]:
    """Return the paths that JSON cannot express: numbers that are not finite, broken Unicode."""
    if isinstance(tree, dict):
        for name, value in tree.items():
            yield from unsayable_paths(value, f"{path}.{name}")
    elif isinstance(tree, list):
        for k, value in enumerate(tree):
            yield from unsayable_paths(value, f"{path}[{k}]")
    elif isinstance(tree, float):
        if not math.isfinite(tree):
            yield path
    elif isinstance(tree, str) and not is_text(tree):
        yield path


def _value_tree(value: Any) -> Any:
    if isinstance(value, Record):
        return record_tree(value)
    if isinstance(value, tuple):
        return [_value_tree(item) for item in value]
    return value.item() if isinstance(value, np.generic) else value


def _optional_keys(cls: type[Record]) -> frozenset[str]:
    """Return the keys that are left out where the value is None."""
    if cls not in _OPTIONAL:
        fields = msgspec.inspect.type_info(cls).fields  # pyright: ignore[reportAttributeAccessIssue]
        _OPTIONAL[cls] = frozenset(
            field.name
            for field in fields
            if (getattr(field.type, "extra", None) or {}).get("optional")
        )
    return _OPTIONAL[cls]


_OPTIONAL: dict[type[Record], frozenset[str]] = {}


def tree_text(tree: Any) -> str:
    """Return a tree in canonical layout, with one newline at the end.

    One key a line, two spaces of indent; on one line stay arrays of numbers, strings or pairs,
    each run of a solution, and the small objects in `_ON_ONE_LINE`.
    """
    return _layout(tree, "", 0) + "\n"


def _layout(value: Any, key: str, depth: int) -> str:
    inner, outer = _INDENT * (depth + 1), _INDENT * depth
    if isinstance(value, dict):
        if not value or key in _ON_ONE_LINE:
            return _on_one_line(value)
        lines = [
            f"{inner}{_text(name)}: {_layout(part, name, depth + 1)}"
            for name, part in value.items()
        ]
        return "{\n" + ",\n".join(lines) + "\n" + outer + "}"
    if isinstance(value, list) and value and (key == "actions" or isinstance(value[0], dict)):
        lines = [f"{inner}{_element(part, key, depth + 1)}" for part in value]
        return "[\n" + ",\n".join(lines) + "\n" + outer + "]"
    return _on_one_line(value)


def _element(value: Any, key: str, depth: int) -> str:
    return _on_one_line(value) if key == "actions" else _layout(value, "", depth)


def _on_one_line(value: Any) -> str:
    if isinstance(value, dict):
        return "{" + ", ".join(f"{_text(k)}: {_on_one_line(v)}" for k, v in value.items()) + "}"
    if isinstance(value, list):
        return "[" + ", ".join(map(_on_one_line, value)) + "]"
    return real_text(value) if isinstance(value, float) else _text(value)


def _text(value: Any) -> str:
    return json.dumps(value, ensure_ascii=False)
