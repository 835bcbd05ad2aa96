"""Players: the interface that trained agents and scripted ones share."""

from typing import Any, Final, Protocol

import jax
from jaxtyping import Array

from kinetix.agents.card import AgentCard
from kinetix.agents.networks.distributions import Distribution

PLANNER: Final = "planner"
"""Name of the player that knows the simulator."""
ROWS: Final = 64
"""Episodes of a network that run at once on each device: one tile of worlds."""

Decision = tuple[Any, Any, dict[str, Any]]
"""Action, the next carry, and what is known about the action."""


class Policy(Protocol):
    """A way to choose actions: a pure function that is hashable by value.

    Two players with equal policies share compiled code; what differs is in their `params`.
    """

    @property
    def rows(self) -> int:
        """Episodes that run at once on each device when it is measured.

        Always the same number, so that rounding depends neither on how many levels are asked for
        nor on how many devices there are.
        """
        ...

    def init_carry(self, batch: int) -> Any:
        """Return the memory at the start of `batch` episodes."""
        ...

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
        """Choose actions for a batch of environments.

        Args:
            params: Parameters of the policy.
            carry: From `init_carry` or the last call.
            observation: With a leading axis of environments.
            keys: A random key for each environment, so that none depends on its neighbours.
            done: True where an episode has just begun: the carry is reset.
            deterministic: Take the likeliest action instead of drawing one.

        Returns:
            Actions, the next carry, and, where there is a network, `logits`, `log_prob`, `value`,
            `entropy` (both of all controls) and `policy`, the distribution.
        """
        ...


class Player(Protocol):
    """Something that plays: a policy, the arrays that it needs, and what it was made for."""

    @property
    def card(self) -> AgentCard:
        """Description of what it observes, how it acts and what it was trained for."""
        ...

    @property
    def params(self) -> Any:
        """Arguments of its policy, as a pytree of arrays."""
        ...

    @property
    def policy(self) -> Policy:
        """The way it chooses actions."""
        ...


def sample_each(policy: Distribution, keys: Array) -> Array:
    """One draw an environment, each from its own key.

    Args:
        policy: Distributions with one leading axis.
        keys: As many keys.
    """
    made: Any = policy
    return jax.vmap(lambda logits, key: made.replace(logits=logits).sample(key))(
        policy.logits, keys
    )
