"""Loops around a whole step are compiled in parts.

XLA's CPU compiler makes one machine routine of a loop that moves little memory. For the loops of a
solver that is what one wants: they run without a call between two operations. Around a whole step
of a few worlds it is not: LLVM takes twice as long for one routine of 24 000 operations as for its
parts, and the step gains a sixth. A loop that looks for a largest number (`top_k`) is left as it
is, so a step looks for the larger one of two. A sort would do as well, but a program with a sort
cannot be written to disk once it has run. See docs/experiments/2026-11-22_xla_cpu.md.
"""

from typing import TypeVar

import jax
import jax.numpy as jnp

from kinetix.engine.store import Store

T = TypeVar("T")


def in_parts(tree: T) -> T:
    """Keep the loop in which this is called from becoming one machine routine, on a processor.

    Args:
        tree: What the loop's body computes, with floats in it that change from turn to turn: what
            does not is computed before the loop. Without floats it is returned as it is.

    Returns:
        The same values.
    """
    leaves, structure = jax.tree.flatten(tree)
    floats = [x for x in leaves if x.size and jnp.issubdtype(x.dtype, jnp.floating)]
    if not floats:
        return tree
    number = floats[0].ravel()[0].astype(jnp.float32)
    (larger,), _ = jax.lax.top_k(jnp.stack([number, number]), 1)
    store = Store.beside(larger)
    _, smallest = min((x.size, i) for i, x in enumerate(leaves) if x.size)
    leaves[smallest] = store(leaves[smallest])
    return jax.tree.unflatten(structure, leaves)
