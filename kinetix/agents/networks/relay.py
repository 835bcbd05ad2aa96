"""Networks that take turns: where one has not won after a while, another goes on.

A policy that is nearly certain of what to do wins a level always or never, and which levels those
are differs from one checkpoint of a training to the next. So what one tries in vain, another wins.
"""

import jax
import jax.numpy as jnp
from flax import linen as nn
from jaxtyping import Array, Bool, Float, Int

from kinetix.agents.networks.heads import Output
from kinetix.agents.networks.recurrent import Carry


class RelayNetwork(nn.Module):
    """Networks without memory, one of which decides at a time.

    The first column of the second recurrent state counts the decisions of an episode.
    """

    members: tuple[nn.Module, ...]
    """In parameter trees they are called members_0, members_1, …"""
    turn: int
    """Decisions after which the next one takes over; after the last it is the first again."""

    @nn.compact
    def __call__(
        self, carry: Carry, inputs: tuple[object, Bool[Array, "k n"]], *, train: bool = False
    ) -> Output:
        """See `heads.ActorCriticHead`; logits and value are those of the one whose turn it is."""
        counter, before = _counted(carry[1], inputs[1])
        at_turn = (before // self.turn) % len(self.members)
        _, policy, value = self.members[0](carry, inputs, train=train)
        logits = policy.logits
        for index, member in enumerate(self.members[1:], start=1):
            _, other, worth = member(carry, inputs, train=train)
            logits = jnp.where((at_turn == index)[..., None], other.logits, logits)
            value = jnp.where(at_turn == index, worth, value)
        return (carry[0], counter), policy.replace(logits=logits), value


def _counted(
    counter: Float[Array, "n h"], dones: Bool[Array, "k n"]
) -> tuple[Float[Array, "n h"], Int[Array, "k n"]]:
    """The counter after some decisions, and the decisions of the episode before each of them."""

    def count(number: Array, done: Array) -> tuple[Array, Array]:
        before = jnp.where(done, 0.0, number)
        return before + 1.0, before

    last, before = jax.lax.scan(count, counter[:, 0], dones)
    return counter.at[:, 0].set(last), before.astype(jnp.int32)
