"""Compare policies on the same levels and seeds: rates, paired differences, a leaderboard."""

import dataclasses
import json
import sys
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import tyro

from kinetix.agents.compare import (
    Contender,
    common_levels,
    differences,
    labels_of,
    leaderboard,
    unlike,
)
from kinetix.agents.comparison_files import signed
from kinetix.agents.results import LevelFailure
from kinetix.cli.shared.measured import levels_to_measure, named, parts_of, told_parts, watched
from kinetix.errors import KinetixError
from kinetix.files.folders import made_folder
from kinetix.level.sets import SetLevel
from kinetix.version import __version__
from kinetix.wording import plural

if TYPE_CHECKING:
    from kinetix.agents.evaluate import NamedLevel, Settings
    from kinetix.agents.player import Player


@dataclasses.dataclass(frozen=True, kw_only=True)
class Compare:
    """Several policies beside each other."""

    agents: Annotated[tuple[str, ...], tyro.conf.arg(metavar="DIR|planner|noop|random …")]
    """Directories of agents or runs, bundled agents, planner, noop, random; each is measured."""
    levels: Annotated[tuple[str, ...], tyro.conf.arg(metavar="DIR|FILE|SET …")]
    """Folders of levels, level files, names of bundled levels, level sets."""
    attempts: int = 20
    """Independent episodes per level and agent."""
    seed: int = 0
    """Equal attempts of all agents have equal draws."""
    physics: str | None = None
    """Physics preset or solver for all; by default what each agent was trained under."""
    deterministic: bool = False
    """Take the likeliest action instead of drawing one."""
    checkpoints: bool = False
    """Measure every checkpoint of training runs instead of the newest one."""
    out: Path | None = None
    """Write everything to a file: .json with every attempt, .csv, or .html to look at."""
    json: bool = False
    """Print JSON lines."""
    cores: int | None = None
    """Processor cores to use (KINETIX_CORES, else all)."""


def run(command: Compare) -> int:
    """Measure everything, print and write it; 1 if a level could not be played."""
    # Imported here, so that a wrong command line fails before JAX loads.
    from kinetix.agents.comparison_files import SUFFIXES, check_size, misfit_of, text_of
    from kinetix.agents.evaluate import Settings
    from kinetix.agents.stored_comparison import check_replaced
    from kinetix.files.atomic import check_target, write_atomically

    if not command.agents:
        raise KinetixError("--agents: expected an agent at least, got no word")
    if command.attempts < 1:
        raise KinetixError(f"--attempts {command.attempts}: expected at least 1")
    if command.out is not None and command.out.suffix.lower() not in SUFFIXES:
        raise KinetixError(f"{command.out}: expected a name that ends in {', '.join(SUFFIXES)}")
    if command.out is not None:
        check_target(command.out)
        check_replaced(command.out)
    found = levels_to_measure(command.levels)
    settings = Settings(
        attempts=command.attempts,
        seed=command.seed,
        physics=command.physics or "",
        deterministic=command.deterministic,
    )
    players = [player for name in command.agents for player in _players(name, command.checkpoints)]
    if command.out is not None:
        check_size(command.out, len(players), [one.name for one in found], command.attempts)
    contenders = _measured(players, named(found), settings)
    # Written first: what reads the lines may close the pipe before the last of them.
    if command.out is not None:
        hashes = {level.name: level.sha256 for level in found}
        text = text_of(command.out.suffix.lower(), contenders, hashes, __version__)
        write_atomically(made_folder(command.out.parent) / command.out.name, text.encode())
        print(misfit_of(command.out, text) or command.out, file=sys.stderr)
    _print(contenders, found, as_json=command.json)
    failed = any(isinstance(one, LevelFailure) for c in contenders for one in c.results)
    return 1 if failed else 0


def _players(name: str, every_checkpoint: bool) -> "list[Player]":
    """Return the players that a name means: one, or all checkpoints of a training run."""
    from kinetix.agents.agent import load_agent
    from kinetix.agents.checkpoint import RUN_CHECKPOINTS, steps_of_run
    from kinetix.agents.named import load_player

    steps = steps_of_run(Path(name)) if every_checkpoint else []
    if steps:
        return [load_agent(Path(name) / RUN_CHECKPOINTS / str(step)) for step in steps]
    return [load_player(name)]


def _measured(
    players: "list[Player]", levels: "list[NamedLevel]", settings: "Settings"
) -> list[Contender]:
    from kinetix.agents.evaluate import evaluate

    provenances = [settings.provenance(player) for player in players]
    contenders = []
    for player, provenance, label in zip(players, provenances, labels_of(provenances), strict=True):
        progress = watched(evaluate(player, levels, settings), label)
        results = progress.in_order([level.name for level in levels])
        contenders.append(Contender(label=label, provenance=provenance, results=tuple(results)))
    return contenders


def _board(contenders: list[Contender], levels: list[SetLevel]) -> list[dict[str, Any]]:
    """Return the leaderboard; of a split set with the rate of each part."""
    common = common_levels(contenders)
    played = {contender.label: contender.played for contender in contenders}
    rows = []
    for row in leaderboard(contenders):
        parts = parts_of(levels, [played[row["label"]][level] for level in common])
        rows.append(row | ({"parts": parts} if parts else {}))
    return rows


def _print(contenders: list[Contender], levels: list[SetLevel], *, as_json: bool) -> None:
    board, pairs = _board(contenders, levels), differences(contenders)
    if as_json:
        for contender in contenders:
            for one in contender.results:
                print(json.dumps({"agent": contender.label} | one.as_dict()))
        for pair in pairs:
            print(json.dumps(pair.as_dict()))
        print(json.dumps({"leaderboard": board}))
        return
    _print_rates(contenders, [level.name for level in levels])
    print()
    for row in board:
        rate = "-" if row["mean_solve_rate"] is None else f"{row['mean_solve_rate']:.3f}"
        best = "-" if row["best_of_k"] is None else f"{row['best_of_k']:.2f}"
        print(
            f"{row['rank']:2}. {row['label']:32} {rate}  solved at least once {best}  "
            f"over {plural(row['levels'], 'level')} under {row['physics']}"
        )
        if "parts" in row:
            print(f"{'':4}by part of the set: {told_parts(row['parts'])}")
    for sentence in unlike(contenders):
        print(f"{'':4}{sentence}")
    print()
    for pair in pairs:
        if pair.difference is None:
            print(f"{pair.first} and {pair.second} play no level in common")
            continue
        print(
            f"{pair.first} - {pair.second}: {signed(pair.difference)}  "
            f"[{signed(pair.low)}, {signed(pair.high)}]  "
            f"only one won: {pair.better} to {pair.worse}"
        )


def _print_rates(contenders: list[Contender], levels: list[str]) -> None:
    """A line a level, a column a policy."""
    width = max(8, *(len(contender.label) for contender in contenders))
    heads = "  ".join(f"{contender.label:>{width}}" for contender in contenders)
    print(f"{'':32}  {heads}")
    tables = [contender.played for contender in contenders]
    for level in levels:
        cells = [
            f"{table[level].solve_rate:.2f}" if level in table else "cannot" for table in tables
        ]
        print(f"{level:32}  " + "  ".join(f"{cell:>{width}}" for cell in cells))
