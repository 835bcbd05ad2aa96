"""Checks of the arguments of `LevelBuilder`: the options of a body, and single numbers."""

import math
import typing
from typing import Any, Final

import numpy as np

from kinetix.errors import LevelError, plain
from kinetix.level.model import COLLISIONS, MAX_NAME, ROLES, Collision, Point, Role


class BodyFields(typing.TypedDict, total=False):
    """Options of every shape besides its place and size."""

    angle: float
    """Turn around the centre of mass [rad]."""
    velocity: Point
    """Velocity at the start [m/s]."""
    angular_velocity: float
    """Angular velocity at the start [rad/s]."""
    density: float
    """Mass per area [kg/m²]."""
    friction: float
    """A pair of bodies has the coefficient 0.4·√(f_a² + f_b²)."""
    restitution: float
    """0 … 1; a pair has the smaller of the two."""
    fixed: bool
    """Nothing moves it."""
    role: Role
    collision: Collision
    name: str | None
    """Name for people, of 1 to 60 characters; the editor shows it."""


_LARGEST: Final = 1e18
"""Of any number; squares of it and their sums are finite in 32 bits."""
_CHOICES: Final[dict[str, tuple[str, ...]]] = {"role": ROLES, "collision": COLLISIONS}
_RANGES: Final[dict[str, tuple[float, float]]] = {
    "angle": (-math.inf, math.inf),
    "angular_velocity": (-math.inf, math.inf),
    "friction": (0.0, math.inf),
    "restitution": (0.0, 1.0),
}


def check_fields(fields: dict[str, Any]) -> None:
    """Refuse unknown names and values that no body can have; numbers become floats.

    Args:
        fields: Options by name, changed in place.

    Raises:
        TypeError: A name is unknown.
        LevelError: A value cannot be.
    """
    unknown = [name for name in fields if name not in BodyFields.__annotations__]
    if unknown:
        raise TypeError(
            f"unexpected argument {unknown[0]!r}: expected {', '.join(BodyFields.__annotations__)}"
        )
    for name, value in fields.items():
        if name in _CHOICES and value not in _CHOICES[name]:
            raise LevelError(f"{name} {value!r}: expected one of {', '.join(_CHOICES[name])}")
        if name in _RANGES:
            fields[name] = real(name, value, *_RANGES[name])
    if "name" in fields:
        check_name(fields["name"])
    if "velocity" in fields:
        fields["velocity"] = pair("velocity", fields["velocity"])
    if "density" in fields:
        fields["density"] = size("density", fields["density"])
    if "fixed" in fields:
        if not isinstance(fields["fixed"], bool | np.bool_):
            raise LevelError(f"fixed {fields['fixed']!r}: expected True or False")
        fields["fixed"] = bool(fields["fixed"])


def check_name(name: Any) -> str | None:
    """Return a name for people, or None.

    Raises:
        LevelError: It is no string of 1 to 60 characters.
    """
    if name is not None and not (isinstance(name, str) and 1 <= len(name) <= MAX_NAME):
        raise LevelError(f"name {name!r:.80}: expected 1 to {MAX_NAME} characters")
    return name


def real(name: str, value: Any, low: float = -math.inf, high: float = math.inf) -> float:
    """Return a value as a number.

    Args:
        name: What the caller knows it as.
        value: What the caller passed.
        low: Least number that will do.
        high: Greatest one.

    Raises:
        LevelError: The value is not a number, not finite, or out of bounds.
    """
    try:
        number = float(value)
    except (TypeError, ValueError):
        raise LevelError(f"{name} {value!r}: expected a number") from None
    except OverflowError:  # an integer of hundreds of digits
        number = math.inf
    if not math.isfinite(number):
        raise LevelError(f"{name} {plain(repr(value), 80)}: expected a finite number")
    if abs(number) > _LARGEST:
        raise LevelError(f"{name} {value!r}: expected at most {_LARGEST:g} in size")
    if not low <= number <= high:
        bound = f"at least {low:g}" if math.isinf(high) else f"{low:g} … {high:g}"
        raise LevelError(f"{name} {value!r}: expected {bound}")
    return number


def number_below(name: str, value: Any, count: int) -> int:
    """Return a value as a whole number from 0 to below a count; numpy's count as such.

    Raises:
        LevelError: The value is not such a number: a truth value is not, nor is 1.0.
    """
    whole = isinstance(value, int | np.integer) and not isinstance(value, bool)
    if not whole or not 0 <= value < count:
        raise LevelError(f"{name} {value!r}: expected 0 … {count - 1}")
    return int(value)


def size(name: str, value: Any) -> float:
    """Return a value as a number above 0.

    Raises:
        LevelError: The value is not a number above 0.
    """
    number = real(name, value)
    if number <= 0:
        raise LevelError(f"{name} {value!r}: expected more than 0")
    return number


def pair(name: str, values: Any) -> Point:
    """Return two values as numbers, x and y.

    Raises:
        LevelError: `values` are not two numbers.
    """
    try:
        x, y = values
    except (TypeError, ValueError):
        raise LevelError(f"{name} {values!r}: expected two numbers, x and y") from None
    return real(name, x), real(name, y)
