"""From one world to many: `vmap(step)` runs the solvers' own batched kernel, worlds last.

A solver's arrays carry the worlds on the last axis, so that inner loops run over worlds instead of
over a handful of bodies. A primitive of our own lets callers write for one world, batch with `vmap`
(nested too) and still hit that kernel; and it is traced once only, when a program is compiled.

Three ways to say what a batch does: `worlds_last` runs a kernel tile by tile, `worlds_first` a
function of the whole batch, `where_marked` a function of one world for the worlds that need it.
"""

import dataclasses
import functools
import math
from collections.abc import Callable, Sequence
from typing import Any, Final

import jax
import jax.numpy as jnp
from jax.core import ShapedArray
from jax.custom_batching import custom_vmap
from jax.extend.core import Primitive
from jax.interpreters import ad, batching, mlir
from jaxtyping import Array, Bool, Int, Shaped

from kinetix.engine.garbage import uncollected
from kinetix.engine.lookup import put, row
from kinetix.engine.loops import in_parts
from kinetix.engine.machine import takes_whole_batches, whole_batches
from kinetix.engine.packing import pack, unpack
from kinetix.engine.promotion import usual_promotion
from kinetix.engine.store import Store
from kinetix.errors import KinetixError

Tree = Any

TILE: Final = 128
"""Most worlds that are advanced together: few enough for the cache, enough to fill the lanes."""

MARKED_AT_ONCE: Final = 32
"""Marked worlds that are made anew together, at least. With fewer, many marks in one step take many
rounds; with more, a single mark pays for worlds that nobody needs."""

SHARE: Final = 128
"""Of so many worlds one is worked on in a round: an episode is about twice as long."""


def in_a_round(worlds: int, least: int) -> int:
    """Count the worlds that are worked on together, where few of a batch need it in any one step.

    Args:
        worlds: Of the batch.
        least: So many at least, unless there are fewer.
    """
    return min(max(least, worlds // SHARE), worlds)


def worlds_last(
    kernel: Callable[..., Tree],
    effort: Callable[..., Int[Array, " n"]] | None = None,
    like: Callable[..., Tree] | None = None,
    tile: int = TILE,
) -> Callable[..., Tree]:
    """Give a kernel that works on arrays with a last axis of worlds the look of one for one world.

    Args:
        kernel: Takes pytrees whose arrays end in the axis `n`, some of them of floats; returns
            the same kind.
        effort: How much work each world will be, from the same arguments, if that differs. A tile
            takes as long as its hardest world: those of like effort are advanced together.
        like: Which of its arguments the kernel's result looks like, array for array, if any: then
            the kernel need not be traced to know what comes out.
        tile: Worlds that are advanced together.

    Returns:
        A function of the same pytrees without that axis.
    """

    def one(*arguments: Tree) -> Tree:
        wide = jax.tree.map(_alone_on_an_axis, arguments)
        leaves, structure = jax.tree.flatten(wide)
        program = _Program(kernel=kernel, effort=effort, like=like, tile=tile, structure=structure)
        results = _RUN.bind(*leaves, program=program)
        shapes = program.shapes(leaves)
        return jax.tree.unflatten(jax.tree.structure(shapes), [_without_axis(x) for x in results])

    return one


@dataclasses.dataclass(frozen=True, kw_only=True)
class _Program:
    """Program of the primitive; equal ones are compiled once."""

    kernel: Callable[..., Tree]
    effort: Callable[..., Int[Array, " n"]] | None
    like: Callable[..., Tree] | None
    tile: int
    structure: Any
    """Of the arguments."""

    def arguments(self, leaves: Sequence[Any]) -> tuple[Tree, ...]:
        """The kernel's arguments, with what worlds share repeated for each."""
        worlds = _count(leaves)
        wide = [jnp.broadcast_to(x, (*x.shape[:-1], worlds)) for x in leaves]
        return jax.tree.unflatten(self.structure, wide)

    def whole(self, *leaves: Array) -> list[Array]:
        """The results of all worlds at once, as an accelerator computes them."""
        with whole_batches():
            done = self.kernel(*self.arguments(leaves))
        return self.typed(done, leaves)

    def typed(self, done: Tree, leaves: Sequence[Any]) -> list[Array]:
        """What the kernel returned as a list, of the types that are promised."""
        shapes = self.results(leaves)
        return [x.astype(as_.dtype) for x, as_ in zip(jax.tree.leaves(done), shapes, strict=True)]

    def shapes(self, leaves: Sequence[Any]) -> Tree:
        """A tree like the kernel's result; only the shapes and types of its arrays are meant."""
        run = self.like or self.kernel
        return jax.eval_shape(lambda *leaves: run(*self.arguments(leaves)), *leaves)

    def results(self, leaves: Sequence[Any]) -> list[jax.ShapeDtypeStruct]:
        """The same as a list."""
        return jax.tree.leaves(self.shapes(leaves))


_RUN: Final = Primitive("worlds")
_RUN.multiple_results = True


@_RUN.def_impl
def _run(*leaves: Array, program: _Program) -> list[Array]:
    with jax.disable_jit(False):  # what runs is compiled, or it would end up here again
        return _alone(program)(*leaves)


@functools.lru_cache(maxsize=64)
def _alone(program: _Program) -> Callable[..., list[Array]]:
    """The primitive by itself, so that it is lowered for the device that runs it."""
    return jax.jit(functools.partial(_RUN.bind, program=program))


def _on_processor(*leaves: Array, program: _Program) -> list[Array]:
    with usual_promotion():
        return _compiled(program, takes_whole_batches())(*leaves)


def _on_accelerator(*leaves: Array, program: _Program) -> list[Array]:
    with usual_promotion():
        return _compiled(program, True)(*leaves)


@functools.lru_cache(maxsize=64)
def _compiled(program: _Program, whole: bool) -> Callable[..., list[Array]]:
    """Traced once for all its uses in a program.

    Environments make new kernels whenever they are traced: what is long unused must be let go.
    """

    @jax.jit
    def worlds(*leaves: Array) -> list[Array]:
        if not _count(leaves):
            return [jnp.zeros(x.shape, x.dtype) for x in program.results(leaves)]
        if whole:
            return program.whole(*leaves)
        return program.typed(in_parts(_by_tiles(program, leaves)), leaves)

    return worlds


@_RUN.def_abstract_eval
def _shapes(*leaves: Any, program: _Program) -> list[Any]:
    return [ShapedArray(x.shape, x.dtype) for x in program.results(leaves)]


def _batched(
    leaves: Sequence[Array], axes: Sequence[int | None], *, program: _Program
) -> tuple[list[Array], list[int]]:
    """Another axis of worlds is merged into the last one."""
    size = next(x.shape[axis] for x, axis in zip(leaves, axes, strict=True) if axis is not None)
    moved = [
        x if axis is None else jnp.moveaxis(x, axis, -2)
        for x, axis in zip(leaves, axes, strict=True)
    ]
    sizes = size, _count(moved)
    merged = [
        _merge(x[..., None, :] if axis is None else x, sizes)
        for x, axis in zip(moved, axes, strict=True)
    ]
    results = [x.reshape(*x.shape[:-1], *sizes) for x in _RUN.bind(*merged, program=program)]
    return results, [x.ndim - 2 for x in results]


def _merge(x: Array, sizes: tuple[int, int]) -> Array:
    """(…, m, n) to (…, m·n), or what all worlds share from (…, 1, 1) to (…, 1)."""
    if x.shape[-2:] == (1, 1):
        return _without_axis(x)
    return jnp.broadcast_to(x, (*x.shape[:-2], *sizes)).reshape(*x.shape[:-2], math.prod(sizes))


def _lowering(run: Callable[..., list[Array]]) -> Callable[..., Any]:
    """The rule by which a program is lowered."""
    rule = mlir.lower_fun(run, multiple_results=True)

    def lowered(*arguments: Any, **parameters: Any) -> Any:
        with uncollected():
            return rule(*arguments, **parameters)

    return lowered


def _on_cuda(context: Any, *arguments: Any, program: _Program) -> Any:
    """The rule for CUDA: a kernel of its own, else what any accelerator gets."""
    from kinetix.engine.native.launch import lowered  # here, as a processor never needs it

    done = lowered(context, arguments, program)
    if done is None:
        return _lowering(_on_accelerator)(context, *arguments, program=program)
    return done


def _no_derivative(*_: Any, program: _Program) -> Any:
    del program
    raise KinetixError(
        "the engine has no derivative: its sweeps end once they have converged, and contacts come "
        "and go; jax.lax.stop_gradient around what goes into a step makes it count as a constant"
    )


ad.primitive_jvps[_RUN] = _no_derivative
batching.primitive_batchers[_RUN] = _batched
mlir.register_lowering(_RUN, _lowering(_on_accelerator))
mlir.register_lowering(_RUN, _lowering(_on_processor), platform="cpu")
mlir.register_lowering(_RUN, _on_cuda, platform="cuda")


def _by_tiles(program: _Program, leaves: Sequence[Array]) -> Tree:
    """Run the kernel on some worlds at a time, one tile after the other."""
    worlds, tile = _count(leaves), program.tile
    if worlds <= tile:
        return program.kernel(*program.arguments(leaves))
    tiles = -(-worlds // tile)
    # Whole worlds are repeated, so that what fills the last tile is as sane as the rest.
    effort = program.effort
    order = jnp.arange(worlds)
    if effort is not None:
        order = jnp.argsort(effort(*program.arguments(leaves)))
    order = jnp.pad(order, (0, tiles * tile - worlds), mode="edge")
    back = jnp.zeros(worlds, order.dtype).at[order].set(jnp.arange(tiles * tile))
    # What all worlds share needs not be moved.
    shared = [x.shape[-1] == 1 for x in leaves]
    own = [x for x, is_shared in zip(leaves, shared, strict=True) if not is_shared]

    def advance(packed: dict[str, Array]) -> dict[str, Array]:
        turned = jax.tree.map(jnp.transpose, packed)
        floats = next(x for x in turned.values() if jnp.issubdtype(x.dtype, jnp.floating))
        turned = Store.beside(floats)(turned)
        unpacked = iter(unpack(turned, own, 0))
        parts = [
            x if is_shared else next(unpacked) for x, is_shared in zip(leaves, shared, strict=True)
        ]
        done = program.kernel(*program.arguments(parts))
        return pack(done)

    packed = jax.tree.map(lambda x: _chosen(x, order).reshape(tiles, tile, -1), pack(own))
    done = jax.lax.map(advance, packed)
    done = jax.tree.map(lambda x: _chosen(x.reshape(tiles * tile, -1), back), done)
    like = jax.eval_shape(_worlds_first, program.shapes(leaves))
    return jax.tree.map(lambda x: jnp.moveaxis(x, 0, -1), unpack(done, like, 1))


def _count(leaves: Sequence[Any]) -> int:
    """Count the worlds; arrays with just one stand for all of them."""
    lengths = {x.shape[-1] for x in leaves}
    return 0 if 0 in lengths else max(lengths)


# In primitives of JAX's own: what `x[..., 0]` does takes ten times as long to trace, and each leaf
# of a world comes by here.


def _alone_on_an_axis(x: Any) -> Shaped[Array, "*rest 1"]:
    x = jnp.asarray(x)
    return jax.lax.expand_dims(x, (x.ndim,))


def _without_axis(x: Shaped[Array, "*rest 1"]) -> Shaped[Array, "*rest"]:
    return jax.lax.squeeze(x, (x.ndim - 1,))


def _chosen(values: Shaped[Array, "k ..."], rows: Int[Array, " n"]) -> Shaped[Array, "n ..."]:
    return values.at[rows].get(mode="promise_in_bounds", wrap_negative_indices=False)


def _worlds_first(tree: Tree) -> Tree:
    return jax.tree.map(lambda x: jnp.moveaxis(x, -1, 0), tree)


def worlds_first(batched: Callable[..., Tree]) -> Callable[..., Tree]:
    """Give a function of a whole batch the look of one for one world.

    Args:
        batched: Takes and returns pytrees with the worlds on the first axis of every array.

    Returns:
        The same function without that axis; under `vmap`, nested or not, `batched` runs once.
    """

    @custom_vmap
    def many(*trees: Tree) -> Tree:
        return batched(*trees)

    @many.def_vmap
    def _(size: int, mapped: list[Any], *trees: Tree) -> tuple[Tree, Tree]:
        trees = _with_axis(size, mapped, trees)
        # By numbers: where a size has no room for something, -1 could be any.
        flat = many(*jax.tree.map(lambda x: x.reshape(size * x.shape[1], *x.shape[2:]), trees))
        out = jax.tree.map(lambda x: x.reshape(size, len(x) // size, *x.shape[1:]), flat)
        return out, jax.tree.map(lambda _: True, out)

    @custom_vmap
    def one(*trees: Tree) -> Tree:
        out = many(*jax.tree.map(lambda x: jnp.asarray(x)[None], trees))
        return jax.tree.map(lambda x: x[0], out)

    @one.def_vmap
    def _(size: int, mapped: list[Any], *trees: Tree) -> tuple[Tree, Tree]:
        out = many(*_with_axis(size, mapped, trees))
        return out, jax.tree.map(lambda _: True, out)

    return one


def _with_axis(size: int, mapped: list[Any], trees: tuple[Tree, ...]) -> tuple[Tree, ...]:
    """The arguments with the mapped axis on every array."""

    def widen(has_axis: bool, x: Any) -> Array:
        x = jnp.asarray(x)
        return x if has_axis else jnp.broadcast_to(x, (size, *x.shape))

    return jax.tree.map(widen, tuple(mapped), trees)


def _as_large_as(new: Shaped[Array, "n ..."], old: Shaped[Array, "m ..."]) -> Array:
    """Broadcast the new rows to the shape of the old: a smaller one would be written in part."""
    added = [1] * (old.ndim - new.ndim)
    return jnp.broadcast_to(
        new.reshape(len(new), *added, *new.shape[1:]), (len(new), *old.shape[1:])
    )


def _replaced_in_turn(old: Tree, new: Tree, places: Int[Array, " k"]) -> Tree:
    """Put new worlds where the places say; the first ones count that are inside."""
    worlds = len(jax.tree.leaves(old)[0])

    def replace(k: Int[Array, ""], old: Tree) -> Tree:
        place = row(places, k)[0]
        return jax.tree.map(lambda a, b: put(a, row(b, k).astype(a.dtype), place, 0), old, new)

    return jax.lax.fori_loop(0, jnp.sum(places < worlds), replace, old)


def _replaced_at_once(old: Tree, new: Tree, places: Int[Array, " k"]) -> Tree:
    """The same, each world looking for what replaces it: a handful of kernels for all arrays."""
    worlds = len(jax.tree.leaves(old)[0])
    nothing = jnp.full(worlds, len(places), jnp.int32)
    source = nothing.at[places].set(jnp.arange(len(places), dtype=jnp.int32), mode="drop")
    is_new = source < len(places)
    source = jnp.minimum(source, len(places) - 1)

    def one(a: Array, b: Array) -> Array:
        mask = is_new.reshape(worlds, *[1] * (a.ndim - 1))
        return jnp.where(mask, _chosen(b, source).astype(a.dtype), a)

    return jax.tree.map(one, old, new)


def where_marked(make: Callable[..., Tree]) -> Callable[..., Tree]:
    """Return a function that makes anew what marked worlds have.

    Under `vmap` only the marked worlds are made: their indices are compacted and worked off
    `MARKED_AT_ONCE` at a time. Each comes from its own seeds, the same as if it were alone.

    Args:
        make: From the seeds of one world (any pytree) to what it has.

    Returns:
        A function of what there is, the mark, and the seeds.
    """

    def batched(old: Tree, marked: Bool[Array, " n"], seeds: Tree) -> Tree:
        worlds = marked.shape[0]
        if not worlds:
            return old
        chunk = in_a_round(worlds, MARKED_AT_ONCE)
        (rows,) = jnp.nonzero(marked, size=worlds)
        rows = jnp.pad(rows, (0, chunk))
        count = jnp.sum(marked)

        def unfinished(carry: tuple[Array, Tree]) -> Bool[Array, ""]:
            return carry[0] < count

        def replace_chunk(carry: tuple[Array, Tree]) -> tuple[Array, Tree]:
            first, old = carry
            chosen = jax.lax.dynamic_slice_in_dim(rows, first, chunk)
            new = jax.vmap(make)(jax.tree.map(lambda x: _chosen(x, chosen), seeds))
            new = jax.tree.map(_as_large_as, new, old)
            places = jnp.where(jnp.arange(chunk) < count - first, chosen, worlds)
            replaced = jax.lax.platform_dependent(
                old, new, places, default=_replaced_in_turn, cuda=_replaced_at_once
            )
            return first + chunk, replaced

        return jax.lax.while_loop(unfinished, replace_chunk, (jnp.zeros((), count.dtype), old))[1]

    return worlds_first(batched)
