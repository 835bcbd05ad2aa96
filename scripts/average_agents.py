"""Average the parameters of agents of one kind: `python -m scripts.average_agents OUT AGENT…`.

Checkpoints of one run, averaged, make a steadier policy than the last of them.

Source: Izmailov et al., "Averaging Weights Leads to Wider Optima and Better Generalization" (2018).
"""

import argparse
from pathlib import Path

import jax
import msgspec
import numpy as np

from kinetix import load_agent, save_agent
from kinetix.agents.agent import Agent


def averaged(agents: list[Agent]) -> Agent:
    """An agent with the means of all parameters and the description of the last one.

    Args:
        agents: Of the same network.
    """
    trees = [agent.params["params"] for agent in agents]
    mean = jax.tree.map(lambda *leaves: np.mean(leaves, axis=0), *trees)
    return Agent(agents[-1].card, mean)


def main() -> None:
    """Read the agents, write their average."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("out", type=Path)
    parser.add_argument("agents", nargs="+", type=Path)
    parser.add_argument(
        "--frame-skip", type=int, help="Physics steps between two decisions, if not as in training."
    )
    given = parser.parse_args()
    agent = averaged([load_agent(folder) for folder in given.agents])
    if given.frame_skip is not None:
        environment = msgspec.structs.replace(agent.card.environment, frame_skip=given.frame_skip)
        agent = Agent(agent.card.replace(environment=environment), agent.params["params"])
    save_agent(agent, given.out)


if __name__ == "__main__":
    main()
