"""Names of shapes, joints and thrusters that earlier versions kept beside the levels.

They are taken into a level when its file is opened, and leave this file when the level is saved;
with the last of them the file goes.
"""

from collections.abc import Mapping
from pathlib import Path

from editor.base.state_file import Kept, read_state, write_state
from kinetix.level.model import MAX_NAME, Level


class OldNames(Kept):
    """The names by level file and id; read once."""

    FILE = "names.json"

    def __init__(self, path: Path | None = None, *, stored: bool = True) -> None:
        super().__init__(path, stored=stored)
        self._files: dict[str, dict[int, str]] | None = None if stored else {}

    def of(self, level_file: Path) -> Mapping[int, str]:
        """Return the names that wait for a level, by id."""
        return self._read().get(str(level_file.resolve()), {})

    def drop(self, level_file: Path) -> None:
        """Forget the names of a level: its own file has them now.

        Raises:
            LevelError: The file cannot be written.
        """
        if self._read().pop(str(level_file.resolve()), None) is not None:
            self._write()

    def move(self, old: Path, new: Path) -> None:
        """Let the names follow a level file to another place.

        Raises:
            LevelError: The file cannot be written.
        """
        names = self._read().pop(str(old.resolve()), None)
        if names:
            self._read()[str(new.resolve())] = names
            self._write()

    def _read(self) -> dict[str, dict[int, str]]:
        if self._files is None:
            self._files = _parse(self.path)
        return self._files

    def _write(self) -> None:
        if self._files:
            write_state(self.path, self._files)
        else:
            self.path.unlink(missing_ok=True)


def named(level: Level, names: Mapping[int, str]) -> Level:
    """Return a level whose entities without a name have those that wait for them."""
    if not names:
        return level
    return level.replace(
        bodies=tuple(each.replace(name=each.name or names.get(each.id)) for each in level.bodies),
        joints=tuple(each.replace(name=each.name or names.get(each.id)) for each in level.joints),
        thrusters=tuple(
            each.replace(name=each.name or names.get(each.id)) for each in level.thrusters
        ),
    )


def _parse(path: Path) -> dict[str, dict[int, str]]:
    """Return what the file says; what is broken in it is passed over."""
    found = {
        file: {
            int(number): name[:MAX_NAME]
            for number, name in names.items()
            if number.isdecimal() and len(number) < 17 and isinstance(name, str) and name
        }
        for file, names in read_state(path).items()
        if isinstance(names, dict)
    }
    return {file: names for file, names in found.items() if names}
