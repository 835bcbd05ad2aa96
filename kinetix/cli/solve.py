"""Search for actions that win levels; exit status 1 unless some are found for each of them."""

import contextlib
import dataclasses
import math
import os
import sys
import time
from collections import Counter
from collections.abc import Iterator
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import tyro
from tyro.conf import Positional

from kinetix.bundled import named_levels
from kinetix.cli.shared.terminal import announced
from kinetix.engine.names import DEFAULT_PHYSICS
from kinetix.errors import KinetixError, LevelError
from kinetix.files.atomic import backup_of, check_target, write_with_backup
from kinetix.level.codec import dumps, level_hash, load_document, load_level, save_level
from kinetix.level.controls import channels_in_use
from kinetix.level.model import UNSOLVED, Level, Solution
from kinetix.level.sets import SetLevel, read_levels, set_level_issues
from kinetix.level.sizes import capacity_of
from kinetix.paths import levels_dir
from kinetix.wording import plural

if TYPE_CHECKING:
    from kinetix.environment.env import KinetixEnv
    from kinetix.environment.search.search import SearchProgress

_NO_TASK = ("E101", "E102", "E104", "E105", "W216")
"""Codes of levels that nothing can win: without a green and a blue that can touch, or over before
they begin."""


@dataclasses.dataclass(frozen=True, kw_only=True)
class Solve:
    """Search for actions that win levels."""

    levels: Annotated[Positional[tuple[str, ...]], tyro.conf.arg(metavar="LEVEL|DIR …")]
    """Level files, names of bundled levels (s/…, m/…, l/…), or folders (every level below)."""
    physics: str = DEFAULT_PHYSICS
    """Physics preset or solver."""
    seed: int = 0
    """Seed of the search."""
    seconds: float = 60.0
    """Time to search for each level [s]; compilation comes on top."""
    write: bool = False
    """Record the actions in the level's file; a recorded solution that wins stays in a backup
    beside it, one that wins no more is dropped."""
    unsolved: bool = False
    """Leave out levels whose recorded solution wins."""
    cores: int | None = None
    """Processor cores to use (KINETIX_CORES, else all)."""


def run(command: Solve) -> int:
    """Search, print what was found, and record it when asked to.

    Of several levels, one that is no task and a file of a folder that cannot be read are left out
    with a sentence, and the others are searched.

    Returns:
        0 when every level was won, 1 otherwise.

    Raises:
        LevelError: A level is bad; none can be played, or its format cannot hold a solution.
    """
    if not command.levels:
        raise LevelError("expected levels: files, names such as s/first_flight, or folders")
    if not 0 <= command.seconds < math.inf:
        raise LevelError(f"--seconds {command.seconds}: expected a number from 0")
    if command.write:
        for word in command.levels:
            _refuse_bundled(word)
    given, unreadable = read_levels(command.levels)
    chosen = list(_tasks(given, list(unreadable.values()), write=command.write))
    complete = len(chosen) == len(given) + len(unreadable)
    if command.unsolved:
        count = len(chosen)
        chosen = [each for each in chosen if not _proven(each.level)]
        if won := count - len(chosen):
            print(f"{plural(won, 'recorded solution')} won, left out", file=sys.stderr)
    titles = _titles(chosen)
    found = [
        _solve(each, titles[each.name], command, env)
        for each, env in _with_environments(chosen, command)
    ]
    return 0 if complete and all(found) else 1


def _refuse_bundled(word: str) -> None:
    """Refuse to write to what is bundled; the path of such a file is somebody's own choice."""
    found = named_levels(word)
    is_path = os.path.exists(word) or os.path.exists(f"{word}.json")
    if found is None or is_path or not found.resolve().is_relative_to(levels_dir().resolve()):
        return
    raise LevelError(
        f"{word}: is bundled, and stays as it is; solutions are recorded in a copy of your own of "
        f"{found}"
    )


def _tasks(
    given: list[SetLevel], unreadable: list[LevelError], *, write: bool
) -> Iterator[SetLevel]:
    """Yield the levels that can be searched; report why others cannot.

    Args:
        given: Levels.
        unreadable: What is wrong with files that hold none.
        write: Whether solutions are going to be recorded.

    Raises:
        LevelError: None of the levels can be searched.
    """
    refused = list(unreadable)
    for each in given:
        try:
            _check(each, write=write)
        except LevelError as error:
            refused.append(error)
        else:
            yield each
    if len(refused) == len(given) + len(unreadable):
        raise refused[0]
    for error in refused:
        print(f"left out: {error}", file=sys.stderr)


def _check(each: SetLevel, *, write: bool) -> None:
    """Refuse a level that is no task, or whose file cannot take a solution or be written."""
    for issue in set_level_issues(each):
        if issue.code in _NO_TASK:
            raise LevelError(f"{each.path or each.name}: {issue.path}: {issue.message}")
    if write and each.path is None:
        raise LevelError(f"{each.name}: this level stands inside a level set, not in a file")
    if write and each.path and load_document(each.path).format != "kinetix-level":
        raise LevelError(
            f"{each.path}: a file of the format kinetix-env cannot hold a solution; "
            "turn it into a native level with `kinetix convert`"
        )
    if write and each.path:
        check_target(each.path)


def _proven(level: Level) -> bool:
    """Return whether a level's recorded solution wins; one of unknown physics does not."""
    from kinetix.environment.replay import replay_solution

    try:
        return level.solution is not None and replay_solution(level) == "won"
    except KinetixError:
        return False


def _with_environments(
    chosen: list[SetLevel], command: Solve
) -> Iterator[tuple[SetLevel, "KinetixEnv"]]:
    """Each level with an environment to search it in; levels of one size share theirs."""
    # Imported here, so that a wrong command line or a bad level fails before JAX loads.
    from kinetix.environment.search.search import solving_env

    sizes = dict.fromkeys(capacity_of(each.level) for each in chosen)
    for size in sizes:
        alike = [each for each in chosen if capacity_of(each.level) == size]
        env = solving_env([each.level for each in alike], physics=command.physics)
        yield from ((each, env) for each in alike)


def _titles(chosen: list[SetLevel]) -> dict[str, str]:
    """The title of each level by its name, with its file where several have the same title."""
    often = Counter(each.level.name for each in chosen)
    return {
        each.name: each.level.name
        if often[each.level.name] == 1
        else f"{each.level.name} ({each.path or each.name})"
        for each in chosen
    }


def _solve(each: SetLevel, title: str, command: Solve, env: "KinetixEnv") -> bool:
    from kinetix.environment.search.search import solve_level

    level, last, shown = each.level, None, (-math.inf, 0, "")
    compiling = contextlib.ExitStack()

    def report(progress: "SearchProgress") -> None:
        nonlocal last, shown
        last = progress
        if not progress.compiled:
            return
        compiling.close()
        now = (time.monotonic(), progress.won, f"{progress.distance:.2f}")
        # A light level has many rounds a second, most of which bring nothing new.
        if now[1:] != shown[1:] or now[0] - shown[0] >= 1:
            shown = now
            _show(progress)

    with compiling:
        compiling.enter_context(announced(f"{title}: compiling the search"))
        solution = solve_level(
            level,
            physics=command.physics,
            seed=command.seed,
            seconds=command.seconds,
            report=report,
            env=env,
        )
    if solution is None:
        still = "" if channels_in_use(level) else "; it has no motor or thruster that a key drives"
        print(f"{title}: no solution found {_searched(last)}{still}", file=sys.stderr)
        if command.write and each.path and level.solution and not _proven(level):
            _drop(level, each.path)
        return False
    steps = solution.steps
    print(f"{title}: won after {plural(steps, 'step')} under {solution.physics}", flush=True)
    if command.write and each.path:
        return _record(level, solution, each.path)
    return True


def _record(level: Level, solution: Solution, path: Path) -> bool:
    """Put a solution into a level's file; return whether it is still the level of the search."""
    now = _unchanged(level, path)
    if now is None:
        return False
    # What is solved is no longer unsolved.
    tags = tuple(tag for tag in now.tags if tag != UNSOLVED)
    made = now.replace(solution=solution, tags=tags)
    if _proven(now):
        write_with_backup(path, dumps(made).encode(), keep_all=True)
        print(f"recorded in {path}; what it had, which wins too: {backup_of(path)}", flush=True)
    else:
        save_level(made, path)
        print(f"recorded in {path}", flush=True)
    return True


def _drop(level: Level, path: Path) -> None:
    """Take a solution that does not win out of a level's file."""
    now = _unchanged(level, path)
    if now is None or now.solution != level.solution:
        return
    tags = (*(tag for tag in now.tags if tag != UNSOLVED), UNSOLVED)
    save_level(now.replace(solution=None, tags=tags), path)
    print(f"dropped the solution in {path}: it does not win", flush=True)


def _unchanged(level: Level, path: Path) -> Level | None:
    """Return what a level's file holds now; None, and a sentence, where it is another level."""
    try:
        now = load_level(path)
        if level_hash(now) == level_hash(level):
            return now
        why = f"{path}: was changed during the search"
    except LevelError as error:
        why = str(error)
    print(f"{why}; nothing is recorded, search it again", file=sys.stderr)
    return None


def _searched(last: "SearchProgress | None") -> str:
    """Return for how long and with how many plans a level was searched, in words."""
    if last is None:
        return "without a search"
    return (
        f"in {last.seconds:.0f} s of search and {last.compiling:.0f} s of compiling, "
        f"{plural(last.plans, 'plan')} tried"
    )


def _show(progress: "SearchProgress") -> None:
    print(
        f"{plural(progress.plans, 'plan')} in {progress.seconds:.0f} s, "
        f"{progress.won} of them won, closest {progress.distance:.2f} m",
        file=sys.stderr,
    )
