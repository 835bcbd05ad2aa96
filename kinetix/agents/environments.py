"""The environment that a player expects, and the sizes that it can play."""

import dataclasses
from typing import Any

from kinetix.agents.card import AgentCard, read_card
from kinetix.agents.checkpoint import CARD
from kinetix.agents.from_card import observations_of_card
from kinetix.agents.planner.simulator import SimulatorObservations
from kinetix.agents.player import Player
from kinetix.bundled import agent_names
from kinetix.engine.spec import Capacity
from kinetix.environment.env import KinetixEnv, make_kinetix_env
from kinetix.environment.observations import Layout
from kinetix.environment.params import EnvParams, static_env_params_of
from kinetix.errors import CheckpointError
from kinetix.paths import checkpoints_dir
from kinetix.wording import plural


def environment_for(player: Player, capacity: Capacity, *, physics: str) -> KinetixEnv:
    """The environment that a player expects: its bindings, frame skip, step and observation.

    Args:
        player: Who will play.
        capacity: Sizes of the levels.
        physics: Physics preset or solver.
    """
    card = player.card
    sizes = card.capacity
    bindings: Any = (
        {}
        if sizes is None
        else {
            "num_motor_bindings": sizes.motor_bindings,
            "num_thruster_bindings": sizes.thruster_bindings,
        }
    )
    static_env_params = static_env_params_of(
        capacity, frame_skip=card.environment.frame_skip, physics=physics, **bindings
    )
    env_params = EnvParams(
        dt=card.environment.dt, dense_reward_scale=card.environment.dense_reward_scale
    )
    sees_simulator = card.observation.type == SimulatorObservations.name
    env: Any = make_kinetix_env(
        action_type=card.action.type,
        observation_type="blind" if sees_simulator else card.observation.type,
        env_params=env_params,
        static_env_params=static_env_params,
        auto_reset=False,
    )
    if sees_simulator:
        layout = Layout.of(env_params, static_env_params)
        return dataclasses.replace(env, observations=SimulatorObservations(layout=layout))
    observations = observations_of_card(card, env_params, static_env_params)
    return dataclasses.replace(env, observations=observations)


def capacity_for(card: AgentCard, capacity: Capacity, *, level: str) -> Capacity:
    """Return the sizes at which an agent plays a level: the level's, or the agent's only ones.

    Args:
        card: The agent.
        capacity: Sizes of the level.
        level: What the level is called, for the sentence.

    Raises:
        CheckpointError: The agent sees one size only and the level is larger.
    """
    own = card.capacity
    if own is None or card.plays_any_capacity:
        return capacity
    if not card.sees(capacity):
        raise CheckpointError(
            f"agent {card.name!r} sees exactly {_sizes(own.sizes)}, which is too small for "
            f"{level} with {_sizes(capacity)} (the arena's four sides count)"
            f"{_others(capacity)}"
        )
    return own.sizes


def _sizes(capacity: Capacity) -> str:
    sizes = dataclasses.asdict(capacity).items()
    return ", ".join(plural(value, name.removesuffix("s")) for name, value in sizes)


def _others(capacity: Capacity) -> str:
    """Return a hint at the bundled agents that see as much as a level has."""
    cards = {name: read_card(checkpoints_dir() / name / CARD)[0] for name in agent_names()}
    able = [name for name, card in cards.items() if card.sees(capacity)]
    return f"; of the bundled agents {', '.join(able)} can" if able else ""
