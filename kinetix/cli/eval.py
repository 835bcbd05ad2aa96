"""Measure an agent on levels: solve rates with 95 % bounds, a line a level, then the means."""

import dataclasses
import json
from typing import Annotated, Any

import tyro

from kinetix.cli.shared.measured import told_parts
from kinetix.wording import plural


@dataclasses.dataclass(frozen=True, kw_only=True)
class Eval:
    """Measure how often a player solves each of some levels."""

    agent: Annotated[str, tyro.conf.arg(metavar="DIR|planner|noop|random")]
    """Directory of an agent or of a run, a bundled agent (general), or planner, noop or random."""
    levels: Annotated[tuple[str, ...], tyro.conf.arg(metavar="DIR|FILE|SET …")]
    """Folders of levels, level files, level sets; names of bundled ones (s/…, levels/s, sets/s)."""
    attempts: int = 20
    """Independent episodes a level."""
    seed: int = 0
    """Equal seeds give equal results."""
    physics: str | None = None
    """Physics preset or solver; by default what the agent was trained under."""
    deterministic: bool = False
    """Take the likeliest action instead of drawing one."""
    json: bool = False
    """Print JSON lines."""
    cores: int | None = None
    """Processor cores to use (KINETIX_CORES, else all)."""


def run(command: Eval) -> int:
    """Play everything, print a line a level and the summary; 1 if a level could not be played."""
    # Imported here, so that a wrong command line fails before JAX loads.
    from kinetix.agents.evaluate import Settings, evaluate
    from kinetix.agents.named import load_player
    from kinetix.agents.results import report
    from kinetix.cli.shared.measured import levels_to_measure, named, parts_of, watched
    from kinetix.errors import KinetixError

    if command.attempts < 1:
        raise KinetixError(f"--attempts {command.attempts}: expected at least 1")
    levels = levels_to_measure(command.levels)
    player = load_player(command.agent)
    settings = Settings(
        attempts=command.attempts,
        seed=command.seed,
        physics=command.physics or "",
        deterministic=command.deterministic,
    )
    progress = watched(evaluate(player, named(levels), settings))
    results = progress.in_order([level.name for level in levels])
    *lines, summary = report(results, settings.provenance(player))
    parts = parts_of(levels, results)
    if parts:
        summary["parts"] = parts
    for line in lines:
        _print_level(line, as_json=command.json)
    _print_summary(summary, as_json=command.json)
    return 1 if progress.failures else 0


def _print_level(row: dict[str, Any], *, as_json: bool) -> None:
    if as_json:
        print(json.dumps(row))
        return
    if "error" in row:
        print(f"{row['level']:32}     -  {row['error']}")
        return
    print(
        f"{row['level']:32} {row['solve_rate']:5.2f}  [{row['low']:.2f}, {row['high']:.2f}]  "
        f"return {row['mean_return']:6.3f}  length {row['mean_length']:5.1f}"
    )
    if "dropped_contacts" in row:
        print(
            f"{'':32}   bodies overlapped so much that {row['dropped_contacts']} steps left "
            f"contacts out"
        )


def _print_summary(summary: dict[str, Any], *, as_json: bool) -> None:
    if as_json:
        print(json.dumps(summary))
        return
    for group, rate in summary["groups"].items():
        print(f"  {group:30} {rate:5.2f}")
    if not summary["levels"]:
        print(f"{summary['agent']} under {summary['physics']}: could play none of the levels")
        return
    print(
        f"{summary['agent']} under {summary['physics']}: mean solve rate "
        f"{summary['mean_solve_rate']:.3f} over {plural(summary['levels'], 'level')}, "
        f"{summary['best_of_k']:.2f} of them solved at least once"
    )
    if "parts" in summary:
        print(f"by part of the set: {told_parts(summary['parts'])}")
