"""Rules for options: numbers as people write them; the help names types, and defaults if any."""

import dataclasses
import re
import types
from collections.abc import Callable
from typing import Annotated, Any, Final, Union, get_args, get_origin

import tyro
from tyro.constructors import (
    ConstructorRegistry,
    PrimitiveConstructorSpec,
    PrimitiveTypeInfo,
    StructConstructorSpec,
    StructTypeInfo,
    UnsupportedTypeAnnotationError,
)

OPTIONS: Final = ConstructorRegistry()
"""Rules for options of all commands, in addition to tyro's."""
_EXPONENT: Final = re.compile(r"\d+(\.\d+)?[eE]\+?\d{1,2}")

_NOTHING: Final = ("", "None", "False")
"""Defaults that say no more than that an option is left out."""
_UNDER_WAY: Final[list[type]] = []
"""Commands whose fields are being read."""


@OPTIONS.struct_rule
def _command(info: StructTypeInfo) -> StructConstructorSpec | None:
    """Return a command as tyro reads it, but for defaults that say nothing in its help."""
    if not dataclasses.is_dataclass(info.type) or info.type in _UNDER_WAY:
        return None
    _UNDER_WAY.append(info.type)
    try:
        spec = OPTIONS.get_struct_spec(info)
    finally:
        _UNDER_WAY.pop()
    if not isinstance(spec, StructConstructorSpec):
        return None
    shown = tyro.conf.arg(help_behavior_hint=_shown_default)
    fields = [
        dataclasses.replace(field, type=Annotated[field.type, shown]) for field in spec.fields
    ]
    return dataclasses.replace(spec, fields=tuple(fields))


def _shown_default(default: str) -> str:
    return "" if default in _NOTHING else f"(default: {default})"


@OPTIONS.primitive_rule
def _optional(info: PrimitiveTypeInfo) -> PrimitiveConstructorSpec[Any] | None:
    """Return a type or nothing: the type."""
    inner = _without_none(info.type)
    if inner is None:
        return None
    spec = OPTIONS.get_primitive_spec(PrimitiveTypeInfo.make(inner, info.markers))
    if isinstance(spec, UnsupportedTypeAnnotationError):
        return None
    return dataclasses.replace(
        spec,
        is_instance=lambda value: value is None or spec.is_instance(value),
        str_from_instance=lambda value: (
            ["None"] if value is None else spec.str_from_instance(value)
        ),
    )


def _whole(word: str) -> int:
    if _EXPONENT.fullmatch(word) and (number := float(word)).is_integer():
        return int(number)
    try:
        return int(word)
    except ValueError:
        raise ValueError(f"expected a whole number, got {word!r}") from None


def _real(word: str) -> float:
    try:
        return float(word)
    except ValueError:
        raise ValueError(f"expected a number, got {word!r}") from None


_NUMBERS: Final[dict[type, tuple[str, Callable[[str], Any], tuple[type, ...]]]] = {
    int: ("INT", _whole, (int,)),
    float: ("FLOAT", _real, (int, float)),
}
"""By type: its name in the help, how a word is read, and the types of values."""


@OPTIONS.primitive_rule
def _number(info: PrimitiveTypeInfo) -> PrimitiveConstructorSpec[Any] | None:
    """Return a number; a large whole one also as people write it: `1e6`."""
    found = _NUMBERS.get(info.type) if isinstance(info.type, type) else None
    if found is None:
        return None
    name, read, kinds = found
    return PrimitiveConstructorSpec(
        nargs=1,
        metavar=name,
        instance_from_str=lambda words: read(words[0]),
        is_instance=lambda value: isinstance(value, kinds) and not isinstance(value, bool),
        str_from_instance=lambda value: [str(value)],
    )


def _without_none(kind: Any) -> Any:
    """Return the one type that a union with None holds; None where it is something else."""
    if get_origin(kind) not in (Union, types.UnionType):
        return None
    inner = [one for one in get_args(kind) if one is not types.NoneType]
    return inner[0] if len(inner) == 1 and len(get_args(kind)) == 2 else None
