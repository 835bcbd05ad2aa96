"""The levels that somebody means: folders, files, names of bundled levels, level sets."""

import collections
import dataclasses
import functools
import itertools
import os
from collections.abc import Iterator, Sequence
from pathlib import Path
from typing import Final

from kinetix.bundled import named_levels, refuse_empty
from kinetix.errors import LevelError
from kinetix.files.walk import walked
from kinetix.level.codec import load_document, resolve_path
from kinetix.level.faults import refuse_all
from kinetix.level.json_text import parse_json, read_text
from kinetix.level.sets.manifest import SetLevel
from kinetix.level.sets.paths import plain_name
from kinetix.level.sets.read import is_set_file, load_set

_CARD: Final = "agent.json"


def gather_levels(sources: Sequence[str | Path]) -> list[SetLevel]:
    """The levels that a command line means: folders, files, names of bundled levels, level sets.

    Args:
        sources: Each a folder (every level below it), a level file or a level set, or the name of
            one that is bundled: `s/first_flight`, `levels/s`, `sets/s`.

    Returns:
        The levels in this order, each with a name of its own: of several called `x`, which two
        folders or two titles may be, the second is `x (2)`.

    Raises:
        LevelError: Something is missing or bad, or there is no level at all.
    """
    levels, unreadable = read_levels(sources)
    refuse_all(
        [str(error) for error in unreadable.values()],
        of=len(levels) + len(unreadable),
        what="files cannot be read",
    )
    return levels


def read_levels(
    sources: Sequence[str | Path],
) -> tuple[list[SetLevel], dict[str, LevelError]]:
    """Like `gather_levels`, but the damaged files of a folder do not keep its others away.

    Returns:
        The levels, and by name what is wrong with each file of a folder that could not be read.

    Raises:
        LevelError: A source is missing, or is a damaged level or level set itself; or there is no
            level at all.
    """
    levels: list[SetLevel] = []
    unreadable: dict[str, LevelError] = {}
    for source in sources:
        refuse_empty(source, "a folder, a level or a level set")
        path = place_of(source)
        if os.path.isdir(path):
            for file in level_files(path):
                try:
                    levels.append(_from_file(file, file.relative_to(path)))
                except LevelError as error:
                    unreadable[str(file)] = error
            continue
        path = resolve_path(source)
        if is_set_file(path):
            levels += load_set(path).levels
        else:
            levels.append(_from_file(path, Path(source)))
    if not levels and not unreadable:
        named = ", ".join(map(str, sources)) or "no level was named"
        raise LevelError(f"{named}: expected levels, found none")
    return _told_apart(levels), unreadable


def place_of(source: str | Path) -> Path:
    """The path itself if there is something, else the bundled file or folder of that name."""
    path = Path(source)
    return path if os.path.exists(path) else named_levels(source) or path


def level_files(folder: Path) -> Iterator[Path]:
    """Yield everything below a folder that is called a level, in the order of names.

    Level sets are left out; links that lead nowhere are not, so that they are reported.
    """
    for path in json_files(folder):
        if not os.path.isdir(path) and not (os.path.isfile(path) and is_set_file(path)):
            yield path


def json_files(folder: Path) -> list[Path]:
    """Return what is called JSON below a folder, in the order of names.

    Folders that are hidden, or hold an agent or a training run, are left out.
    """
    found: list[Path] = []
    for place, inner, names in walked([folder]):
        inner[:] = [name for name in inner if not name.startswith(".")]
        is_run = "config.toml" in names and "checkpoints" in inner
        if is_run or (_CARD in names and _is_card(place / _CARD)):
            inner.clear()
        else:
            found += [place / name for name in names if name.lower().endswith(".json")]
    return sorted(found)


def _is_card(path: Path) -> bool:
    """Return whether a file describes an agent; a level may have its name."""
    try:
        tree = parse_json(read_text(path, "agent"), str(path))
    except LevelError:
        return False
    return isinstance(tree, dict) and tree.get("format") == "kinetix-agent"


def _from_file(path: Path, name: Path) -> SetLevel:
    loaded = load_document(path)
    return SetLevel(
        name=plain_name(name.as_posix()),
        level=loaded.level,
        tags=loaded.level.tags,
        path=path,
        native=loaded.source is None,
    )


def _told_apart(levels: Sequence[SetLevel]) -> list[SetLevel]:
    """Return the levels with unique names: results are stored by name."""
    given = {each.name for each in levels}
    numbers = collections.defaultdict(functools.partial(itertools.count, 2))
    taken: set[str] = set()
    found: list[SetLevel] = []
    for each in levels:
        name = each.name
        while name in taken or (name in given and name != each.name):
            name = f"{each.name} ({next(numbers[each.name])})"
        taken.add(name)
        found.append(each if name == each.name else dataclasses.replace(each, name=name))
    return found
