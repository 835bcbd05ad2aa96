"""Players that learnt nothing: doing nothing, and doing anything."""

from typing import Any

import jax
import jax.numpy as jnp
from jaxtyping import Array

from kinetix.agents.card import ActionCard, AgentCard, ObservationCard
from kinetix.agents.player import Decision
from kinetix.environment.actions import AbstractAction, MultiDiscreteActions
from kinetix.errors import CheckpointError

SCRIPTED = ("noop", "random")
"""Names of the scripted players."""


class ScriptedPlayer:
    """Acts without looking.

    Attributes:
        card: Says what it is; it sees the flat observation, which it ignores.
        params: Nothing.
    """

    def __init__(self, name: str, actions: AbstractAction | None = None) -> None:
        """Make one.

        Args:
            name: "noop" or "random".
            actions: The environment's kind of action; by default multi-discrete ones.

        Raises:
            CheckpointError: Another name.
        """
        if name not in SCRIPTED:
            raise CheckpointError(f"player: expected {' or '.join(SCRIPTED)}, got {name!r}")
        self._actions = actions or MultiDiscreteActions()
        self.card = AgentCard(
            name=name,
            observation=ObservationCard(type="blind"),
            action=ActionCard(type=self._actions.name),
        )
        self.params: dict[str, Any] = {}

    def init_carry(self, batch: int) -> tuple[()]:
        """Nothing to remember."""
        del batch
        return ()

    def decide(
        self,
        params: Any,
        carry: Any,
        observation: Any,
        keys: Array,
        done: Array,
        *,
        deterministic: bool = False,
    ) -> Decision:
        """See `player.Player`."""
        del params, observation, done, deterministic
        if self.card.name == "random":
            action = jax.vmap(self._actions.random_action)(keys)
        else:
            one = self._actions.noop_action()
            action = jnp.broadcast_to(one, (keys.shape[0], *jnp.shape(one)))
        return action, carry, {}
