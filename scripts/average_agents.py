"""Average the parameters of agents of one kind: `python -m scripts.average_agents OUT AGENT…`.

Checkpoints of one run, averaged, make a steadier policy than the last of them.

Source: Izmailov et al., "Averaging Weights Leads to Wider Optima and Better Generalization" (2018).
"""

import argparse
from pathlib import Path
from typing import Final

import jax
import msgspec
import numpy as np

from kinetix import load_agent, save_agent
from kinetix.agents.agent import Agent
from kinetix.agents.card import AgentCard
from kinetix.errors import KinetixError

ONE_AGENTS: Final = ("environment_steps", "env_steps", "wall_time")
"""Facts about the training of one agent alone."""


def averaged(agents: list[Agent], frame_skip: int | None = None) -> Agent:
    """Return an agent with the means of all parameters and the description of the last one.

    Its results and how long it was trained for are left out: they are of that one alone.
    `averaged` among the facts about training holds the digests of all.

    Args:
        agents: Of the same network, which see and do the same; what they see is normalised as by
            the last one.
        frame_skip: Physics steps between two decisions; None: as the last one has it.

    Raises:
        KinetixError: They are not of one kind.
    """
    for agent in agents[:-1]:
        _check_alike(agent.card, agents[-1].card)
    trees = [agent.params["params"] for agent in agents]
    mean = jax.tree.map(lambda *leaves: np.mean(leaves, axis=0), *trees)
    card = agents[-1].card
    training = {name: fact for name, fact in card.training.items() if name not in ONE_AGENTS}
    training["averaged"] = [agent.digest for agent in agents]
    environment = card.environment
    if frame_skip is not None:
        environment = msgspec.structs.replace(environment, frame_skip=frame_skip)
    return Agent(card.replace(results={}, training=training, environment=environment), mean)


def _check_alike(one: AgentCard, last: AgentCard) -> None:
    """Refuse what has no average."""
    parts = ["network", "observation", "action"]
    if not last.plays_any_capacity:
        parts.append("capacity")
    unlike = [part for part in parts if getattr(one, part) != getattr(last, part)]
    if (one.normalisation is None) != (last.normalisation is None):
        unlike.append("normalisation")
    if unlike:
        raise KinetixError(
            f"{one.name} and {last.name} have no average: their {' and '.join(unlike)} differ; "
            "name agents of one kind, such as checkpoints of one run"
        )


def main() -> None:
    """Read the agents, write their average."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("out", type=Path)
    parser.add_argument("agents", nargs="+", type=Path)
    parser.add_argument(
        "--frame-skip", type=int, help="Physics steps between two decisions, if not as in training."
    )
    given = parser.parse_args()
    try:
        agents = [load_agent(folder) for folder in given.agents]
        save_agent(averaged(agents, given.frame_skip), given.out)
    except KinetixError as error:
        parser.exit(1, f"{error}\n")


if __name__ == "__main__":
    main()
