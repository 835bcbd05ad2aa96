"""A function of many worlds, as the primitive carries it through a program."""

import dataclasses
import functools
from collections.abc import Callable, Sequence
from typing import Any

import jax
import jax.numpy as jnp
from jaxtyping import Array, Int

from kinetix.engine.backend import whole_batches

Tree = Any


@dataclasses.dataclass(frozen=True, kw_only=True)
class BatchProgram:
    """Program of the primitive; equal ones are compiled once."""

    kernel: Callable[..., Tree]
    effort: Callable[..., Int[Array, " n"]] | None
    like: Callable[..., Tree] | None
    tile: int
    structure: Any
    """Tree structure of the arguments."""
    words: str | None = None
    """All about the kernel, the same in every process; None where there are no such words."""

    def arguments(self, leaves: Sequence[Any]) -> tuple[Tree, ...]:
        """Return the kernel's arguments, with what worlds share repeated for each."""
        worlds = count(leaves)
        wide = [jnp.broadcast_to(x, (*x.shape[:-1], worlds)) for x in leaves]
        return jax.tree.unflatten(self.structure, wide)

    def whole(self, *leaves: Array) -> list[Array]:
        """Return the results of all worlds at once, as an accelerator computes them."""
        with whole_batches():
            done = self.kernel(*self.arguments(leaves))
        return self.typed(done, leaves)

    def typed(self, done: Tree, leaves: Sequence[Any]) -> list[Array]:
        """Return the kernel's results as a list of arrays, converted to the types of `results`."""
        shapes = self.results(leaves)
        return [x.astype(as_.dtype) for x, as_ in zip(jax.tree.leaves(done), shapes, strict=True)]

    def shapes(self, leaves: Sequence[Any]) -> Tree:
        """A tree like the kernel's result; only the shapes and types of its arrays are meant."""
        # Asked for one world, so that it is traced once, however many there are.
        one = [shaped((*x.shape[:-1], 1), x) for x in leaves]
        worlds = count(leaves)
        return jax.tree.map(
            lambda x: jax.ShapeDtypeStruct((*x.shape[:-1], worlds), x.dtype),
            jax.eval_shape(_alike(self), *one),
        )

    def results(self, leaves: Sequence[Any]) -> list[jax.ShapeDtypeStruct]:
        """Return the same as a list."""
        return jax.tree.leaves(self.shapes(leaves))


@functools.lru_cache(maxsize=64)
def _alike(program: BatchProgram) -> Callable[..., Tree]:
    """Return a function that has the result's shapes; JAX traces it once, as it is jitted."""
    run = program.like or program.kernel
    return jax.jit(lambda *leaves: run(*program.arguments(leaves)))


def shaped(shape: tuple[int, ...], like: Any) -> jax.ShapeDtypeStruct:
    """Return an array's description with another shape; a Python number stays one."""
    weak = bool(getattr(like, "weak_type", False))
    return jax.ShapeDtypeStruct(shape, like.dtype, weak_type=weak)


def count(leaves: Sequence[Any]) -> int:
    """Count the worlds; arrays with just one stand for all of them."""
    lengths = {x.shape[-1] for x in leaves}
    return 0 if 0 in lengths else max(lengths)
