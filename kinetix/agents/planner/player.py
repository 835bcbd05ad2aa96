"""The planner as a player beside trained agents and scripted ones."""

from typing import Any, Final

import jax.numpy as jnp

from kinetix.agents.card import ActionCard, AgentCard, ObservationCard
from kinetix.agents.planner.policy import Mind, PlannerPolicy
from kinetix.agents.planner.simulator import SimulatorObservations
from kinetix.agents.player import PLANNER, Decision

ROUNDS: Final = 2
"""Rounds whenever it plans again."""
FIRST: Final = 64
"""Most rounds before its first move: it stops at the first plan that wins."""
DESCRIPTION: Final = (
    "Plans with the simulator itself: it tries many futures and plays the best. It learnt nothing "
    "and knows what no trained agent knows, so its wins are no measure of theirs."
)


class Planner:
    """A player that knows the simulator.

    Attributes:
        card: Its description.
        params: How many rounds it plans; see `PlannerPolicy`.
        policy: How it chooses.
    """

    def __init__(self, *, rounds: int = ROUNDS, first: int = FIRST) -> None:
        """Make the planner.

        Args:
            rounds: Rounds of futures whenever it plans again.
            first: Rounds before its first move.
        """
        self.card = AgentCard(
            name=PLANNER,
            description=DESCRIPTION,
            observation=ObservationCard(type=SimulatorObservations.name),
            action=ActionCard(type="multi_discrete"),
        )
        self.params: dict[str, Any] = {
            "rounds": jnp.asarray(rounds, jnp.int32),
            "first": jnp.asarray(first, jnp.int32),
        }
        self.policy = PlannerPolicy()

    def init_carry(self, batch: int) -> Mind:
        """Return the memory without a plan."""
        return self.policy.init_carry(batch)

    def decide(self, *arguments: Any, deterministic: bool = False) -> Decision:
        """Return the policy's own `decide`; see `player.Policy`."""
        return self.policy.decide(*arguments, deterministic=deterministic)
