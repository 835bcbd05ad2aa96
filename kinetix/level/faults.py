"""Faults of a file: codes with JSON paths, collected and reported in one sentence."""

import dataclasses
import json
import math
from collections.abc import Sequence
from typing import Any, Final, NoReturn

from kinetix.errors import LevelError

MOST_FAULTS: Final = 20
"""A reader gives up after so many."""
_LONGEST: Final = 60
_NAMED: Final = 3
"""Files that one sentence names."""


@dataclasses.dataclass(frozen=True, kw_only=True)
class Fault:
    """One thing that is wrong in a file."""

    code: str
    """E001 … E013, see README.md."""
    path: str
    """JSON path such as `$.bodies[3].friction`."""
    message: str
    """Sentence: what was expected and what was found."""

    def __str__(self) -> str:
        return f"{self.path}: {self.message}"


class EnoughFaults(Exception):
    """Ends a check early; caught where the collector was made."""


class FaultCollector:
    """Gathers faults while a tree is checked."""

    def __init__(self, *, beyond_files: bool = False) -> None:
        """Begin without faults.

        Args:
            beyond_files: Whether reals may be larger than a file's, as what is made in Python may.
        """
        self.faults: list[Fault] = []
        self.beyond_files = beyond_files

    def add(self, code: str, path: str, message: str) -> None:
        """Note a fault.

        Raises:
            EnoughFaults: There are as many as a reader reports.
        """
        self.faults.append(Fault(code=code, path=path, message=message))
        if len(self.faults) >= MOST_FAULTS:
            raise EnoughFaults

    def expect(self, code: str, path: str, expected: str, value: Any) -> None:
        """Note that something else was expected.

        Raises:
            EnoughFaults: There are as many as a reader reports.
        """
        self.add(code, path, f"expected {expected}, got {found(value)}")


def fail(file: str, faults: Sequence[Fault]) -> NoReturn:
    """Raise one sentence for a file that has faults.

    Raises:
        LevelError: Always.
    """
    others = len(faults) - 1
    more = (
        f" (and {others} more: {'; '.join(fault.path for fault in faults[1:4])})" if others else ""
    )
    raise LevelError(f"{file}: {faults[0]}{more}", tuple(faults))


def refuse_all(wrong: Sequence[str], *, of: int, what: str) -> None:
    """Raise one sentence for several files, if there are any.

    Args:
        wrong: What is wrong with each, with its name.
        of: Files that were looked at.
        what: What `wrong` has in common: `levels have errors`.

    Raises:
        LevelError: `wrong` is not empty.
    """
    if len(wrong) == 1:
        raise LevelError(wrong[0])
    if wrong:
        more = [f"and {len(wrong) - _NAMED} more"] if len(wrong) > _NAMED else []
        listed = "; ".join([*wrong[:_NAMED], *more])
        raise LevelError(f"{len(wrong)} of {of} {what}: {listed}")


def found(value: Any) -> str:
    """A value of a file in a few words, for the end of a sentence."""
    if isinstance(value, dict):
        return "an object"
    if isinstance(value, (list, tuple)):
        return f"an array of {len(value)}"
    if isinstance(value, float) and not math.isfinite(value):
        return "a number that is not finite"
    text = json.dumps(value, ensure_ascii=True)
    return text if len(text) <= _LONGEST else f"{text[:_LONGEST]}…"


def bounds_text(low: float | None, high: float | None) -> str:
    """Return limits in the form `0 ≤ x ≤ 10`."""
    left = "" if low is None else f"{low:g} ≤ "
    right = "" if high is None else f" ≤ {high:g}"
    return f"{left}x{right}"
