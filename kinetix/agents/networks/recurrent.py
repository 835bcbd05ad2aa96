"""Memory: a gated recurrent unit over time that forgets where an episode ended."""

import functools

import jax.numpy as jnp
from flax import linen as nn
from jaxtyping import Array, Bool, Float

HIDDEN_SIZE = 256
"""Width of the recurrent state."""

Carry = tuple[Float[Array, "n 256"], Float[Array, "n 256"]]
"""The recurrent state of a batch: always a pair; networks with one embedding use the first."""


def initial_carry(batch: int, hidden_size: int = HIDDEN_SIZE) -> Carry:
    """Recurrent state at the start of an episode: zeros.

    Args:
        batch: Number of environments.
        hidden_size: Width of the state.
    """
    return (jnp.zeros((batch, hidden_size)), jnp.zeros((batch, hidden_size)))


class ScannedRNN(nn.Module):
    """A GRU over the leading (time) axis. Where `done` is true the state is zeroed first."""

    @staticmethod
    def initialize_carry(batch_size: int, hidden_size: int = HIDDEN_SIZE) -> Carry:
        """Return what every network takes as memory at the start of episodes: zeros."""
        return initial_carry(batch_size, hidden_size)

    @functools.partial(
        nn.scan,
        variable_broadcast="params",
        split_rngs={"params": False},
        in_axes=0,
        out_axes=0,
    )
    @nn.compact
    def __call__(
        self, carry: Float[Array, "n h"], inputs: tuple[Float[Array, "n e"], Bool[Array, " n"]]
    ) -> tuple[Float[Array, "n h"], Float[Array, "n h"]]:
        """Return one step (the scan adds the time axis to `inputs` and to the second result)."""
        embedding, done = inputs
        carry = jnp.where(done[:, None], 0.0, carry)
        # The published trees call the cell GRUCell_1: another module took number 0 there.
        return nn.GRUCell(features=HIDDEN_SIZE, name="GRUCell_1")(carry, embedding)
