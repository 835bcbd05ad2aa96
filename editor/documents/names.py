"""What the user calls shapes, joints and thrusters: kept beside the levels, by file and id.

A level file has no place for names of entities, as what a level *does*
does not depend on them. So they are the editor's, like locks; ids are never reused, and a name can
never go over to something else.
"""

from collections.abc import Mapping
from pathlib import Path
from typing import Final

from editor.base.state_file import read_state, write_state
from kinetix.paths import state_dir

MAX_FILES: Final = 2_000
"""Of more files the oldest are forgotten."""
MAX_LENGTH: Final = 60


class Names:
    """The names by file; read once, written at every change."""

    def __init__(self, path: Path | None = None, *, stored: bool = True) -> None:
        """Start with what the file says.

        Args:
            path: The file; by default the user's own.
            stored: Whether there is a file at all; scripted runs leave no traces.
        """
        self._path = path
        self._stored = stored
        self._files: dict[str, dict[int, str]] | None = None if stored else {}

    @property
    def path(self) -> Path:
        """The file."""
        return self._path or state_dir() / "names.json"

    def of(self, level_file: Path) -> dict[int, str]:
        """The names in a level, by id."""
        return dict(self._read().get(str(level_file.resolve()), {}))

    def keep(self, level_file: Path, names: Mapping[int, str]) -> None:
        """Keep the names in a level; no names at all are forgotten.

        Raises:
            LevelError: The file cannot be written.
        """
        files, key = self._read(), str(level_file.resolve())
        if files.get(key, {}) == dict(names):
            return
        files.pop(key, None)
        if names:
            files[key] = dict(names)
        while len(files) > MAX_FILES:
            del files[next(iter(files))]
        self._write()

    def _read(self) -> dict[str, dict[int, str]]:
        if self._files is None:
            self._files = _parse(self.path)
        return self._files

    def _write(self) -> None:
        if self._stored:
            write_state(self.path, self._read())


def _parse(path: Path) -> dict[str, dict[int, str]]:
    """What the file says; what is broken in it is passed over."""
    return {
        file: {
            int(number): name[:MAX_LENGTH]
            for number, name in names.items()
            if number.isdecimal() and len(number) < 17 and isinstance(name, str) and name
        }
        for file, names in read_state(path).items()
        if isinstance(names, dict)
    }
