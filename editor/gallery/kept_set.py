"""The set that is put together in the gallery, kept from one run of the app to the next."""

from collections.abc import Mapping
from pathlib import Path
from typing import Any, Final

from editor.base.settings import merged_keys
from editor.base.state_file import Kept, alone, read_state, write_state
from kinetix.files.names import is_text

WEIGHTS: Final = (1e-6, 1e6)
"""The least and the greatest weight of a level, as in files of sets."""


class KeptSet(Kept):
    """Writes the set when it has changed; what another window has put together meanwhile stays."""

    FILE = "set.json"

    def __init__(self, path: Path | None = None, *, stored: bool = True) -> None:
        super().__init__(path, stored=stored)
        self._written: dict[str, float] = {}
        self._tried: dict[str, float] = {}

    def read(self) -> dict[str, float]:
        """Return the levels with their weights; what is broken in the file is passed over."""
        self._written = self._tried = self._there()
        return dict(self._written)

    def keep(self, levels: Mapping[str, float], *, again: bool = False) -> None:
        """Write the set unless it is as it was read or written last.

        Args:
            levels: Paths with their weights.
            again: Whether to try also what could not be written before.

        Raises:
            LevelError: The set cannot be written; the next change tries again.
        """
        if not self._stored or levels == self._written or (levels == self._tried and not again):
            return
        now = self._tried = dict(levels)
        with alone(self.path):
            both = now | merged_keys(now, self._written, self._there())
            write_state(self.path, {"levels": {p: w for p, w in both.items() if is_text(p)}})
        self._written = now

    def _there(self) -> dict[str, float]:
        return _parse(read_state(self.path)) if self._stored else {}


def _parse(tree: Mapping[str, Any]) -> dict[str, float]:
    levels = tree.get("levels")
    if not isinstance(levels, dict):
        return {}
    low, high = WEIGHTS
    return {
        path: float(min(max(low, weight), high))  # NaN becomes the least
        for path, weight in levels.items()
        if isinstance(weight, int | float)
    }
