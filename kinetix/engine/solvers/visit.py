"""Visiting slots (contacts, joints) that each change two bodies: in turn, or all at once.

A slot reads its two bodies, decides, and changes them. `in_turn` is Gauss–Seidel: each slot sees
what the ones before it did. `together` is Jacobi: all see the same bodies. Both take the same
`solve`, which is written without regard to whether its arrays have an axis of slots.

Worlds are on the last axis; which bodies a slot acts on may differ from world to world.
"""

from collections.abc import Callable
from typing import Any

import jax
import jax.numpy as jnp
import numpy as np
from jaxtyping import Array, Bool, Float, Int

from kinetix.engine.lookup import onto, take
from kinetix.engine.maths import nonzero
from kinetix.pytree import pytree


@pytree
class Twist:
    """Three numbers a body (or a slot): a velocity [m/s, rad/s] or a displacement [m, rad]."""

    x: Float[Array, "*k n"]
    y: Float[Array, "*k n"]
    turn: Float[Array, "*k n"]

    def __add__(self, other: "Twist") -> "Twist":
        return Twist(x=self.x + other.x, y=self.y + other.y, turn=self.turn + other.turn)

    def __sub__(self, other: "Twist") -> "Twist":
        return Twist(x=self.x - other.x, y=self.y - other.y, turn=self.turn - other.turn)

    def __mul__(self, scale: Float[Array, "..."]) -> "Twist":
        return Twist(x=self.x * scale, y=self.y * scale, turn=self.turn * scale)


@pytree
class Targets:
    """Bodies of a visit, and how many slots share each of them (`together` only)."""

    body_a: Int[Array, "k n"]
    body_b: Int[Array, "k n"]
    share_a: Float[Array, "k n"]
    share_b: Float[Array, "k n"]


Solve = Callable[[Any, Twist, Twist, Any], tuple[Twist, Twist, Any]]
"""(what is known of a slot, body a, body b, its memory) → (changes of a and b, its memory)."""

Visit = Callable[[Twist, Targets, Any, Any, Solve], tuple[Twist, Any]]
"""(all bodies, slots, what is known of them, their memory, solve) → (all bodies, memory)."""


def at_bodies(motion: Twist, body: Int[Array, "k n"]) -> Twist:
    """Return the motion of each slot's body."""
    return take(motion, body)


def add_changes(
    motion: Twist,
    body_a: Int[Array, "k n"],
    body_b: Int[Array, "k n"],
    change_a: Twist,
    change_b: Twist,
) -> Twist:
    """Return all bodies after the changes of all slots."""
    count = motion.turn.shape[0]
    return motion + onto(change_a, body_a, count) + onto(change_b, body_b, count)


def in_turn(
    motion: Twist, targets: Targets, known: Any, memory: Any, solve: Solve
) -> tuple[Twist, Any]:
    """Visit one slot after the other.

    What a slot changes is carried to the next one and added there. So the bodies' arrays come out
    of memory, and not out of a chain of impulses that XLA would recompute for every body
    (docs/physics.md).
    """
    count, worlds = targets.body_a.shape
    if count == 0:
        return motion, memory
    index = np.arange(motion.turn.shape[0])[:, None]
    nothing = jax.tree.map(lambda values: jnp.zeros(worlds, values.dtype), motion)

    def settled(motion: Twist, change: tuple) -> Twist:
        is_a, is_b = index == change[0], index == change[1]
        return jax.tree.map(
            lambda values, to_a, to_b: values + jnp.where(is_a, to_a, 0) + jnp.where(is_b, to_b, 0),
            motion,
            change[2],
            change[3],
        )

    def read(motion: Twist, here: Bool[Array, "b n"]) -> Twist:
        return jax.tree.map(lambda values: jnp.sum(jnp.where(here, values, 0), axis=0), motion)

    def one(carry: tuple, slot: tuple) -> tuple[tuple, Any]:
        motion = settled(*carry)
        a, b, item, remembered = slot
        change_a, change_b, remembered = solve(
            item, read(motion, index == a), read(motion, index == b), remembered
        )
        return (motion, (a, b, change_a, change_b)), remembered

    first = jnp.zeros(worlds, targets.body_a.dtype)
    (motion, change), memory = jax.lax.scan(
        one,
        (motion, (first, first, nothing, nothing)),
        (targets.body_a, targets.body_b, known, memory),
    )
    return settled(motion, change), memory


def together(
    motion: Twist, targets: Targets, known: Any, memory: Any, solve: Solve
) -> tuple[Twist, Any]:
    """Visit all slots at once; each works on its own copy of its bodies, then copies are averaged.

    `known` must hold the masses of the copies: a body shared by three slots is split into three of
    a third of its mass each.
    """
    if targets.body_a.shape[0] == 0:
        return motion, memory
    change_a, change_b, memory = solve(
        known, at_bodies(motion, targets.body_a), at_bodies(motion, targets.body_b), memory
    )
    return (
        add_changes(
            motion,
            targets.body_a,
            targets.body_b,
            change_a * (1 / nonzero(targets.share_a)),
            change_b * (1 / nonzero(targets.share_b)),
        ),
        memory,
    )
