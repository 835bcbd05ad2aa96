"""The model's facts about a number, and how fields show it."""

import dataclasses
import functools
import math
import typing
from typing import Annotated, Any, Final

import msgspec

from editor.documents.commands.fields import field_types
from kinetix.level.model import Record

DEGREES: Final = 180.0 / math.pi


@dataclasses.dataclass(frozen=True, kw_only=True)
class FieldInfo:
    """The model's facts about a number."""

    unit: str
    low: float
    high: float
    slider: tuple[float, float]
    step: float
    description: str
    integer: bool = False

    def shown_factor(self, radians: bool) -> float:
        """Shown value over stored value: angles are stored in radians, shown in degrees or not."""
        return DEGREES if self.unit in ("rad", "rad/s") and not radians else 1.0

    def shown_unit(self, radians: bool) -> str:
        """Return the unit that is shown beside the field."""
        return self.unit if radians else {"rad": "°", "rad/s": "°/s"}.get(self.unit, self.unit)


def _metas(hint: Any) -> list[msgspec.Meta]:
    found: list[msgspec.Meta] = []
    if typing.get_origin(hint) is Annotated:
        inner, *extras = typing.get_args(hint)
        found += [extra for extra in extras if isinstance(extra, msgspec.Meta)]
        found += _metas(inner)
    return found


def _stripped(hint: Any) -> Any:
    return typing.get_args(hint)[0] if typing.get_origin(hint) is Annotated else hint


def _inner_record(hint: Any, name: str) -> Any:
    """Return the record class among the alternatives of a hint that has the field."""
    hint = _stripped(hint)
    options = typing.get_args(hint) if typing.get_origin(hint) is not None else (hint,)
    for option in map(_stripped, options or (hint,)):
        record = isinstance(option, type) and issubclass(option, Record)
        if record and (name.isdigit() or name in option.__struct_fields__):
            return option
    return None


@functools.cache
def field_info(cls: type[Record], path: str) -> FieldInfo:
    """Return the model's facts about a dotted numeric field.

    Raises:
        KeyError: The class has no such field.
    """
    head, *rest = path.split(".")
    hint = field_types(cls)[head]
    while rest:
        name = rest.pop(0)
        bare = _stripped(hint)
        if typing.get_origin(bare) is tuple:
            hint = typing.get_args(bare)[0]
            continue
        inner = _inner_record(hint, name)
        if inner is None:
            raise KeyError(path)
        hint = field_types(inner)[name]
    metas = _metas(hint)
    merged: dict[str, Any] = {"ge": None, "le": None, "description": "", "extra": {}}
    for meta in metas:
        for name in merged:
            value = getattr(meta, name)
            merged[name] = merged[name] or value
    extra = merged["extra"] or {}
    low = -math.inf if merged["ge"] is None else float(merged["ge"])
    high = math.inf if merged["le"] is None else float(merged["le"])
    integer = _stripped(hint) is int
    return FieldInfo(
        unit=extra.get("unit", ""),
        low=low,
        high=high,
        slider=extra.get("slider") or (low, high),
        step=extra.get("step", 1.0 if integer else 0.01),
        description=merged["description"],
        integer=integer,
    )


def _decimals(step: float) -> int:
    return max(0, min(4, math.ceil(-math.log10(step)))) if step > 0 else 3


def _decimals_of(shown: float, info: FieldInfo, radians: bool) -> int:
    """Return how many decimals show a value without noise and lose nothing that was typed."""
    if info.integer:
        return 0
    decimals = 1 if info.shown_factor(radians) != 1.0 else max(_decimals(info.step), 2)
    for extra in range(4):
        if abs(round(shown, decimals + extra) - shown) < 1e-5:
            return decimals + extra
    return decimals + 3


def digits(value: float, info: FieldInfo, radians: bool) -> str:
    """Return a stored value as it is typed, without its unit."""
    shown = value * info.shown_factor(radians)
    return f"{shown:.{_decimals_of(shown, info, radians)}f}"


def format_of(value: float, info: FieldInfo, radians: bool) -> str:
    """Return the format of a drag field, its unit included."""
    shown, unit = value * info.shown_factor(radians), info.shown_unit(radians)
    gap = " " if unit and unit[0] != "°" else ""
    return f"%.{_decimals_of(shown, info, radians)}f{gap}{unit}"


def shown_value(value: float, info: FieldInfo, radians: bool) -> str:
    """Return a stored value as fields show it, with its unit."""
    return format_of(value, info, radians) % (value * info.shown_factor(radians))


def usual_range(info: FieldInfo, radians: bool) -> str:
    """Return the values that most levels stay within, as fields show them."""
    low, high = (bound * info.shown_factor(radians) for bound in info.slider)
    return f"{low:g} … {high:g} {info.shown_unit(radians)}".rstrip()
