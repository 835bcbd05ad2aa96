"""Bounds of numbers in parameters and configurations, a row for fields that share one.

Only numbers of Python and numpy are looked at: arrays may be traced, or a batch.
"""

import numbers
from collections.abc import Callable, Iterable
from typing import Any, Final, NamedTuple

from kinetix.errors import KinetixError

_ABSENT: Final = object()

LAST_SEED: Final = 2**32 - 1
"""The largest seed of JAX's generator; the smallest is 0."""


class Bound(NamedTuple):
    """Fields that share a bound, its words in messages, and the test."""

    names: tuple[str, ...]
    expected: str
    holds: Callable[[Any], bool]


def check_bounds(record: Any, bounds: Iterable[Bound], prefix: str = "") -> None:
    """Refuse a record with a number out of its bounds.

    Args:
        record: Any; fields that it lacks are left out.
        bounds: The rows.
        prefix: Before the field's name in the sentence (`env_params.`).

    Raises:
        KinetixError: The sentence names the field.
    """
    for bound in bounds:
        for name in bound.names:
            value = getattr(record, name, _ABSENT)
            is_array = hasattr(value, "shape") and not isinstance(value, numbers.Number)
            if value is _ABSENT or is_array:
                continue
            try:
                good = bound.holds(value)
            except (TypeError, ValueError):
                good = False
            if not good:
                raise KinetixError(f"{prefix}{name}: expected {bound.expected}, got {value!r}")
