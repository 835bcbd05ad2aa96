"""Play one episode without a window and say how it ended."""

import dataclasses
import json
import sys
from typing import Annotated

import tyro


@dataclasses.dataclass(frozen=True, kw_only=True)
class Play:
    """One headless episode."""

    level: Annotated[str, tyro.conf.Positional]
    """Level file, or the name of a bundled level (s/…, m/…, l/…)."""
    agent: str = "noop"
    """Directory of an agent, a bundled agent (general), or planner, noop or random."""
    seed: int = 0
    """Seed of the agent's draws."""
    physics: str | None = None
    """Physics preset or solver; by default what the agent was trained under."""
    json: bool = False
    """Print one JSON line."""
    cores: int | None = None
    """Processor cores to use (KINETIX_CORES, else all)."""


def run(command: Play) -> int:
    """Play, print `steps`, `outcome` (won, lost, timeout, broken) and `return`; always 0."""
    # Imported here, so that a wrong command line fails before JAX loads.
    from kinetix.agents.environments import capacity_for, environment_for
    from kinetix.agents.named import load_player
    from kinetix.environment.episode import play_episode
    from kinetix.environment.reset import level_state
    from kinetix.level.codec import load_document
    from kinetix.level.sizes import capacity_of

    document = load_document(command.level)
    source = document.source
    capacity = capacity_of(document.level) if source is None else source.capacity
    player = load_player(command.agent)
    capacity = capacity_for(player.card, capacity, level=document.level.name)
    physics = command.physics or player.card.environment.physics
    env = environment_for(player, capacity, physics=physics)
    episode = play_episode(
        env,
        level_state(command.level, env.static_env_params),
        player.policy.decide,
        params=player.params,
        carry=player.policy.init_carry(1),
        seed=command.seed,
    )
    row = {
        "steps": episode.steps,
        "outcome": episode.outcome,
        "return": round(episode.total_reward, 6),
    }
    if episode.dropped_contacts:
        row["dropped_contacts"] = episode.dropped_contacts
    if command.json:
        print(json.dumps(row))
    else:
        print(
            f"{document.level.name}: {row['outcome']} after {row['steps']} steps, "
            f"return {row['return']:.3f}"
        )
    if episode.dropped_contacts:
        print(
            f"{document.level.name}: in {episode.dropped_contacts} steps bodies overlapped so much "
            f"that contacts were left out",
            file=sys.stderr,
        )
    return 0
