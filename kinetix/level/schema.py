"""Checks parsed JSON against the annotations of the model: all faults, each with its path.

msgspec itself stops at the first fault and words it for programmers; so this walks the same
annotations first, and msgspec then builds the values.
"""

import difflib
import functools
import math
import re
from collections.abc import Iterable
from typing import Any, Final

import msgspec
from msgspec import inspect

from kinetix.files.names import is_text
from kinetix.level.faults import FaultCollector, bounds_text
from kinetix.level.json_text import DuplicateKeys
from kinetix.level.limits import LARGEST_REAL
from kinetix.level.model import Level, Limits, Motor

REQUIRED: Final[dict[type[msgspec.Struct], set[str]]] = {
    Level: {"next_id"},
    Motor: set(Motor.__struct_fields__),
    Limits: set(Limits.__struct_fields__),
}
"""Fields that code may leave out and a file may not."""


@functools.cache
def _type_of(cls: type[msgspec.Struct]) -> inspect.Type:
    return inspect.type_info(cls)


def check_tree(tree: Any, cls: type[msgspec.Struct], path: str, faults: FaultCollector) -> None:
    """Compare parsed JSON with a part of the model.

    Args:
        tree: Parsed JSON.
        cls: The part, such as `Level` or `Body`.
        path: Where the tree stands in the file.
        faults: Takes the codes E004–E007.

    Raises:
        EnoughFaults: There are as many as a reader reports.
    """
    _check(tree, _type_of(cls), path, faults)


def _check(value: Any, kind: inspect.Type, path: str, faults: FaultCollector) -> None:
    _CHECKS[type(kind)](value, kind, path, faults)


def _check_object(value: Any, kind: Any, path: str, faults: FaultCollector) -> None:
    if not isinstance(value, dict):
        faults.expect("E006", path, "an object", value)
        return
    check_keys(value, [field.name for field in kind.fields], path, faults, tag=kind.tag_field)
    required = REQUIRED.get(kind.cls, set())
    for field in kind.fields:
        if field.name in value:
            _check_field(value[field.name], field.type, f"{path}.{field.name}", faults)
        elif field.required or field.name in required:
            faults.add("E004", path, f'the key "{field.name}" is missing')


def check_keys(
    value: dict[str, Any],
    known: Iterable[str],
    path: str,
    faults: FaultCollector,
    *,
    tag: str | None = None,
) -> None:
    """Unknown keys (with the nearest known one) and keys that stand twice: E005.

    Raises:
        EnoughFaults: There are as many as a reader reports.
    """
    names = [*known, tag] if tag else [*known]
    if isinstance(value, DuplicateKeys):
        faults.add("E005", f"{path}.{value.key[:60]}", "the key stands twice")
    for key in value:
        if key not in names:
            near = difflib.get_close_matches(key[:60], names, n=1)
            hint = f', did you mean "{near[0]}"?' if near else f", known are {', '.join(names)}"
            faults.add("E005", f"{path}.{key[:60]}", f"unknown key{hint}")


def _check_field(value: Any, kind: inspect.Type, path: str, faults: FaultCollector) -> None:
    if isinstance(kind, inspect.Metadata):
        if value is None and kind.extra and kind.extra.get("optional"):
            faults.add("E006", path, "expected a value, got null; leave the key out instead")
            return
        kind = kind.type
    _check(value, kind, path, faults)


def _check_metadata(value: Any, kind: Any, path: str, faults: FaultCollector) -> None:
    _check(value, kind.type, path, faults)


def _check_union(value: Any, kind: Any, path: str, faults: FaultCollector) -> None:
    parts = [part.type if isinstance(part, inspect.Metadata) else part for part in kind.types]
    if value is None and any(isinstance(part, inspect.NoneType) for part in parts):
        return
    if isinstance(value, dict):
        structs = [part for part in parts if isinstance(part, inspect.StructType)]
        if len(structs) == 1:
            _check_object(value, structs[0], path, faults)
            return
        tagged = {struct.tag: struct for struct in structs}
        if tagged:
            _check_tagged(value, tagged, path, faults)
            return
    fitting = {str: (inspect.LiteralType, inspect.StrType), int: (inspect.IntType,)}
    for part in parts:
        if isinstance(part, fitting.get(type(value), ())):
            _check(value, part, path, faults)
            return
    faults.expect("E006", path, " or ".join(dict.fromkeys(map(_name, parts))), value)


def _check_tagged(
    value: dict[str, Any], tagged: dict[Any, Any], path: str, faults: FaultCollector
) -> None:
    field = next(iter(tagged.values())).tag_field
    tag = value.get(field)
    if isinstance(tag, str) and tag in tagged:
        _check_object(value, tagged[tag], path, faults)
    elif field not in value:
        faults.add("E004", path, f'the key "{field}" is missing')
    else:
        faults.expect("E007", f"{path}.{field}", _choices(tagged), tag)


def _name(kind: inspect.Type) -> str:
    if isinstance(kind, inspect.LiteralType):
        return _choices(kind.values)
    names: dict[type[Any], str] = {
        inspect.NoneType: "null",
        inspect.StructType: "an object",
        inspect.IntType: "a whole number",
    }
    return names.get(type(kind), "a value")


def _choices(values: Iterable[Any]) -> str:
    *others, last = (f'"{value}"' for value in values)
    return f"{', '.join(others)} or {last}" if others else last


def _check_literal(value: Any, kind: Any, path: str, faults: FaultCollector) -> None:
    if not isinstance(value, str):
        faults.expect("E006", path, _choices(kind.values), value)
    elif value not in kind.values:
        faults.expect("E007", path, _choices(kind.values), value)


def _check_tuple(value: Any, kind: Any, path: str, faults: FaultCollector) -> None:
    if not isinstance(value, list) or len(value) != len(kind.item_types):
        faults.expect("E006", path, f"an array of {len(kind.item_types)}", value)
    else:
        for k, (item, item_kind) in enumerate(zip(value, kind.item_types, strict=True)):
            _check(item, item_kind, f"{path}[{k}]", faults)


def _check_list(value: Any, kind: Any, path: str, faults: FaultCollector) -> None:
    if not isinstance(value, list):
        faults.expect("E006", path, "an array", value)
        return
    low, high = kind.min_length or 0, kind.max_length or math.inf
    if not low <= len(value) <= high:
        faults.expect("E007", path, f"{bounds_text(low, high)} elements", value)
        return
    for k, item in enumerate(value):
        _check(item, kind.item_type, f"{path}[{k}]", faults)


def _check_real(value: Any, kind: Any, path: str, faults: FaultCollector) -> None:
    if type(value) not in (float, int):
        faults.expect("E006", path, "a number", value)
    elif not abs(value) <= LARGEST_REAL:
        faults.expect("E007", path, "a finite 32-bit number", value)
    elif not (_is_possible if faults.beyond_files else _is_within)(value, kind.ge, kind.le):
        faults.expect("E007", path, bounds_text(kind.ge, kind.le), value)


def _is_within(value: float, low: float | None, high: float | None) -> bool:
    return (low is None or value >= low) and (high is None or value <= high)


def _is_possible(value: float, low: float | None, high: float | None) -> bool:
    """Return whether it can be computed with, however large: its sign, and a share of 0 to 1."""
    if low is None or high is None or low < 0:
        return True
    is_share = (low, high) == (0, 1)
    return (value > 0 if low else value >= 0) and (value <= high or not is_share)


def _check_integer(value: Any, kind: Any, path: str, faults: FaultCollector) -> None:
    if type(value) is not int:
        faults.expect("E006", path, "a whole number", value)
    elif (kind.ge is not None and value < kind.ge) or (kind.le is not None and value > kind.le):
        faults.expect("E007", path, bounds_text(kind.ge, kind.le), value)


def _check_text(value: Any, kind: Any, path: str, faults: FaultCollector) -> None:
    if not isinstance(value, str):
        faults.expect("E006", path, "a string", value)
        return
    low, high = kind.min_length or 0, kind.max_length or math.inf
    if not low <= len(value) <= high:
        faults.add("E007", path, f"expected {low} to {high} characters, got {len(value)}")
    elif kind.pattern and not re.fullmatch(kind.pattern, value):
        faults.expect("E007", path, "only the characters a-z 0-9 - _", value)
    elif not is_text(value):
        faults.add("E007", path, "expected Unicode text, got half of a surrogate pair")


def _check_flag(value: Any, kind: Any, path: str, faults: FaultCollector) -> None:
    if type(value) is not bool:
        faults.expect("E006", path, "true or false", value)


_CHECKS: dict[type[Any], Any] = {
    inspect.StructType: _check_object,
    inspect.Metadata: _check_metadata,
    inspect.UnionType: _check_union,
    inspect.LiteralType: _check_literal,
    inspect.TupleType: _check_tuple,
    inspect.VarTupleType: _check_list,
    inspect.FloatType: _check_real,
    inspect.IntType: _check_integer,
    inspect.StrType: _check_text,
    inspect.BoolType: _check_flag,
}
