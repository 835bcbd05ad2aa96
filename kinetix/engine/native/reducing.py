"""Operations that make one entry of several: sums, largest and smallest ones, any and all."""

from collections.abc import Callable, Sequence
from typing import Final

import numpy as np

from kinetix.engine.native.elementwise import literal
from kinetix.engine.native.flat_index import Index, Number
from kinetix.engine.native.indexing import Read
from kinetix.engine.native.ir import Node, Value

UNIFORM_SIZE: Final = 4
"""Most entries of an array that every lane has for itself."""

SERIAL_SIZE: Final = 8
"""Most entries that are reduced by every lane for itself."""

REDUCTIONS: Final[dict[str, Callable[[str, str], str]]] = {
    "reduce_sum": "({}+{})".format,
    "reduce_max": "larger({},{})".format,
    "reduce_min": "smaller({},{})".format,
    "reduce_or": "({}|{})".format,
    "reduce_and": "({}&{})".format,
}
"""By primitive: two entries made one."""


def is_serial(node: Node) -> bool:
    """Return whether every lane reduces all entries for itself."""
    return node.inputs[0].size <= SERIAL_SIZE and node.outputs[0].size <= UNIFORM_SIZE


def is_uniform(node: Node) -> bool:
    """Return whether every lane keeps the result."""
    return node.outputs[0].size == 1 or is_serial(node)


def folded(node: Node, index: Index, read: Read) -> str:
    """Return all entries that go into one result, one after the other."""
    x, axes, total = node.inputs[0], node.parameters["axes"], None
    for inner in np.ndindex(*[x.shape[axis] for axis in axes]):
        entry = read(x, beside(x, axes, index, inner))
        total = entry if total is None else REDUCTIONS[node.name](total, entry)
    return nothing(node) if total is None else total


def beside(value: Value, axes: Sequence[int], index: Index, inner: Sequence[Number]) -> Index:
    """Return the place of one of the entries that go into a result.

    Args:
        value: What is reduced.
        axes: Along which.
        index: Place of the result.
        inner: Place on the axes.
    """
    kept, reduced = iter(index.coordinates), iter(inner)
    at = [next(reduced) if axis in axes else next(kept) for axis in range(len(value.shape))]
    return Index(value.shape, coordinates=at)


def nothing(node: Node) -> str:
    """Return the start value of a reduction."""
    dtype = node.outputs[0].dtype
    if node.name == "reduce_sum":
        return "0"
    if node.name in ("reduce_or", "reduce_and"):
        return "false" if node.name == "reduce_or" else "true"
    is_largest = node.name == "reduce_max"
    if np.issubdtype(dtype, np.floating):
        return "(-INFINITE)" if is_largest else "INFINITE"
    info = np.iinfo(dtype)
    return literal(info.min if is_largest else info.max, dtype)
