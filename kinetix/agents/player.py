"""What plays: the interface that trained agents and scripted ones share."""

from typing import Any, Protocol

from jaxtyping import Array

from kinetix.agents.card import AgentCard
from kinetix.agents.networks.distributions import Distribution

Decision = tuple[Any, Any, dict[str, Array]]
"""Action, the next carry, and what is known about the action."""


class Player(Protocol):
    """Something that chooses actions for a batch of environments.

    `decide` is pure: it can be compiled into a larger loop, with `params` as an argument.
    """

    @property
    def card(self) -> AgentCard:
        """What it sees, says and was trained for."""
        ...

    @property
    def params(self) -> Any:
        """Whatever `decide` needs, as a pytree of arrays."""
        ...

    def init_carry(self, batch: int) -> Any:
        """Memory at the start of `batch` episodes."""
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
        """Choose actions.

        Args:
            params: As in `params`.
            carry: From `init_carry` or the last call.
            observation: With a leading axis of environments.
            keys: A random key for each environment, so that none depends on its neighbours.
            done: Where true, an episode has just begun and the carry starts anew.
            deterministic: Take the likeliest action instead of drawing one.

        Returns:
            Actions, the next carry, and `logits`, `log_prob`, `value`, `entropy`.
        """
        ...


def sample_each(policy: Distribution, keys: Array) -> Array:
    """One draw an environment, each from its own key.

    Args:
        policy: Distributions with one leading axis.
        keys: As many keys.
    """
    import jax

    made: Any = policy
    return jax.vmap(lambda logits, key: made.replace(logits=logits).sample(key))(
        policy.logits, keys
    )
