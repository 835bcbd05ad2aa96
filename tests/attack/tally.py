"""Tally of attacks: inputs tried, and faults found."""

import dataclasses
import hashlib
import resource
import traceback
from collections.abc import Callable
from pathlib import Path
from typing import Any

from kinetix.errors import KinetixError
from tests.attack.clock import Hang, no_hang

SLOW_SECONDS = 2.0
"""Processor time that no input may take."""
_HANG_SECONDS = 120.0
LARGEST_GROWTH = 2000
"""Of the process while one input is read [MB]."""


@dataclasses.dataclass(kw_only=True)
class Row:
    """One kind of attack."""

    tried: int = 0
    accepted: int = 0
    refused: int = 0
    slowest: float = 0.0
    """Most processor time of one input [s]."""
    wrong: list[str] = dataclasses.field(default_factory=list)
    """Faults, one line each."""


class Tally:
    """Rows by name."""

    def __init__(self, keep: Path | None = None) -> None:
        """Start empty.

        Args:
            keep: Folder for inputs that did harm.
        """
        self.rows: dict[str, Row] = {}
        self._keep = keep

    def row(self, name: str) -> Row:
        """The row of a kind of attack."""
        return self.rows.setdefault(name, Row())

    @property
    def tried(self) -> int:
        """Number of tries in all."""
        return sum(row.tried for row in self.rows.values())

    def as_dict(self) -> dict[str, Any]:
        """The rows, for a file."""
        return {name: dataclasses.asdict(row) for name, row in self.rows.items()}

    @property
    def wrong(self) -> list[str]:
        """Everything that went wrong."""
        return [f"{name}: {line}" for name, row in self.rows.items() for line in row.wrong]

    def attempt(self, name: str, data: bytes, attack: Callable[[], object]) -> None:
        """Run one attack: it may succeed, or fail with one plain sentence, in bounded time."""
        row = self.row(name)
        row.tried += 1
        began, memory = _seconds_and_peak_mb()
        problem = ""
        try:
            with no_hang(_HANG_SECONDS):
                attack()
            row.accepted += 1
        except KinetixError as error:
            row.refused += 1
            problem = _bad_sentence(str(error))
        except Hang:
            problem = f"hung for {_HANG_SECONDS:g} s"
        except Exception as error:
            last = traceback.extract_tb(error.__traceback__)[-1]
            place = f"{Path(last.filename).name}:{last.lineno}"
            problem = f"{type(error).__name__} at {place}: {str(error)[-400:]!r}"
        ended, peak = _seconds_and_peak_mb()
        took = ended - began
        row.slowest = max(row.slowest, took)
        if not problem and took > SLOW_SECONDS:
            problem = f"took {took:.1f} s"
        if not problem and peak - memory > LARGEST_GROWTH:
            problem = f"took {peak - memory:.0f} MB"
        if problem:
            row.wrong.append(f"{problem} ({self._kept(name, data)})")

    def _kept(self, name: str, data: bytes) -> str:
        digest = hashlib.sha256(data).hexdigest()[:12]
        if self._keep is not None:
            self._keep.mkdir(parents=True, exist_ok=True)
            (self._keep / f"{name.replace(' ', '_')}_{digest}").write_bytes(data)
        return digest

    def table(self) -> str:
        """The table for people."""
        width = max(map(len, self.rows), default=0)
        head = f"{'':{width}}  {'tried':>9} {'accepted':>9} {'refused':>9} {'slowest':>8}  wrong"
        lines = [head]
        for name, row in self.rows.items():
            lines.append(
                f"{name:{width}}  {row.tried:9,} {row.accepted:9,} {row.refused:9,} "
                f"{row.slowest:6.2f} s  {len(row.wrong)}"
            )
            lines += [f"    {line}" for line in row.wrong[:5]]
        return "\n".join([*lines, f"{self.tried:,} tried, {len(self.wrong)} wrong"])


def _bad_sentence(text: str) -> str:
    if not text.strip():
        return "an empty sentence"
    if not text.isprintable():
        return f"a sentence that is not plain: {text[:100]!r}"
    return f"a sentence of {len(text)} characters" if len(text) > 1100 else ""


def _seconds_and_peak_mb() -> tuple[float, float]:
    """Return the processor time of this process, and the most memory it has had."""
    used = resource.getrusage(resource.RUSAGE_SELF)
    return used.ru_utime + used.ru_stime, used.ru_maxrss / 1000
