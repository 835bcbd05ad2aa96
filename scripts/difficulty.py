"""Measure how hard the bundled levels are for a search: `python -m scripts.difficulty [NAME …]`.

The measure is the number of plans that a win takes on average. Each level is played by 256 random
plans; where some of them win, 256 divided by their number is the answer. Where none does, the
search a stretch at a time goes on, one pass counting as 256 plans more, at most `PASSES` times.
Results go to scripts/library/difficulty.json, from which `scripts.build_levels` makes the levels'
tags. A level that has changed since is graded by its builder's estimate until it is measured again.
Without names, all levels are measured that have not been as they are.
"""

import itertools
import json
import sys
from collections.abc import Iterator
from pathlib import Path
from typing import Final

from kinetix.bundled import level_hint
from kinetix.environment.env import KinetixEnv
from kinetix.environment.search.beam import BATCH, stretches
from kinetix.environment.search.plans import random_plans
from kinetix.environment.search.search import play_plans, search_task, solving_env
from kinetix.level.codec import level_hash, load_level
from kinetix.level.model import Level
from kinetix.level.sets import level_files
from kinetix.paths import levels_dir
from scripts.library.grades import MEASURED, Effort, read_efforts, write_efforts

PHYSICS: Final = "balanced"
PASSES: Final = 4
"""Passes of the search through a level that no random plan wins."""


def bundled() -> dict[str, Path]:
    """Return the files of all levels by name, those of a size together."""
    return {
        f"{size}/{path.stem}": path
        for size in ("s", "m", "l")
        for path in level_files(levels_dir() / size)
    }


def chosen(names: list[str]) -> Iterator[tuple[str, Level]]:
    """The levels to measure by name, such as `s/hang_on`."""
    efforts = read_efforts()
    for name, path in bundled().items():
        level = load_level(path)
        known = name in efforts and efforts[name].level == level_hash(level)
        if name in names or not (names or known):
            yield name, level


def effort_of(level: Level, env: KinetixEnv) -> Effort:
    """Play random plans, and search where none of them wins."""
    task = search_task(level, env, physics=PHYSICS)
    plans = random_plans(task.random, BATCH, task.limit, task.channels)
    lucky = int(play_plans(task, plans, all_to_the_end=True).won.sum())
    passes = 0
    if not lucky:
        passes = next(
            (
                count
                for count, found in zip(range(1, PASSES + 1), stretches(task), strict=False)
                if found.actions is not None
            ),
            PASSES + 1,
        )
    return Effort(level=level_hash(level), plans=BATCH, lucky=lucky, passes=passes)


def main(names: list[str]) -> None:
    """Measure the named levels, or all, and keep what comes out."""
    unknown = sorted({*names} - {*bundled()})
    if unknown:
        near = level_hint(unknown[0])
        sys.exit(f"difficulty: no bundled level {', '.join(unknown)}, such as s/hang_on{near}")
    for _, group in itertools.groupby(chosen(names), key=lambda each: each[0][0]):
        levels = dict(group)
        # One compilation for all of a size.
        env = solving_env(list(levels.values()), physics=PHYSICS)
        for name, level in levels.items():
            effort = effort_of(level, env)
            # After each level, so that nothing is lost when it is stopped.
            write_efforts(read_efforts() | {name: effort})
            sys.stdout.write(f"{name}: {json.dumps(effort.tree())}\n")
            sys.stdout.flush()
    sys.stdout.write(f"{MEASURED}\n")


if __name__ == "__main__":
    main(sys.argv[1:])
