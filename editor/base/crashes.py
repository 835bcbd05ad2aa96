"""Unexpected errors: one report per fault, with the last actions."""

import collections
import traceback
from pathlib import Path
from typing import Final

from kinetix.errors import plain
from kinetix.failures import write_report

LAST: Final = 40
"""Actions that a report lists."""


class Crashes:
    """The faults of one run."""

    def __init__(self) -> None:
        self.actions: collections.deque[str] = collections.deque(maxlen=LAST)
        """Last actions, the newest at the end; no names of files."""
        self._told: dict[tuple[str, str, int], str] = {}
        """The sentence for each fault, by kind and place."""

    def note(self, action: str) -> None:
        """Remember what is done now."""
        self.actions.append(action)

    def tell(self, error: Exception) -> tuple[str, bool]:
        """Return a sentence with the path of a report, and whether the fault is new.

        What fails in every frame has one report.
        """
        frames = traceback.extract_tb(error.__traceback__)
        file, line = (frames[-1].filename, frames[-1].lineno or 0) if frames else ("", 0)
        fault = (type(error).__name__, file, line)
        new = fault not in self._told
        if new:
            report = write_report(error, tuple(self.actions))
            where = "see the log" if report is None else f"a report is in {_short(report)}"
            what = plain(str(error) or type(error).__name__, 200)
            self._told[fault] = f"Something went wrong: {what} ({where})"
        return self._told[fault], new


def _short(path: Path) -> str:
    try:
        return f"~/{path.relative_to(Path.home())}"
    except (ValueError, RuntimeError):
        return str(path)
