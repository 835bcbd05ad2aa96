"""Write the bundled levels again: `python -m scripts.build_levels [NAME …]`.

A level whose content did not change keeps its recorded solution; a level without one is tagged
`unsolved` until `kinetix solve --write` finds one. Difficulties are those that were measured
(`scripts.difficulty`), else the builders' estimates. The level sets are rebuilt as well.
"""

import sys
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Final

from kinetix.level.codec import level_hash, load_level, save_level
from kinetix.level.model import UNSOLVED, Level, SizeName
from kinetix.level.sets import build_set, gather_levels, level_files, save_set
from kinetix.level.validate import validate
from kinetix.paths import levels_dir
from scripts.library import (
    large_flight,
    large_machines,
    large_vehicles,
    large_walkers,
    medium,
    small,
)
from scripts.library.draft import Draft
from scripts.library.grades import graded, read_efforts

SIZES: Final[dict[SizeName, dict[str, Callable[[], Draft]]]] = {
    "s": small.LEVELS,
    "m": medium.LEVELS,
    "l": {
        **large_vehicles.LEVELS,
        **large_flight.LEVELS,
        **large_machines.LEVELS,
        **large_walkers.LEVELS,
    },
}


def built() -> Iterator[tuple[str, Level]]:
    """Every level of the library by its name, such as `s/hang_on`, without solution."""
    efforts = read_efforts()
    for size, levels in SIZES.items():
        for function, build in levels.items():
            name, title = f"{size}/{function}", function.replace("_", " ").capitalize()
            description = " ".join((build.__doc__ or "").split())
            yield name, graded(build().level(title, description, size), efforts.get(name))


def with_proof(level: Level, path: Path) -> Level:
    """Return the level with the solution that its file records, or tagged `unsolved`."""
    old = load_level(path) if path.exists() else None
    if old and old.solution and level_hash(old) == level_hash(level):
        return level.replace(solution=old.solution)
    return level.replace(tags=(*level.tags, UNSOLVED))


def grade_drawn() -> None:
    """Give the levels that were drawn in the editor the difficulty that was measured."""
    efforts, drawn = read_efforts(), set(dict(built()))
    for size in SIZES:
        for path in level_files(levels_dir() / size):
            name = f"{size}/{path.stem}"
            if name not in drawn:
                level = load_level(path)
                save_level(graded(level, efforts.get(name)), path)


def write_sets() -> None:
    """The level sets over everything that is bundled: one of all levels, one for each size."""
    folder = levels_dir() / "sets"
    folder.mkdir(exist_ok=True)
    for name, sizes in {"library": SIZES, **{size: (size,) for size in SIZES}}.items():
        levels = gather_levels([levels_dir() / size for size in sizes])
        save_set(build_set(levels, name=name, folder=folder), folder / f"{name}.json")


def main(names: list[str]) -> int:
    """Write the named levels, or all, then the sets.

    Returns:
        1 when a level has a problem, which is then named; 0 otherwise.
    """
    bad = 0
    for name, level in built():
        if names and name not in names:
            continue
        path = levels_dir() / f"{name}.json"
        save_level(with_proof(level, path), path)
        for issue in validate(level):
            print(f"{name}: {issue.code} {issue.path}: {issue.message}", file=sys.stderr)
            bad = 1
    grade_drawn()
    write_sets()
    return bad


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
