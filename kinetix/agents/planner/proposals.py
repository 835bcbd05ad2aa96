"""Plans to try: controls that are held at random, and variations of plans that were good.

A plan is one multi-discrete action per environment step. Everything is written for one group of
plans and works under `vmap`. All chance comes in as uniform numbers, drawn at once: each draw of
its own would take a second to compile.
"""

from typing import Final

import jax
import jax.numpy as jnp
from jaxtyping import Array, Bool, Float, Int

from kinetix.level.model import MOTOR_BINDINGS, THRUSTER_BINDINGS

Plans = Int[Array, "n t 6"]
"""One multi-discrete action per plan and environment step."""

HOLD: Final = (1.5, 40.0)
"""Shortest and longest mean time for which a plan holds a control [environment steps]."""
STRETCH: Final = (2, 48)
"""Fewest and most environment steps of one control that a variation replaces."""
SHIFT: Final = 6
"""Most environment steps by which a variation comes earlier or later."""
CHANNELS: Final = MOTOR_BINDINGS + THRUSTER_BINDINGS
_CLASSES: Final = (3,) * MOTOR_BINDINGS + (2,) * THRUSTER_BINDINGS


def fresh_plans(chance: Float[Array, "n t k"], live: Bool[Array, " 6"]) -> Plans:
    """Return fresh random plans; each has a tempo of its own.

    Args:
        chance: Uniform numbers, two per control and step.
        live: Controls that the level has; the others stay 0.
    """
    shortest, longest = HOLD
    hold = shortest * (longest / shortest) ** chance[:, :1, :1]
    steps = jnp.arange(chance.shape[1])[:, None]
    changes = chance[..., :CHANNELS] < 1 / hold
    since = jax.lax.cummax(jnp.where(changes, steps, 0), axis=1)
    drawn = (chance[..., CHANNELS:] * jnp.array(_CLASSES)).astype(jnp.int8)
    return jnp.where(live, jnp.take_along_axis(drawn, since, axis=1), 0).astype(jnp.int8)


def varied_plans(
    chance: Float[Array, "n 6"], elite: Plans, fresh: Plans, live: Bool[Array, " 6"]
) -> Plans:
    """Return children of good plans: another end, another stretch, or the same a little shifted.

    Args:
        chance: Uniform numbers.
        elite: The parents, the best first: it has the most children.
        fresh: As many plans as there shall be children: what they take over where they differ.
        live: Controls that the level has.
    """
    steps = fresh.shape[1]
    # Squared: the best parents have the most children, and most changes come soon.
    parents = elite[_integer(chance[:, 0] ** 2, len(elite))]
    first = _integer(chance[:, 1] ** 2, steps)[:, None]
    last = first + STRETCH[0] + _integer(chance[:, 2], STRETCH[1] - STRETCH[0])[:, None]
    shift = _integer(chance[:, 3], 2 * SHIFT + 1)[:, None] - SHIFT
    # The control whose number among the live ones is drawn.
    number = _integer(chance[:, 4], jnp.maximum(jnp.sum(live), 1))[:, None]
    channel = live & (jnp.cumsum(live) - 1 == number)
    kind = _integer(chance[:, 5], 3)[:, None, None]
    times = jnp.arange(steps)[None]
    later = times >= first
    source = jnp.clip(jnp.where(later, times - shift, times), 0, steps - 1)
    ended = jnp.where(later[..., None], fresh, parents)
    patched = jnp.where((later & (times < last))[..., None] & channel[:, None], fresh, parents)
    moved = jnp.take_along_axis(parents, source[..., None], axis=1)
    return jnp.where(kind == 0, ended, jnp.where(kind == 1, patched, moved))


def _integer(chance: Float[Array, " n"], below: int | Array) -> Int[Array, " n"]:
    return (chance * below).astype(jnp.int32)
