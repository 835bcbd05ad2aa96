"""Other sources of levels for training: all sizes mixed, and the simple starts of ACCEL."""

import dataclasses
import functools
from collections.abc import Callable
from typing import Final

import jax
import jax.numpy as jnp
from jaxtyping import Array, Bool, Key, UInt

from kinetix.engine.spec import Capacity
from kinetix.environment.generators.blocks import SizeLimit
from kinetix.environment.generators.draft import (
    Draft,
    empty_draft,
    shuffle_length,
    shuffled,
    states,
)
from kinetix.environment.generators.draws import Tape, among, sampler_of
from kinetix.environment.generators.mutators import (
    NUMBERS,
    add_connected_shape,
    add_shape,
    add_thruster,
)
from kinetix.environment.generators.params import UEDParams, checked_options
from kinetix.environment.generators.sample import draw_levels
from kinetix.environment.params import PhysicsEngine
from kinetix.environment.state import EnvState
from kinetix.errors import KinetixError
from kinetix.level.sizes import AUTOMATIC, SIZES, describe_capacity

LARGE_CHANCE: Final = 0.05
"""Probability that a shape of an ACCEL start has the large limits."""
LARGE: Final = (2.0, 1.0)
"""max_shape_size [m] and goal_body_size_factor of those shapes."""
SMALL: Final = (0.5, 2.0)
"""The same of all others."""
START_THRUSTER_POWER: Final = 2.0
"""thruster_power_multiplier of ACCEL starts."""


@functools.cache
def mixed_sampler(
    engine: PhysicsEngine, ued_params: UEDParams | None = None
) -> Callable[[Key[Array, ""]], EnvState]:
    """Return the function from a key to a random level of size s, m or l, equally often.

    Args:
        engine: Sizes and solver; levels of smaller sizes leave slots empty.
        ued_params: The options; None for the defaults.

    Raises:
        KinetixError: Not even the smallest size fits.
    """
    ued = checked_options(ued_params)
    slots = engine.spec.capacity
    sizes = [SIZES[name] for name in AUTOMATIC if slots.covers(SIZES[name])]
    if not sizes:
        raise KinetixError(
            f"size {describe_capacity(slots)}: random levels of all sizes need the slots of size "
            f"{AUTOMATIC[0]} at least"
        )

    def batched(keys: UInt[Array, "n 2"]) -> EnvState:
        drafts = [draw_levels(keys, size, ued, slots) for size in sizes]
        choice = jax.vmap(
            lambda key: jax.random.uniform(jax.random.fold_in(key, 1), (), jnp.float32)
        )(jax.random.wrap_key_data(keys))
        choice = among(choice, len(sizes))
        mixed = drafts[0]
        for index, draft in enumerate(drafts[1:], start=1):
            mixed = jax.tree.map(functools.partial(_where, choice == index), draft, mixed)
        return states(mixed, engine, ued.inertia_model)

    return sampler_of(batched)


def _where(condition: Bool[Array, " n"], new: Array, old: Array) -> Array:
    return jnp.where(condition.reshape((1,) * (old.ndim - 1) + condition.shape), new, old)


@functools.cache
def accel_start_sampler(
    engine: PhysicsEngine, ued_params: UEDParams | None = None
) -> Callable[[Key[Array, ""]], EnvState]:
    """Return the function from a key to a simple level: green, blue, and something that drives.

    Args:
        engine: Sizes and solver.
        ued_params: The options besides those that this distribution sets; None for the defaults.

    It is the distribution that kinetix-env 3.0.2 describes; its own function fails when called.
    """
    ued = dataclasses.replace(
        checked_options(ued_params), thruster_power_multiplier=START_THRUSTER_POWER
    )

    def batched(keys: UInt[Array, "n 2"]) -> EnvState:
        return states(_draw_starts(keys, engine.spec.capacity, ued), engine, ued.inertia_model)

    return sampler_of(batched)


def _draw_starts(keys: UInt[Array, "n 2"], capacity: Capacity, ued: UEDParams) -> Draft:
    worlds = keys.shape[0]
    tape = Tape(keys, 4 * (NUMBERS + 1) + 1 + shuffle_length(capacity))
    draft = empty_draft(worlds, capacity, legacy_ceiling=ued.legacy_ceiling)
    everywhere = jnp.ones((worlds,), bool)
    for _ in range(2):
        draft = add_shape(
            draft, tape.take(NUMBERS), everywhere, ued, capacity, size=_drawn_size(tape)
        )
    # One of (thruster, motor) = (0, 1), (1, 0), (1, 1).
    control = tape.take(1)[0]
    motor = (control < 1 / 3) | (control >= 2 / 3)
    draft = add_connected_shape(
        draft,
        tape.take(NUMBERS),
        motor,
        ued,
        capacity,
        force_rjoint=True,
        size=_drawn_size(tape),
    )
    draft = add_thruster(draft, tape.take(NUMBERS), control >= 1 / 3, ued, capacity)
    return shuffled(draft, tape.take(shuffle_length(capacity)), capacity, capacity)


def _drawn_size(tape: Tape) -> SizeLimit:
    large = tape.take(1) < LARGE_CHANCE
    return SizeLimit(
        limit=jnp.where(large, LARGE[0], SMALL[0]), goal_factor=jnp.where(large, LARGE[1], SMALL[1])
    )
