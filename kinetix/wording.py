"""Words for numbers of things and for values that do not fit, as messages say them."""

import re
from collections.abc import Sequence
from typing import Final

_KINDS: Final = {
    "int": "a whole number",
    "float": "a number",
    "str": "a string",
    "bool": "true or false",
    "array": "an array",
    "object": "an object",
    "null": "nothing",
}
"""Words for the types in messages of msgspec."""
_TOLD: Final = (
    (r"Expected `array` of length (\d+), got (\d+)", r"expected \1 items, got \2"),
    (r"Expected `(?:int|float)` (>=|<=|>|<) (.+)", r"expected a number \1 \2"),
    (r"Expected `str` of length (.+)", r"expected a string of length \1"),
    (r"Expected (`[^`]+`), got (`[^`]+`)", r"expected \1, got \2"),
    (r"Object missing required field `(.+)`", r"the field '\1' is missing"),
    (r"Object contains unknown field `(.+)`", r"unknown field '\1'"),
    (r"Invalid enum value (.+)", r"\1 is none of the choices"),
)
"""Patterns of messages of msgspec, and the sentences that replace them."""


def plural(count: int, noun: str, many: str = "") -> str:
    """Return a number of things: `1 joint`, `3 joints`.

    Args:
        count: How many.
        noun: One of them.
        many: Several of them, where that is not the noun with an s.
    """
    return f"{count} {noun if count == 1 else many or f'{noun}s'}"


def listed(words: Sequence[object], most: int) -> str:
    """Return the first words, and how many more there are: `a, b and 3 more`."""
    shown = ", ".join(map(str, words[:most]))
    return f"{shown} and {len(words) - most} more" if len(words) > most else shown


def thousands(number: int) -> str:
    """Return a number with a space between each three digits: `1 572 864`."""
    return f"{number:,}".replace(",", " ")


def misfit(error: Exception) -> str:
    """Return what a `msgspec.ValidationError` tells, in words without names of types.

    Args:
        error: The error; what is not known to come from msgspec is returned as it is.

    Returns:
        Such as `$.num_steps: expected a whole number, got a string`.
    """
    said, _, path = str(error).partition(" - at ")
    for pattern, words in _TOLD:
        if re.fullmatch(pattern, said):
            told = re.sub(pattern, words, said)
            told = re.sub(r"`([^`]+)`", lambda kinds: _kind(kinds[1]), told)
            told = told.replace("a whole number, got a number", "a whole number, got a fraction")
            return f"{path.strip('`')}: {told}" if path else told
    return str(error)


def _kind(name: str) -> str:
    """Name alternatives: `int | null` is a whole number or nothing."""
    return " or ".join(_KINDS.get(one, one) for one in name.split(" | "))
