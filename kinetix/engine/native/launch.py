"""The kernel of a batch as a call in a JAX program for a GPU."""

import dataclasses
import functools
import os
import warnings
from collections.abc import Sequence
from typing import Any, Final

import jax
import jax.numpy as jnp
import numpy as np
from jax.interpreters import mlir
from jaxtyping import Array

from kinetix.engine.gc_pause import uncollected
from kinetix.engine.native.cuda import CannotCompile, architecture, compiled
from kinetix.engine.native.ir import CannotTranslate
from kinetix.engine.native.kernel import FEW_WORLDS, THREADS, kernel_text
from kinetix.engine.promotion import usual_promotion

MOST_BLOCKS: Final = 8192
"""Blocks of a call; of more worlds, a block takes one after the other."""

SWITCH: Final = "KINETIX_GPU_KERNEL"
"""Environment variable; 0: everything by XLA."""


@dataclasses.dataclass(frozen=True)
class Kernel:
    """A compiled function of one world."""

    code: str
    """Assembly (PTX)."""
    lanes: int
    far: int
    """See `KernelText`."""


def lowered(context: Any, operands: Sequence[Any], program: Any) -> Sequence[Any] | None:
    """Lower a batch as a call of its kernel.

    Args:
        context: Of the lowering.
        operands: Of the batch.
        program: Of the batch (`engine/batch/`); equal ones share a kernel.

    Returns:
        The results; None: there is no kernel, and XLA has to do it.
    """
    target = None if os.environ.get(SWITCH) == "0" else architecture()
    given = context.avals_in
    if target is None or not all(x.shape[-1] for x in given):
        return None
    kinds = tuple(
        jax.ShapeDtypeStruct((*x.shape[:-1], min(x.shape[-1], 2)), x.dtype) for x in given
    )
    many = max(x.shape[-1] for x in given) > FEW_WORLDS
    kernel = _kernel(program, kinds, many, target)
    if kernel is None:
        return None
    call = functools.partial(called, kernel=kernel, results=context.avals_out)
    return mlir.lower_fun(call, multiple_results=True)(context, *operands)


@functools.lru_cache(maxsize=64)
def _kernel(
    program: Any,
    leaves: tuple[jax.ShapeDtypeStruct, ...],
    many: bool,
    target: str,
) -> Kernel | None:
    """Return the kernel of a program; None if it cannot be made, with a warning."""
    try:
        with usual_promotion(), uncollected():
            made = kernel_text(program.whole, leaves, many=many)
        return Kernel(compiled(made.text, target), made.lanes, made.far)
    except (CannotTranslate, CannotCompile) as error:
        warnings.warn(
            f"steps run by XLA, many times slower than by a kernel of their own: {error}. "
            f"{SWITCH}=0 says that this is meant",
            stacklevel=2,
        )
        return None


def called(*leaves: Array, kernel: Kernel, results: Sequence[Any]) -> list[Array]:
    """Call a kernel.

    Args:
        leaves: What it takes, worlds on the last axis.
        kernel: Which.
        results: Shapes and types of what it returns.
    """
    worlds = max(x.shape[-1] for x in leaves)
    at_once = THREADS // kernel.lanes
    blocks = min(-(-worlds // at_once), MOST_BLOCKS)
    memory = jax.ShapeDtypeStruct((max(blocks * at_once * kernel.far, 1),), np.uint8)
    made = [jax.ShapeDtypeStruct(x.shape, x.dtype) for x in results]
    call = jax.ffi.ffi_call(
        "__gpu$xla.gpu.ptx",
        [*made, memory],
        input_layouts=[*[_world_by_world(x) for x in leaves], (0,)],
        output_layouts=[*[_world_by_world(x) for x in made], (0,)],
    )
    grid = {"grid_x": blocks, "grid_y": 1, "grid_z": 1}
    block = {"block_x": THREADS, "block_y": 1, "block_z": 1, "shared_mem_bytes": 0}
    numbers = {name: np.int32(number) for name, number in {**grid, **block}.items()}
    count = jnp.full(1, worlds, jnp.int32)
    done = call(*leaves, count, name="step", kernel_type="ptx", kernel_data=kernel.code, **numbers)
    return list(done[:-1])


def _world_by_world(array: Any) -> tuple[int, ...]:
    """Return the order of axes in which what belongs to a world lies together."""
    return (array.ndim - 1, *range(array.ndim - 1))
