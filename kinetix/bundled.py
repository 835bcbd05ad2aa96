"""Levels and agents by name, from any folder: words that are not paths."""

import os
import re
from collections.abc import Iterable
from pathlib import Path
from typing import Final

from kinetix.errors import LevelError
from kinetix.lazy import hint
from kinetix.paths import checkpoints_dir, levels_dir

LEVEL_FOLDERS: Final = "KINETIX_LEVELS"
"""Variable with further folders in which names of levels are looked up, such as a copy of
kinetix-env's `levels`; they come before the bundled ones."""
_PERMUTATION = re.compile(r"\.permute(\d{1,40})(?=(\.json)?$)")


def refuse_empty(word: str | Path, expected: str) -> None:
    """Refuse a word that is nothing: as a path it is the current folder, as a name all levels.

    Args:
        word: From a command line.
        expected: What it should be.

    Raises:
        LevelError: The word is empty.
    """
    if not str(word):
        raise LevelError(f'"": expected {expected}, got an empty word')


def level_folders() -> list[Path]:
    """Return the folders in which names such as `s/first_flight` are looked up, in order."""
    named = os.environ.get(LEVEL_FOLDERS, "").split(os.pathsep)
    return [*(Path(folder) for folder in named if folder), levels_dir()]


def without_permutation(name: str | Path) -> str:
    """Return a level's name without its ending `.permuteN`, by which its slots are shuffled."""
    return _PERMUTATION.sub("", str(name))


def permutation_of(name: str | Path) -> int | None:
    """Return N of a level's name that ends in `.permuteN` where no file is called so, or None."""
    found = _PERMUTATION.search(str(name))
    if found is None or os.path.isfile(name) or os.path.isfile(f"{name}.json"):
        return None
    return int(found[1])


def named_levels(name: str | Path) -> Path | None:
    """Return the level file, set file or folder of levels that a name means; None: no such name.

    Args:
        name: `s/first_flight`, `levels/s/first_flight.json`, `s`, `levels/s`, `sets/s`.
    """
    plain = Path(without_permutation(name))
    if plain.is_absolute() or str(name).startswith("."):
        return None
    return _first(level_folders(), _within(plain, levels_dir().name), (".json",))


def named_agent(name: str | Path) -> Path | None:
    """Return the folder of a bundled agent (`general`, `checkpoints/general`), or None."""
    plain = Path(name)
    if plain.is_absolute() or str(name).startswith("."):
        return None
    return _first([checkpoints_dir()], _within(plain, checkpoints_dir().name), ())


def agent_names() -> list[str]:
    """Return the names of the bundled agents."""
    return sorted(card.parent.name for card in checkpoints_dir().glob("*/agent.json"))


def level_hint(name: str | Path) -> str:
    """Return the level name nearest to a mistyped one, as `; did you mean …?`, or nothing."""
    found = {
        path.relative_to(folder).with_suffix("").as_posix()
        for folder in level_folders()
        for path in folder.glob("*/*.json")
    }
    plain = str(name).removesuffix(".json").removeprefix(f"{levels_dir().name}/")
    near = hint(plain, found)
    return f"; {near}" if near.startswith("did you mean") else ""


def agent_hint(name: str | Path, others: Iterable[str] = ()) -> str:
    """Return the agent nearest to a mistyped name, or the names of all."""
    return hint(Path(name).name, [*agent_names(), *others], listing="there are")


def _within(plain: Path, folder: str) -> Path:
    """Return the path without the name of the bundled folder in front."""
    parts = plain.parts
    return Path(*parts[1:]) if len(parts) > 1 and parts[0] == folder else plain


def _first(folders: Iterable[Path], plain: Path, suffixes: tuple[str, ...]) -> Path | None:
    for folder in folders:
        path = folder / plain
        with_suffix = [path.with_name(f"{path.name}{suffix}") for suffix in suffixes]
        found = next((each for each in (path, *with_suffix) if os.path.exists(each)), None)
        if found is not None:
            return found
    return levels_dir() if plain == Path(levels_dir().name) and suffixes else None
