"""The files below the gallery's folders, and what it passes over."""

from collections.abc import Iterable, Iterator, Sequence
from pathlib import Path
from typing import Final

from kinetix.errors import LevelError
from kinetix.files.names import is_text
from kinetix.files.walk import MOST_LINKED, walked

MAX_FILES: Final = 20_000
"""Most files of one look: a bound against a folder that was chosen by mistake."""


class Walk:
    """One walk through some folders; lists what it passed over."""

    def __init__(self, folders: Sequence[Path]) -> None:
        """Begin with the first folder.

        Args:
            folders: Where; everything below them as well.
        """
        self._folders = folders
        self._unnamed = self._full = self._astray = False

    @property
    def passed_over(self) -> str:
        """One sentence about what was not read; empty where everything was."""
        if self._full:
            return f"Not shown: what comes after the first {MAX_FILES} files."
        if self._astray:
            return f"Not shown: what links lead to beyond {MOST_LINKED} folders; remove such links."
        if self._unnamed:
            return "Not shown: files and folders whose names are no Unicode text; rename them."
        return ""

    def files(self) -> Iterator[tuple[Path, int, int]]:
        """Every JSON file with time [ns] and length, in the order of paths, behind links last."""
        try:
            yield from self._files()
        except LevelError:
            self._astray = True

    def _files(self) -> Iterator[tuple[Path, int, int]]:
        count = 0
        for place, inner, names in walked(self._folders):
            inner[:] = self._shown(inner)
            for name in self._shown(name for name in names if name.lower().endswith(".json")):
                path = place / name
                try:
                    status = path.stat()
                except OSError:
                    continue
                if count == MAX_FILES:
                    self._full = True
                    return
                yield path, status.st_mtime_ns, status.st_size
                count += 1

    def _shown(self, names: Iterable[str]) -> list[str]:
        """Return the names that can be shown, sorted; whether some are no text is noted."""
        seen = [name for name in names if not name.startswith(".")]
        shown = sorted(filter(is_text, seen))
        self._unnamed |= len(shown) < len(seen)
        return shown
