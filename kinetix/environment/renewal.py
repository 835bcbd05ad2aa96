"""Where an episode ends, the next one begins: new states for the worlds that are done."""

import dataclasses
import functools
from collections.abc import Callable
from typing import Any, Final

import jax
import jax.numpy as jnp
from jax.custom_batching import custom_vmap
from jaxtyping import Array, Bool

from kinetix.engine.pipeline import empty_cache
from kinetix.engine.spec import Capacity
from kinetix.environment.params import PhysicsEngine
from kinetix.environment.state import EnvState
from kinetix.errors import KinetixError
from kinetix.level.compile import capacity_of_world

CHUNK: Final = 32
"""Worlds that are renewed at once. Too few and many endings in one step take many rounds; too many
and one ending pays for levels that nobody needs."""


def renewing(start: Callable[..., Any]) -> Callable[..., Any]:
    """A function that replaces what an episode has left behind where the episode is over.

    Random levels are costly, so under `vmap` they are drawn only for the worlds that need one: the
    indices of those are compacted and worked off `CHUNK` at a time. Every world's level comes from
    its own seed, the same one as if it were alone.

    Args:
        start: From the seeds of one world (any pytree) to what the next episode begins with.

    Returns:
        A function of what there is, whether the episode is over, and the seeds.
    """

    @custom_vmap
    def many(old: Any, done: Bool[Array, " n"], seeds: Any) -> Any:
        return _renew(old, done, seeds, jax.vmap(start))

    @many.def_vmap
    def _(axis_size: int, batched: list[Any], *arguments: Any) -> tuple[Any, Any]:
        worlds = arguments[1].shape[-1]
        lifted = jax.tree.map(functools.partial(_lifted, axis_size), arguments, tuple(batched))
        merged = jax.tree.map(lambda x: x.reshape(axis_size * worlds, *x.shape[2:]), lifted)
        out = jax.tree.map(lambda x: x.reshape(axis_size, worlds, *x.shape[1:]), many(*merged))
        return out, jax.tree.map(lambda _: True, out)

    @custom_vmap
    def one(old: Any, done: Bool[Array, ""], seeds: Any) -> Any:
        return jax.lax.cond(done, lambda: _like(start(seeds), old), lambda: old)

    @one.def_vmap
    def _(axis_size: int, batched: list[Any], *arguments: Any) -> tuple[Any, Any]:
        out = many(*jax.tree.map(functools.partial(_lifted, axis_size), arguments, tuple(batched)))
        return out, jax.tree.map(lambda _: True, out)

    return one


def _lifted(axis_size: int, x: Any, has_axis: bool) -> Any:
    return x if has_axis else jnp.broadcast_to(x, (axis_size, *jnp.shape(x)))


def _like(new: Any, old: Any) -> Any:
    return jax.tree.map(lambda a, b: a.astype(b.dtype), new, old)


def _renew(old: Any, done: Bool[Array, " n"], seeds: Any, start: Callable[..., Any]) -> Any:
    """Replace the rows of the worlds that are done."""
    worlds = done.shape[0]
    chunk = min(CHUNK, worlds)
    (rows,) = jnp.nonzero(done, size=worlds, fill_value=worlds)
    rows = jnp.pad(rows, (0, chunk), constant_values=worlds)
    count = jnp.sum(done)

    def unfinished(carry: tuple[Array, Any]) -> Bool[Array, ""]:
        return carry[0] < count

    def renew_chunk(carry: tuple[Array, Any]) -> tuple[Array, Any]:
        first, old = carry
        chosen = jax.lax.dynamic_slice_in_dim(rows, first, chunk)
        new = start(jax.tree.map(lambda x: jnp.take(x, chosen, axis=0, mode="clip"), seeds))
        replaced = jax.tree.map(lambda a, b: a.at[chosen].set(b, mode="drop"), old, _like(new, old))
        return first + chunk, replaced

    return jax.lax.while_loop(unfinished, renew_chunk, (jnp.zeros((), count.dtype), old))[1]


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
    cache = empty_cache(engine.spec, engine.solver)
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
    return "; ".join(parts) + " (kinetix.environment.rearrange.expand_state makes a level larger)"
