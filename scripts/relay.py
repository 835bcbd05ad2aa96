"""Put agents together that take turns: `python -m scripts.relay OUT AGENT… [--turn 64]`.

The first one begins every episode; where it has not won after a turn, the next one goes on. All are
of one network; the description is that of the first.
"""

import argparse
from pathlib import Path

from kinetix import load_agent, save_agent
from kinetix.agents.relay import together


def main() -> None:
    """Read the agents, write what they are together."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("out", type=Path)
    parser.add_argument("agents", nargs="+", type=Path)
    parser.add_argument("--turn", type=int, default=64, help="Decisions of a turn.")
    given = parser.parse_args()
    save_agent(together([load_agent(folder) for folder in given.agents], given.turn), given.out)


if __name__ == "__main__":
    main()
