"""A kernel of many worlds under `vmap`: a primitive of our own, which runs it worlds last."""

import functools
import math
from collections.abc import Callable, Sequence
from typing import Any, Final

import jax
import jax.numpy as jnp
from jax.core import ShapedArray
from jax.extend.core import Primitive
from jax.interpreters import ad, batching, mlir
from jaxtyping import Array, Int, Shaped

from kinetix.engine.backend import takes_whole_batches
from kinetix.engine.batch.described import NotOurs, described
from kinetix.engine.batch.lowered import from_disk
from kinetix.engine.batch.program import BatchProgram, count
from kinetix.engine.batch.tiles import TILE, by_tiles
from kinetix.engine.gc_pause import uncollected
from kinetix.engine.loops import in_parts
from kinetix.engine.promotion import usual_promotion
from kinetix.errors import KinetixError

Tree = Any


def worlds_last(
    kernel: Callable[..., Tree],
    effort: Callable[..., Int[Array, " n"]] | None = None,
    like: Callable[..., Tree] | None = None,
    tile: int = TILE,
    made_of: tuple[Any, ...] | None = None,
) -> Callable[..., Tree]:
    """Wrap a kernel for arrays whose last axis is worlds as one for a single world.

    Args:
        kernel: Takes pytrees whose arrays end in the axis `n`, some of them of floats; returns
            the same kind.
        effort: How much work each world will be, from the same arguments, if that differs. A tile
            takes as long as its hardest world: those of like effort are advanced together.
        like: Which of its arguments the kernel's result looks like, array for array, if any: then
            the kernel need not be traced to know what comes out.
        tile: Worlds that are advanced together.
        made_of: Name and parameters that identify the kernel; equal ones share a cached program.
            Where they are values of our own, it is lowered once on a computer, not once in each
            process.

    Returns:
        A function of the same pytrees without that axis.
    """
    words = _words((made_of, tile)) if made_of is not None else None

    def one(*arguments: Tree) -> Tree:
        wide = jax.tree.map(_alone_on_an_axis, arguments)
        leaves, structure = jax.tree.flatten(wide)
        program = BatchProgram(
            kernel=kernel,
            effort=effort,
            like=like,
            tile=tile,
            structure=structure,
            words=words,
        )
        results = _RUN.bind(*leaves, program=program)
        shapes = program.shapes(leaves)
        return jax.tree.unflatten(jax.tree.structure(shapes), [_without_axis(x) for x in results])

    return one


def _words(values: tuple[Any, ...]) -> str | None:
    try:
        return described(values)
    except NotOurs:
        return None


_RUN: Final = Primitive("worlds")
_RUN.multiple_results = True


@_RUN.def_impl
def _run(*leaves: Array, program: BatchProgram) -> list[Array]:
    with jax.disable_jit(False):  # what runs is compiled, or it would end up here again
        return _alone(program)(*leaves)


@functools.lru_cache(maxsize=64)
def _alone(program: BatchProgram) -> Callable[..., list[Array]]:
    """Return the primitive by itself, so that it is lowered for the device that runs it."""
    return jax.jit(functools.partial(_RUN.bind, program=program))


def _on_processor(*leaves: Array, program: BatchProgram) -> list[Array]:
    with usual_promotion():
        return _compiled(program, takes_whole_batches())(*leaves)


def _from_disk(*leaves: Array, program: BatchProgram) -> list[Array]:
    whole = takes_whole_batches()
    run = _compiled(program, whole)
    with usual_promotion():
        kept = from_disk(f"{program.words} {program.structure} {whole}", run, leaves)
        return kept or run(*leaves)


def _on_accelerator(*leaves: Array, program: BatchProgram) -> list[Array]:
    with usual_promotion():
        return _compiled(program, True)(*leaves)


@functools.lru_cache(maxsize=64)
def _compiled(program: BatchProgram, whole: bool) -> Callable[..., list[Array]]:
    """Traced once for all its uses in a program.

    Environments make new kernels whenever they are traced: what is long unused must be let go.
    """

    @jax.jit
    def worlds(*leaves: Array) -> list[Array]:
        if not count(leaves):
            return [jnp.zeros(x.shape, x.dtype) for x in program.results(leaves)]
        if whole:
            return program.whole(*leaves)
        return program.typed(in_parts(by_tiles(program, leaves)), leaves)

    return worlds


@_RUN.def_abstract_eval
def _shapes(*leaves: Any, program: BatchProgram) -> list[Any]:
    return [ShapedArray(x.shape, x.dtype) for x in program.results(leaves)]


def _batched(
    leaves: Sequence[Array], axes: Sequence[int | None], *, program: BatchProgram
) -> tuple[list[Array], list[int]]:
    """Another axis of worlds is merged into the last one."""
    size = next(x.shape[axis] for x, axis in zip(leaves, axes, strict=True) if axis is not None)
    moved = [
        x if axis is None else jnp.moveaxis(x, axis, -2)
        for x, axis in zip(leaves, axes, strict=True)
    ]
    sizes = size, count(moved)
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
    """Return the rule by which a program is lowered."""
    rule = mlir.lower_fun(run, multiple_results=True)

    def lowered(*arguments: Any, **parameters: Any) -> Any:
        with uncollected():
            return rule(*arguments, **parameters)

    return lowered


def _on_cpu(context: Any, *arguments: Any, program: BatchProgram) -> Any:
    """Return the rule for processors: as it lies on disk, where the program is for them alone."""
    alone = context.module_context.platforms == ("cpu",)
    run = _from_disk if alone and program.words else _on_processor
    return _lowering(run)(context, *arguments, program=program)


def _on_cuda(context: Any, *arguments: Any, program: BatchProgram) -> Any:
    """Return the rule for CUDA: a kernel of its own, else what any accelerator gets."""
    from kinetix.engine.native.launch import lowered  # here, as a processor never needs it

    done = lowered(context, arguments, program)
    if done is None:
        return _lowering(_on_accelerator)(context, *arguments, program=program)
    return done


def _no_derivative(*_: Any, program: BatchProgram) -> Any:
    del program
    raise KinetixError(
        "the engine has no derivative: its sweeps end once they have converged, and contacts come "
        "and go; jax.lax.stop_gradient around what goes into a step makes it count as a constant"
    )


ad.primitive_jvps[_RUN] = _no_derivative
batching.primitive_batchers[_RUN] = _batched
mlir.register_lowering(_RUN, _lowering(_on_accelerator))
mlir.register_lowering(_RUN, _on_cpu, platform="cpu")
mlir.register_lowering(_RUN, _on_cuda, platform="cuda")


# In primitives of JAX's own: what `x[..., 0]` does takes ten times as long to trace, and each leaf
# of a world comes by here.


def _alone_on_an_axis(x: Any) -> Shaped[Array, "*rest 1"]:
    x = jnp.asarray(x)
    return jax.lax.expand_dims(x, (x.ndim,))


def _without_axis(x: Shaped[Array, "*rest 1"]) -> Shaped[Array, "*rest"]:
    return jax.lax.squeeze(x, (x.ndim - 1,))
