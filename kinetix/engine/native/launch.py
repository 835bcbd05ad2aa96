"""The kernel of a batch as a call in a JAX program for a GPU: one block of lanes a world."""

import functools
import os
import warnings
from collections.abc import Callable, Sequence
from typing import Any, Final, NamedTuple

import jax
import jax.numpy as jnp
import numpy as np
from jax.interpreters import mlir
from jaxtyping import Array

from kinetix.engine.native.cuda import PRELUDE, CannotCompile, architecture, compiled
from kinetix.engine.native.elementwise import c_type
from kinetix.engine.native.program import Block, program
from kinetix.engine.native.writer import written

LANES: Final = 32
"""Threads that share a world's work."""

MOST_NEAR: Final = 48 * 1024
"""Bytes of shared memory that a block may have."""

MOST_BLOCKS: Final = 8192
"""Worlds that have far memory of their own; of more, a block takes one after the other."""

SWITCH: Final = "KINETIX_GPU_KERNEL"
"""Environment variable; 0: everything by XLA."""


class Kernel(NamedTuple):
    """A compiled function."""

    code: bytes
    far: int
    """Bytes of memory that each block needs."""


def kernel(
    function: Callable[..., Any], leaves: Sequence[jax.ShapeDtypeStruct], target: str
) -> "Kernel | None":
    """Compile a function of one world.

    Args:
        function: From arrays with a last axis of one world to a list of such.
        leaves: What it takes; what all worlds share has a last axis of one, the rest of more.
        target: Architecture.

    Returns:
        None where there is none, which is told as a warning.
    """
    try:
        far, text = source(function, leaves)
        return Kernel(compiled(text, target), far)
    except KeyError as error:
        reason = f"there is no rule for {error}"
    except CannotCompile as error:
        reason = str(error)
    warnings.warn(
        f"the step runs by XLA, many times slower than as a kernel of its own: {reason}. "
        f"{SWITCH}=0 says that this is meant",
        stacklevel=2,
    )
    return None


def source(
    function: Callable[..., Any], leaves: Sequence[jax.ShapeDtypeStruct]
) -> tuple[int, str]:
    """Write the C++ of a function of one world; see `kernel`.

    Returns:
        Bytes of memory that each block needs, and the text.

    Raises:
        KeyError: There is no rule for an operation or a type, or it needs too much memory.
    """
    worlds = max(x.shape[-1] for x in leaves)
    shared = [x.shape[-1] < worlds for x in leaves]
    one = program(function, [jax.ShapeDtypeStruct((*x.shape[:-1], 1), x.dtype) for x in leaves])
    text = written(one)
    if text.near > MOST_NEAR:
        raise KeyError(f"a scene that takes {text.near} bytes a world")
    return text.far, "\n".join(
        [
            f"#define LANE_COUNT {LANES}",
            PRELUDE,
            text.constants,
            f'extern "C" __global__ void __launch_bounds__({LANES}) step({_parameters(one)}) {{',
            f"__shared__ __align__(16) unsigned char near[{max(text.near, 16)}];",
            f"unsigned char* const far = memory + size_t(blockIdx.x) * {text.far};",
            "const int lane = threadIdx.x;",
            "for (size_t world = blockIdx.x; world < *worlds; world += gridDim.x) {",
            *_own_parts(one, shared),
            text.body,
            "SYNC",
            "}",
            "}",
        ]
    )


def _parameters(one: Block) -> str:
    given = [f"const {c_type(x.dtype)}* __restrict__ a{k}" for k, x in enumerate(one.inputs)]
    made = [f"{c_type(x.dtype)}* __restrict__ b{k}" for k, x in enumerate(one.outputs)]
    return ", ".join([*given, "const int* __restrict__ worlds", *made, "unsigned char* memory"])


def _own_parts(one: Block, shared: Sequence[bool]) -> list[str]:
    """Where a world's own entries begin."""
    lines = []
    for k, (x, is_shared) in enumerate(zip(one.inputs, shared, strict=True)):
        place = "" if is_shared else f" + world * {x.size}"
        lines.append(f"const {c_type(x.dtype)}* __restrict__ const in{k} = a{k}{place};")
    lines.extend(
        f"{c_type(x.dtype)}* __restrict__ const out{k} = b{k} + world * {x.size};"
        for k, x in enumerate(one.outputs)
    )
    return lines


def lowering(fallback: Callable[..., Any]) -> Callable[..., Any]:
    """The rule by which a batch is lowered for a GPU.

    Args:
        fallback: The rule by XLA.
    """

    def rule(context: Any, *operands: Any, program: Any) -> Any:
        target = None if os.environ.get(SWITCH) == "0" else architecture()
        given = context.avals_in
        if target is None or not all(x.shape[-1] for x in given):
            return fallback(context, *operands, program=program)
        kinds = tuple(
            jax.ShapeDtypeStruct((*x.shape[:-1], min(x.shape[-1], 2)), x.dtype) for x in given
        )
        kernel = _kernel(program, kinds, target)
        if kernel is None:
            return fallback(context, *operands, program=program)
        call = functools.partial(called, kernel=kernel, results=context.avals_out)
        return mlir.lower_fun(call, multiple_results=True)(context, *operands)

    return rule


@functools.lru_cache(maxsize=64)
def _kernel(
    program: Any, leaves: tuple[jax.ShapeDtypeStruct, ...], target: str
) -> Kernel | None:
    return kernel(program.whole, leaves, target)


def called(*leaves: Array, kernel: Kernel, results: Sequence[Any]) -> list[Array]:
    """Call a kernel.

    Args:
        leaves: What it takes, worlds on the last axis.
        kernel: Which.
        results: Shapes and types of what it returns.
    """
    worlds = max(x.shape[-1] for x in leaves)
    blocks = min(worlds, MOST_BLOCKS)
    memory = jax.ShapeDtypeStruct((max(blocks * kernel.far, 1),), np.uint8)
    made = [jax.ShapeDtypeStruct(x.shape, x.dtype) for x in results]
    call = jax.ffi.ffi_call(
        "__gpu$xla.gpu.ptx",
        [*made, memory],
        input_layouts=[*[_world_by_world(x) for x in leaves], (0,)],
        output_layouts=[*[_world_by_world(x) for x in made], (0,)],
    )
    grid = {"grid_x": blocks, "grid_y": 1, "grid_z": 1}
    block = {"block_x": LANES, "block_y": 1, "block_z": 1, "shared_mem_bytes": 0}
    numbers = {name: np.int32(number) for name, number in {**grid, **block}.items()}
    text = kernel.code.decode()
    count = jnp.full(1, worlds, jnp.int32)
    return call(*leaves, count, name="step", kernel_type="ptx", kernel_data=text, **numbers)[:-1]


def _world_by_world(array: Any) -> tuple[int, ...]:
    """The order of axes in which what belongs to a world lies together."""
    return (array.ndim - 1, *range(array.ndim - 1))
