"""Where an episode ends, the next one begins: new states for the worlds that are done."""

import dataclasses
from collections.abc import Callable
from typing import Any, Final

import jax
import jax.numpy as jnp
from jaxtyping import Array, Bool

from kinetix.engine.spec import Capacity
from kinetix.environment.params import PhysicsEngine
from kinetix.environment.state import EnvState
from kinetix.errors import KinetixError
from kinetix.level.compile import capacity_of_world

CHUNK: Final = 32
"""Worlds that are renewed at once. Too few and many endings in one step take many rounds; too many
and one ending pays for levels that nobody needs."""


def renew(
    state: EnvState,
    done: Bool[Array, " n"],
    key: Array,
    override: EnvState | None,
    start: Callable[[Array, EnvState | None], EnvState],
) -> EnvState:
    """Replace the states of the worlds that are done; all arrays carry the worlds last.

    Random levels are costly, so they are drawn only for the worlds that need one: the indices of
    those are compacted and worked off `CHUNK` at a time. Every world's level comes from its own
    key, the same one as if it were alone.

    Args:
        state: States at the end of the step.
        done: Which episodes are over.
        key: One key a world.
        override: The states to start in, or None to draw them.
        start: Gives the state of one world from its key and its override.
    """
    worlds = done.shape[-1]
    chunk = min(CHUNK, worlds)
    (rows,) = jnp.nonzero(done, size=worlds, fill_value=worlds)
    rows = jnp.pad(rows, (0, chunk), constant_values=worlds)
    count = jnp.sum(done)
    start_many = jax.vmap(start, in_axes=-1, out_axes=-1)

    def unfinished(carry: tuple[Array, EnvState]) -> Bool[Array, ""]:
        return carry[0] < count

    def renew_chunk(carry: tuple[Array, EnvState]) -> tuple[Array, EnvState]:
        first, state = carry
        chosen = jax.lax.dynamic_slice_in_dim(rows, first, chunk)
        picked = jax.tree.map(lambda x: jnp.take(x, chosen, axis=-1, mode="clip"), (key, override))
        fresh = start_many(*picked)
        state = jax.tree.map(
            lambda old, new: old.at[..., chosen].set(new.astype(old.dtype), mode="drop"),
            state,
            fresh,
        )
        return first + chunk, state

    return jax.lax.while_loop(unfinished, renew_chunk, (jnp.zeros((), count.dtype), state))[1]


def fitted(state: EnvState, engine: PhysicsEngine) -> EnvState:
    """A state as the environment can step it: dtypes settled, the solver's memory its own.

    A state that was made for another solver keeps its bodies; its memory of contacts starts empty.

    Raises:
        KinetixError: The state has other capacities than the environment; the message says which
            of polygons, circles, joints, thrusters and by how much.
    """
    have, need = capacity_of_world(state.world), engine.spec.capacity
    if have != need:
        raise KinetixError(f"the level does not fit the environment: {_difference(have, need)}")
    physics = state.physics
    cache = engine.solver.empty_cache(engine.spec)
    if _shapes(physics.cache) != _shapes(cache):
        physics = dataclasses.replace(physics, cache=cache)
    return jax.tree.map(
        lambda x: jax.lax.convert_element_type(jnp.asarray(x), jnp.asarray(x).dtype),
        dataclasses.replace(state, physics=physics),
    )


def _shapes(tree: Any) -> Any:
    leaves, structure = jax.tree.flatten(tree)
    return structure, [(jnp.shape(leaf), jnp.result_type(leaf)) for leaf in leaves]


def _difference(have: Capacity, need: Capacity) -> str:
    kinds = ("polygons", "circles", "joints", "thrusters")
    parts = [
        f"it has {getattr(have, kind)} slots of {kind}, the environment {getattr(need, kind)}"
        for kind in kinds
        if getattr(have, kind) != getattr(need, kind)
    ]
    return "; ".join(parts) + " (kinetix.environment.reset.expand_state makes a level larger)"
