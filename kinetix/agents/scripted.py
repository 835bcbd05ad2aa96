"""Players that learnt nothing: doing nothing, and doing anything."""

import dataclasses
from typing import Any

import jax
import jax.numpy as jnp
from jaxtyping import Array

from kinetix.agents.card import ActionCard, AgentCard, ObservationCard
from kinetix.agents.player import ROWS, Decision
from kinetix.environment.actions import AbstractAction, MultiDiscreteActions
from kinetix.errors import CheckpointError

SCRIPTED = ("noop", "random")
"""Names of the scripted players."""


@dataclasses.dataclass(frozen=True, kw_only=True)
class ScriptedPolicy:
    """Acts without looking; see `player.Policy`."""

    actions: AbstractAction
    random: bool

    rows = ROWS

    def init_carry(self, batch: int) -> tuple[()]:
        """Return an empty memory."""
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
        """See `player.Policy`; `deterministic` changes nothing."""
        del params, observation, done, deterministic
        if self.random:
            action = jax.vmap(self.actions.random_action)(keys)
        else:
            one = self.actions.noop_action()
            action = jnp.broadcast_to(one, (keys.shape[0], *jnp.shape(one)))
        return action, carry, {}


class ScriptedPlayer:
    """A player that learnt nothing.

    Attributes:
        card: Its description; it ignores observations.
        params: Nothing.
        policy: How it chooses.
    """

    def __init__(self, name: str, actions: AbstractAction | None = None) -> None:
        """Make a scripted player.

        Args:
            name: "noop" or "random".
            actions: The environment's kind of action; by default multi-discrete ones.

        Raises:
            CheckpointError: Another name.
        """
        if name not in SCRIPTED:
            raise CheckpointError(f"player: expected {' or '.join(SCRIPTED)}, got {name!r}")
        actions = actions or MultiDiscreteActions()
        self.card = AgentCard(
            name=name,
            observation=ObservationCard(type="blind"),
            action=ActionCard(type=actions.name),
        )
        self.params: dict[str, Any] = {}
        self.policy = ScriptedPolicy(actions=actions, random=name == "random")

    def init_carry(self, batch: int) -> tuple[()]:
        """Return an empty memory."""
        return self.policy.init_carry(batch)

    def decide(self, *arguments: Any, deterministic: bool = False) -> Decision:
        """Return the policy's own `decide`; see `player.Policy`."""
        return self.policy.decide(*arguments, deterministic=deterministic)
