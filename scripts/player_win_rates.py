"""Measure how often players win the bundled levels: `python -m scripts.player_win_rates [NAME …]`.

The planner, the bundled general agent and random play, each with as many
attempts as `ATTEMPTS` says, under `balanced`. Results go to scripts/library/played.json after every
batch of levels, and from there into docs/levels.md (`python -m scripts.reference_docs`). Without
names, all levels are played that have not been as they are.
"""

import argparse
import json
import sys
from collections.abc import Iterator
from typing import Final

from kinetix.agents.evaluate import NamedLevel, Settings, evaluate
from kinetix.agents.named import load_player
from kinetix.level.codec import level_hash, load_level
from kinetix.level.sets import level_files
from kinetix.paths import levels_dir
from scripts.library.grades import Played, read_played, write_played

PHYSICS: Final = "balanced"
ATTEMPTS: Final = {"random": 20, "general": 20, "planner": 1}
"""Attempts per level; the planner's are dear."""


def chosen(player: str, names: list[str]) -> Iterator[NamedLevel]:
    """Return the levels that a player has to play, such as `s/hang_on`."""
    known = read_played()
    for size in ("s", "m", "l"):
        for path in level_files(levels_dir() / size):
            name, level = f"{size}/{path.stem}", load_level(path)
            before = known.get(name)
            fresh = before is not None and before.level == level_hash(level)
            done = fresh and before is not None and player in before.rates
            if name in names or not (names or done):
                yield NamedLevel(name=name, source=level)


def measure(player: str, levels: list[NamedLevel]) -> None:
    """Let a player play levels, and keep its rates as they come."""
    settings = Settings(attempts=ATTEMPTS[player], physics=PHYSICS)
    told: set[str] = set()
    for progress in evaluate(load_player(player), levels, settings):
        found = [each for each in progress.results if each.level not in told]
        for each in found:
            level = load_level(each.level)
            known = read_played()
            before = known.get(each.level)
            current = before is not None and before.level == level_hash(level)
            rates = before.rates if before is not None and current else {}
            rates = rates | {player: round(each.solve_rate, 4)}
            write_played(known | {each.level: Played(level=level_hash(level), rates=rates)})
            sys.stdout.write(f"{each.level}: {player} {json.dumps(rates[player])}\n")
            told.add(each.level)
        sys.stdout.flush()


def main() -> None:
    """Measure what has not been measured."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("names", nargs="*", metavar="NAME")
    parser.add_argument("--players", nargs="+", default=list(ATTEMPTS), choices=list(ATTEMPTS))
    options = parser.parse_args()
    for player in options.players:
        levels = list(chosen(player, options.names))
        if levels:
            measure(player, levels)


if __name__ == "__main__":
    main()
