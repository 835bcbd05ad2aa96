"""One line to copy at the end of a command's help."""

from collections.abc import Sequence
from typing import Final

EXAMPLES: Final = {
    "validate": "kinetix validate my_levels",
    "convert": "kinetix convert s/first_flight first_flight.json",
    "render": "kinetix render l/rover_ridge rover.gif --agent solution --overlay",
    "play": "kinetix play s/goalkeeper --agent goalkeeper",
    "solve": "kinetix solve my_levels --write --unsolved",
    "sample": "kinetix sample my_levels --size m --count 8 --seed 0 --machines",
    "eval": "kinetix eval --agent runs/goalkeeper --levels s/goalkeeper",
    "compare": "kinetix compare --agents runs/mine general noop --levels levels/s --out mine.html",
    "levelset": "kinetix levelset verify my_set.json",
    "levelset build": "kinetix levelset build my_set.json --levels my_levels",
    "levelset verify": "kinetix levelset verify my_set.json",
    "levelset split": "kinetix levelset split my_set.json --seed 4",
    "dataset": "kinetix dataset verify wins",
    "dataset record": "kinetix dataset record wins --agent planner --levels levels/s --wins",
    "dataset gather": "kinetix dataset gather wins --sources my_episodes my_levels",
    "dataset verify": "kinetix dataset verify wins",
    "dataset export": "kinetix dataset export wins wins_as_trajectories",
    "train": "kinetix train ppo --levels s/goalkeeper --out runs/goalkeeper",
    "train bc": "kinetix train bc --data wins --out runs/copied",
    "train sfl": "kinetix train sfl --size s --out runs/sfl",
    "train plr": "kinetix train plr --size s --out runs/plr",
    "train accel": "kinetix train accel --size s --out runs/accel",
    "train dr": "kinetix train dr --size s --out runs/dr",
    "teach": "kinetix teach --size s --count 1000 --out wins",
    "bench": "kinetix bench speed --sizes s --batches 64",
    "bench render": "kinetix bench render",
    "bench accuracy": "kinetix bench accuracy --scenes joints --physics fast",
    "bench everyday": "kinetix bench everyday",
    "bench peers": "kinetix bench peers",
    "bench scaling": "kinetix bench scaling",
    "bench chart": "kinetix bench chart --physics none",
    "cache": "kinetix cache --clear",
}
"""By command, or command and sub-command."""


def example_of(name: str, words: Sequence[str]) -> str:
    """Return the example for a command line; empty where there is none.

    Args:
        name: The command.
        words: What follows it.
    """
    return EXAMPLES.get(f"{name} {next(iter(words), '')}") or EXAMPLES.get(name, "")
