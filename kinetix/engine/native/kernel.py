"""The text of a kernel: a function of one world, run by some lanes of a block for each world."""

import dataclasses
from collections.abc import Callable, Sequence
from typing import Any, Final

import jax

from kinetix.engine.native.cuda import PRELUDE
from kinetix.engine.native.elementwise import c_type
from kinetix.engine.native.from_jaxpr import program
from kinetix.engine.native.ir import Block, CannotTranslate
from kinetix.engine.native.writer import BodyText, written

THREADS: Final = 32
"""Of a block: those that run in step."""

FEWEST_LANES: Final = 8
"""Threads that share a world's work, at least: what each of them does for itself is done for more
worlds at once the fewer there are."""

FEW_WORLDS: Final = 2048
"""Of so many, all run at once, and what counts is that each is done soon: all lanes for one."""

GOOD_NEAR: Final = 28 * 1024
"""Bytes of near memory of a block, so that eight run at once on a multiprocessor."""

MOST_NEAR: Final = 48 * 1024
"""Bytes of near memory that a block may have."""

NEAR_ARRAYS: Final = (1024, 512, 256, 128, 64, 0)
"""Bytes of the largest array that lies in near memory: the first at which a world fits."""


@dataclasses.dataclass(frozen=True)
class KernelText:
    """Source of a kernel, and its needs."""

    text: str
    """C++, with the function `step`."""
    lanes: int
    """Lanes per world."""
    far: int
    """Bytes of memory that each world needs while it is worked on."""


def kernel_text(
    function: Callable[..., Any], leaves: Sequence[jax.ShapeDtypeStruct], *, many: bool
) -> KernelText:
    """Write the kernel for a function of one world.

    Args:
        function: From arrays with a last axis of one world to a list of such.
        leaves: What it takes; what all worlds share has a last axis of one, the rest of more.
        many: Whether there will be more than FEW_WORLDS.

    Raises:
        CannotTranslate: There is no rule for an operation or a type.
    """
    most = max(x.shape[-1] for x in leaves)
    shared = [x.shape[-1] < most for x in leaves]
    one = program(function, [jax.ShapeDtypeStruct((*x.shape[:-1], 1), x.dtype) for x in leaves])
    text = written(one)
    first, *smaller = NEAR_ARRAYS
    body = text.laid_out(first)
    for largest in smaller:
        if body.near <= GOOD_NEAR:
            break
        body = text.laid_out(largest)
    if body.near > MOST_NEAR:
        raise CannotTranslate(f"a scene of {body.near} bytes is too large for kernels")
    lanes = _lanes(body) if many else THREADS
    return KernelText(_kernel(one, body, shared, lanes), lanes, body.far)


def _lanes(body: BodyText) -> int:
    """Count the lanes of each of many worlds: as few as their memory allows."""
    lanes = THREADS
    while lanes > FEWEST_LANES and THREADS // (lanes // 2) * body.near <= GOOD_NEAR + 512:
        lanes //= 2
    return lanes


def _kernel(one: Block, body: BodyText, shared: Sequence[bool], lanes: int) -> str:
    worlds = THREADS // lanes
    near = -(-max(body.near, 1) // 128) * 128 + 4 * lanes  # each world begins at other banks
    return "\n".join(
        [
            f"#define LANE_COUNT {lanes}",
            PRELUDE,
            body.constants,
            f'extern "C" __global__ void __launch_bounds__({THREADS}) step({_parameters(one)}) {{',
            f"__shared__ __align__(16) unsigned char shared[{worlds * near}];",
            f"const int lane = threadIdx.x % {lanes}, place = threadIdx.x / {lanes};",
            f"const unsigned lanes = {hex((1 << lanes) - 1)}u << place * {lanes};",
            f"unsigned char* const near = shared + place * {near};",
            f"const size_t first = size_t(blockIdx.x) * {worlds} + place;",
            f"unsigned char* const far = memory + first * {body.far};",
            f"const size_t stride = size_t(gridDim.x) * {worlds};",
            "for (size_t world = first; world < *worlds; world += stride) {",
            *_own_parts(one, shared),
            body.body,
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
    """Return the index of the first entry of a world."""
    lines = []
    for k, (x, is_shared) in enumerate(zip(one.inputs, shared, strict=True)):
        place = "" if is_shared else f" + world * {x.size}"
        lines.append(f"const {c_type(x.dtype)}* __restrict__ const in{k} = a{k}{place};")
    lines.extend(
        f"{c_type(x.dtype)}* __restrict__ const out{k} = b{k} + world * {x.size};"
        for k, x in enumerate(one.outputs)
    )
    return lines
