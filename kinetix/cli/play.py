"""Play one episode without a window and print how it ended."""

import dataclasses
import json
import sys
from typing import TYPE_CHECKING, Annotated

import tyro

from kinetix.cli.shared.attempts import check_attempt, decide_of, steps_of_attempt
from kinetix.cli.shared.terminal import announced
from kinetix.wording import plural

if TYPE_CHECKING:
    from kinetix.agents.player import Player
    from kinetix.environment.episode import Episode
    from kinetix.level.codec import LoadedLevel


@dataclasses.dataclass(frozen=True, kw_only=True)
class Play:
    """One headless episode."""

    level: Annotated[str, tyro.conf.Positional, tyro.conf.arg(metavar="LEVEL")]
    """Level file, or the name of a bundled level (s/…, m/…, l/…)."""
    agent: str = "noop"
    """Directory of an agent, a bundled agent (general), planner, noop, random, or solution."""
    seed: int = 0
    """Seed of the agent's draws."""
    attempt: int | None = None
    """Play this attempt of kinetix eval under the seed, from 0: the same episode to the bit."""
    deterministic: bool = False
    """Take the likeliest action instead of drawing one."""
    physics: str | None = None
    """Physics preset or solver; by default what the agent was trained under."""
    json: bool = False
    """Print one JSON line."""
    cores: int | None = None
    """Processor cores to use (KINETIX_CORES, else all)."""


def run(command: Play) -> int:
    """Play, print `steps`, `outcome` (won, lost, timeout, broken) and `return`; always 0."""
    # Imported here, so that a wrong command line fails before JAX loads.
    from kinetix.agents.named import SOLUTION, load_player
    from kinetix.level.codec import load_document

    check_attempt(command.attempt, [command.agent])
    document = load_document(command.level)
    player = None if command.agent == SOLUTION else load_player(command.agent)
    with announced("compiling the player and the step"):
        episode = _played(command, document, player)
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
            f"{document.level.name}: {row['outcome']} after {plural(episode.steps, 'step')}, "
            f"return {row['return']:.3f}"
        )
    if episode.dropped_contacts:
        print(
            f"{document.level.name}: in {plural(episode.dropped_contacts, 'step')} bodies "
            "overlapped so much that contacts were left out",
            file=sys.stderr,
        )
    return 0


def _played(command: Play, document: "LoadedLevel", player: "Player | None") -> "Episode":
    """Play the recorded solution (no player), an attempt of an evaluation, or another episode."""
    from kinetix.environment.replay import play_solution, solution_physics

    if player is None:
        physics = command.physics or solution_physics(document.level, command.level)
        return play_solution(document.level, physics)
    if command.attempt is not None:
        return _attempt(command, player, command.attempt)
    return _alone(command, player, document)


def _attempt(command: Play, player: "Player", attempt: int) -> "Episode":
    """Play an attempt of an evaluation."""
    from kinetix.environment.episode import Episode

    *_, last = steps_of_attempt(command, player, attempt)
    result = last.result
    assert result is not None
    return Episode(
        steps=result.length,
        outcome=result.outcome,
        total_reward=result.total_reward,
        dropped_contacts=result.dropped_contacts,
    )


def _alone(command: Play, player: "Player", document: "LoadedLevel") -> "Episode":
    """Play one episode with draws of its own."""
    from kinetix.agents.environments import capacity_for, environment_for
    from kinetix.environment.episode import play_episode
    from kinetix.environment.reset import level_state

    capacity = capacity_for(player.card, document.capacity, level=document.level.name)
    physics = command.physics or player.card.environment.physics
    env = environment_for(player, capacity, physics=physics)
    return play_episode(
        env,
        level_state(command.level, env.static_env_params),
        decide_of(command, player),
        params=player.params,
        carry=player.policy.init_carry(1),
        seed=command.seed,
    )
