"""Build, check and split level sets."""

import dataclasses
import itertools
import json as json_module
import os
import sys
from collections.abc import Iterator, Sequence
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path
from typing import Annotated, Any

import tyro
from tyro.conf import Positional

from kinetix.bundled import named_levels
from kinetix.cli.shared.one_core import OneCore
from kinetix.cli.shared.terminal import announced
from kinetix.cli.validate import issue_tree, reading_issues
from kinetix.command_line.paths import NamedPath
from kinetix.engine.names import DEFAULT_PHYSICS
from kinetix.errors import KinetixError, LevelError
from kinetix.files.atomic import backup_of
from kinetix.files.folders import made_folder
from kinetix.level.codec import resolve_path
from kinetix.level.model import UNSOLVED
from kinetix.level.sets import (
    DEFAULT_SPLIT,
    LONGEST_NAME,
    LoadedSet,
    SetLevel,
    build_set,
    gather_levels,
    inline_losses,
    load_set,
    read_levels,
    save_set,
    set_level_issues,
    split_set,
)
from kinetix.level.validate import Issue, has_errors
from kinetix.wording import plural


@dataclasses.dataclass(frozen=True, kw_only=True)
class Build(OneCore):
    """Write a level set; equal levels go in once, levels with an error are refused."""

    out: Annotated[Positional[NamedPath], tyro.conf.arg(metavar="OUT.json")]
    """The set to write."""
    levels: Annotated[tuple[str, ...], tyro.conf.arg(metavar="DIR|FILE|SET …")]
    """Folders (every level below), level files, or level sets."""
    split: float = DEFAULT_SPLIT
    """Share of the levels that go to training."""
    seed: int = 0
    """Seed of the split."""
    inline: bool = False
    """Put the levels themselves into the file. Otherwise it names those in its folder, or one
    folder up, by their paths; levels farther away are put into it anyway."""


@dataclasses.dataclass(frozen=True, kw_only=True)
class Verify:
    """Check that every level is valid, open at the start, no gift, and won by its solution."""

    source: Annotated[Positional[str], tyro.conf.arg(metavar="DIR|SET")]
    """A folder of levels, a level set, or a level file."""
    json: bool = False
    """Print one JSON object a level on stdout, and nothing else there."""
    cores: int | None = None
    """Processor cores to use (KINETIX_CORES, else all)."""


@dataclasses.dataclass(frozen=True, kw_only=True)
class Split(OneCore):
    """Draw another split of a set."""

    source: Annotated[Positional[NamedPath], tyro.conf.arg(metavar="SET")]
    """The set; it is written in place."""
    seed: int
    """Seed of the split."""
    split: float = DEFAULT_SPLIT
    """Share of the levels that go to training."""


Levelset = (
    Annotated[Build, tyro.conf.subcommand("build")]
    | Annotated[Verify, tyro.conf.subcommand("verify")]
    | Annotated[Split, tyro.conf.subcommand("split")]
)


def run(command: Build | Verify | Split) -> int:
    """Run one of the three.

    Returns:
        0 done, 1 a level did not pass `verify`.
    """
    if isinstance(command, Build):
        return _build(command)
    if isinstance(command, Split):
        return _split(command)
    return _verify(command)


def _build(command: Build) -> int:
    found = gather_levels(command.levels)
    made = build_set(
        found,
        name=_name_after(command.out),
        folder=command.out.parent,
        split=command.split,
        seed=command.seed,
    )
    made_folder(command.out.parent)
    _save(made, command.out, inline=command.inline)
    for sentence in inline_losses(made, inline=command.inline):
        print(sentence, file=sys.stderr)
    print(_summary(command.out, made, doubles=len(found) - len(made.levels)))
    print(_where_levels_are(made, inline=command.inline))
    return 0


def _name_after(path: Path) -> str:
    """Return the name of a set after its file's, as far as a name may go."""
    return path.stem.encode(errors="replace").decode()[:LONGEST_NAME]


def _where_levels_are(made: LoadedSet, *, inline: bool) -> str:
    """Print which levels the file of a set names by path, and which it contains."""
    named = 0 if inline else sum(entry.path is not None for entry in made.manifest.levels)
    held = len(made.levels) - named
    if not held:
        return "It names the levels by their paths; --inline puts them into the file."
    if not named:
        return "The levels themselves are in the file."
    return (
        f"It names {plural(named, 'level')} by path and holds {held} that are out of its reach; "
        "--inline puts all into the file."
    )


def _split(command: Split) -> int:
    here = (command.source, f"{command.source}.json")
    if not any(map(os.path.exists, here)):
        if named_levels(command.source):
            raise LevelError(
                f"{command.source}: is bundled, and stays as it is; make a set of your own from "
                f"it: kinetix levelset build mine.json --levels {command.source}"
            )
        raise LevelError(
            f"{command.source}: there is no such level set; `kinetix levelset build` makes one"
        )
    source = resolve_path(command.source)
    found = load_set(source)
    if not found.levels:
        raise LevelError(f"{source}: expected levels, found none")
    made = split_set(found, split=command.split, seed=command.seed)
    _save(made, source, inline=False)
    print(_summary(source, made))
    return 0


def _save(made: LoadedSet, path: Path, *, inline: bool) -> None:
    """Write a set; weights and a split that somebody has put into the old one are not lost."""
    if save_set(made, path, inline=inline, backup=True):
        print(f"{backup_of(path)}: the set that {path.name} held before", file=sys.stderr)


def _summary(path: Path, made: LoadedSet, *, doubles: int = 0) -> str:
    train = sum(each.split == "train" for each in made.levels)
    count = plural(len(made.levels), "level")
    text = f"{path}: {count}, {train} train, {len(made.levels) - train} eval"
    return f"{text}, {doubles} left out because they equal others" if doubles else text


@dataclasses.dataclass(frozen=True, kw_only=True)
class Verdict:
    """Findings of `verify` about one level."""

    level: str
    issues: tuple[Issue, ...]
    noop: str | None
    """Outcome of doing nothing; None where the level could not be played."""
    solution: str | None
    """Outcome of the recorded solution; None without one."""
    unsolved: bool = False
    """True if the level is tagged so, which makes it only reported."""
    records: bool = True
    """True if its file can record a solution: those of kinetix-env cannot."""
    unplayed: str = ""
    """Reason why it could not be played; empty if it was, or has an error."""

    @property
    def problems(self) -> list[str]:
        """Reasons for which the level does not pass."""
        found = [f"{i.code} {i.path}: {i.message}" for i in self.issues if i.severity == "error"]
        if self.unplayed:
            found.append(f"it cannot be played: {self.unplayed}")
        if self.noop == "won":
            found.append("doing nothing wins it")
        if self.solution is None and self.noop is not None and self.records:
            found.append("it has no recorded solution")
        elif self.solution not in (None, "won"):
            found.append(f"its recorded solution ends with {self.solution}")
        return found

    @property
    def ok(self) -> bool:
        """True if it passes."""
        return not self.problems or self.unsolved


def _verify(command: Verify) -> int:
    levels, unreadable = read_levels([command.source])
    ok = True
    unread = itertools.starmap(_unreadable, unreadable.items())
    for verdict in itertools.chain(unread, _verdicts(levels)):
        ok = ok and verdict.ok
        print(_json_line(verdict) if command.json else _text(verdict), flush=True)
    return 0 if ok else 1


def _verdicts(levels: Sequence[SetLevel]) -> Iterator[Verdict]:
    import jax  # only playing needs it

    # A level is one world, which keeps one core busy.
    with ThreadPoolExecutor(jax.local_device_count()) as threads:
        found = threads.map(verdict_on, levels)
        with announced("compiling the step"):
            yield from itertools.islice(found, 1)
        yield from found


def _unreadable(name: str, error: LevelError) -> Verdict:
    return Verdict(level=name, issues=tuple(reading_issues(error)), noop=None, solution=None)


def verdict_on(each: SetLevel) -> Verdict:
    """Check one level: first by itself, then by playing it."""
    from kinetix.environment.replay import noop_outcome, replay_solution  # only playing needs JAX

    level, issues = each.level, set_level_issues(each)
    playable = not has_errors(issues)
    noop = solution = None
    unplayed = ""
    if playable:
        physics = level.solution.physics if level.solution else DEFAULT_PHYSICS
        try:
            noop = noop_outcome(level, physics)
            solution = replay_solution(level) if level.solution else None
        except KinetixError as error:
            unplayed = str(error)
    return Verdict(
        level=each.name,
        issues=issues,
        noop=noop,
        solution=solution,
        unsolved=UNSOLVED in level.tags,
        records=each.path is None or each.native,
        unplayed=unplayed,
    )


def _json_line(verdict: Verdict) -> str:
    tree: dict[str, Any] = {
        "level": verdict.level,
        "ok": verdict.ok,
        "problems": verdict.problems,
        "noop": verdict.noop,
        "solution": verdict.solution,
        "unsolved": verdict.unsolved,
        "issues": [issue_tree(issue) for issue in verdict.issues],
    }
    return json_module.dumps(tree, ensure_ascii=False)


def _text(verdict: Verdict) -> str:
    if not verdict.problems:
        noted = "" if verdict.records else ", its format records no solution"
        return f"{verdict.level}: ok{noted}"
    mark = "reported only" if verdict.ok else "FAILED"
    return f"{verdict.level}: {mark}: {'; '.join(verdict.problems)}"
