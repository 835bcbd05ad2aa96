"""Search for actions that win a level; exit status 1 when none are found in the given time."""

import dataclasses
import sys
from typing import TYPE_CHECKING, Annotated

from tyro.conf import Positional

from kinetix.errors import LevelError
from kinetix.level.codec import load_document, resolve_path, save_level
from kinetix.level.validate import validate

if TYPE_CHECKING:
    from kinetix.environment.search import SearchProgress

_OPEN_START = ("E104", "E105")
"""Codes of levels that end before they begin."""


@dataclasses.dataclass(frozen=True, kw_only=True)
class Solve:
    """Search for actions that win a level."""

    level: Annotated[str, Positional]
    """Level file, or the name of a bundled level (s/…, m/…, l/…)."""
    physics: str = "balanced"
    """Physics preset or solver."""
    seed: int = 0
    """Seed of the search."""
    seconds: float = 60.0
    """How long to search."""
    write: bool = False
    """Record the actions in the level's file."""


def run(command: Solve) -> int:
    """Search, tell what was found, and record it when asked to.

    Returns:
        0 when the level was won, 1 otherwise.

    Raises:
        LevelError: The level is bad, cannot be played, or its format cannot hold a solution.
    """
    loaded = load_document(command.level)
    path = resolve_path(command.level)
    if command.write and loaded.format != "kinetix-level":
        raise LevelError(
            f"{path}: a file of the format {loaded.format} cannot hold a solution; "
            "turn it into a native level with `kinetix convert`"
        )
    for issue in validate(loaded.level):
        if issue.code in _OPEN_START:
            raise LevelError(f"{path}: {issue.path}: {issue.message}")
    # Imported here, so that a wrong command line or a bad level fails before JAX loads.
    from kinetix.environment.search import solve_level

    solution = solve_level(
        loaded.level,
        physics=command.physics,
        seed=command.seed,
        seconds=command.seconds,
        report=_show,
    )
    if solution is None:
        print(f"{loaded.level.name}: no solution found in {command.seconds:g} s", file=sys.stderr)
        return 1
    steps = sum(repeat for repeat, _ in solution.actions)
    print(f"{loaded.level.name}: won after {steps} steps under {solution.physics}")
    if command.write:
        # What is solved is no longer unsolved.
        tags = tuple(tag for tag in loaded.level.tags if tag != "unsolved")
        save_level(loaded.level.replace(solution=solution, tags=tags), path)
        print(f"recorded in {path}")
    return 0


def _show(progress: "SearchProgress") -> None:
    print(
        f"{progress.plans} plans in {progress.seconds:.0f} s, {progress.won} of them won, "
        f"closest {progress.distance:.2f} m",
        file=sys.stderr,
    )
