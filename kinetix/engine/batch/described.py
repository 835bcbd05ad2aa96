"""Stable text descriptions of our values: equal text means an equal program in any process."""

import dataclasses
import enum
from typing import Any, Final

_PLAIN: Final = (bool, int, float, str, type(None))


class NotOurs(Exception):
    """A value is of somebody else's class, whose code may change between two runs."""


def described(value: Any) -> str:
    """Describe a value so that equal descriptions mean equal programs.

    Args:
        value: A number, a text, a tuple, or an instance of a dataclass or an enumeration of ours.

    Raises:
        NotOurs: It is, or holds, something else.
    """
    if type(value) in _PLAIN:
        return repr(value)
    if type(value) is tuple:
        return f"({', '.join(described(part) for part in value)})"
    kind = type(value)
    if not kind.__module__.startswith("kinetix.") or "<locals>" in kind.__qualname__:
        raise NotOurs
    name = f"{kind.__module__}.{kind.__qualname__}"
    if isinstance(value, enum.Enum):
        return f"{name}.{value.name}"
    if not dataclasses.is_dataclass(value):
        raise NotOurs
    fields = dataclasses.fields(value)
    return f"{name}({', '.join(f'{f.name}={described(getattr(value, f.name))}' for f in fields)})"
