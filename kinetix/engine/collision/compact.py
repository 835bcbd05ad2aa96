"""Lists of what holds in each world, of a fixed length. Worlds on the last axis."""

import jax.numpy as jnp
import numpy as np
from jaxtyping import Array, Bool, Int

from kinetix.engine.lookup import accumulate, row


def compact(mask: Bool[Array, "q n"], room: int) -> tuple[Int[Array, "k n"], Bool[Array, "k n"]]:
    """Return the rows where the mask holds, in order, in `room` slots; and which slots are used."""
    count, worlds = mask.shape
    numbers = np.arange(1, room + 1, dtype=np.int32)[:, None]

    def pass_row(k: Int[Array, ""], carry: tuple[Array, Array]) -> tuple[Array, Array]:
        seen, index = carry
        seen += row(mask, k)
        return seen, index + (seen < numbers)

    start = jnp.zeros((1, worlds), jnp.int32), jnp.zeros((room, worlds), jnp.int32)
    _, index = accumulate(count, pass_row, start)
    return jnp.minimum(index, count - 1), index < count
