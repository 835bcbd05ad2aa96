"""Operations that only read other arrays elsewhere: a row of the table has the index and cost.

`read(value, index)` gives the C of an entry. FREE ones are never stored: a transposed table is the
table, read at other places.
"""

from collections.abc import Callable, Sequence
from typing import Final

import jax
import numpy as np

from kinetix.engine.native.elementwise import literal
from kinetix.engine.native.flat_index import Index, Number, plus, times
from kinetix.engine.native.ir import CannotTranslate, Node, Value

Read = Callable[[Value, Index], str]
Rule = Callable[[Node, Index, Read], str]


def _broadcast(node: Node, index: Index, read: Read) -> str:
    x, axes = node.inputs[0], node.parameters["broadcast_dimensions"]
    if x.size == node.outputs[0].size:
        return read(x, index.reshaped(x.shape))
    at = [
        0 if size == 1 else index.coordinates[axis]
        for axis, size in zip(axes, x.shape, strict=True)
    ]
    return read(x, Index(x.shape, coordinates=at))


def _reshaped(node: Node, index: Index, read: Read) -> str:
    x = node.inputs[0]
    return read(x, index.reshaped(x.shape))


def _transposed(node: Node, index: Index, read: Read) -> str:
    x = node.inputs[0]
    at: list[Number] = [0] * len(x.shape)
    for axis, source in enumerate(node.parameters["permutation"]):
        at[source] = index.coordinates[axis]
    return read(x, Index(x.shape, coordinates=at))


def _reversed(node: Node, index: Index, read: Read) -> str:
    x = node.inputs[0]
    at = [
        plus(x.shape[axis] - 1, f"-{here}" if isinstance(here, str) else -here)
        if axis in node.parameters["dimensions"]
        else here
        for axis, here in enumerate(index.coordinates)
    ]
    return read(x, Index(x.shape, coordinates=at))


def _sliced(node: Node, index: Index, read: Read) -> str:
    x, starts = node.inputs[0], node.parameters["start_indices"]
    strides = node.parameters["strides"] or [1] * len(x.shape)
    at = [
        plus(times(here, stride), start)
        for here, start, stride in zip(index.coordinates, starts, strides, strict=True)
    ]
    return read(x, Index(x.shape, coordinates=at))


def starts_of(
    starts: Sequence[Value], shape: Sequence[int], window: Sequence[int], read: Read
) -> list[Number]:
    """Return the start of a window known at run time only: it is kept inside the array."""
    found: list[Number] = []
    for start, size, extent in zip(starts, shape, window, strict=True):
        if size == extent:
            found.append(0)
        elif start.constant is not None:
            found.append(min(max(int(start.constant), 0), size - extent))
        else:
            found.append(f"clipped({read(start, Index.first(start.shape))},{size - extent})")
    return found


def _dynamic_slice(node: Node, index: Index, read: Read) -> str:
    x, *starts = node.inputs
    found = starts_of(starts, x.shape, index.shape, read)
    at = [plus(start, here) for start, here in zip(found, index.coordinates, strict=True)]
    return read(x, Index(x.shape, coordinates=at))


def _row(node: Node, index: Index, read: Read) -> str:
    table, turn = node.inputs
    at = [read(turn, Index.first(())), *index.coordinates]
    return read(table, Index(table.shape, coordinates=at))


def _iota(node: Node, index: Index, read: Read) -> str:
    del read
    here = index.coordinates[node.parameters["dimension"]]
    return str(here) if np.issubdtype(node.outputs[0].dtype, np.integer) else f"float({here})"


def window_place(
    index: Index,
    axes: int,
    window_axes: Sequence[int],
    single_axes: Sequence[int],
    batch_axes: Sequence[int],
    batch_sources: Sequence[int],
) -> tuple[list[Number], list[Number]]:
    """Find where in a table an entry of a gather, or of a scatter's changes, lies in its window.

    Args:
        index: Of the entry.
        axes: Of the table.
        window_axes: Those of the entry's array that go through a window.
        single_axes: Those of the table on which a window has one entry.
        batch_axes: Those of the table that are axes of the indices too.
        batch_sources: Which these are there.

    Returns:
        The coordinates in the table, the window's start left out; and those in the indices.
    """
    batch = [x for axis, x in enumerate(index.coordinates) if axis not in window_axes]
    window = iter([index.coordinates[axis] for axis in window_axes])
    at: list[Number] = [0] * axes
    for axis in range(axes):
        if axis not in single_axes and axis not in batch_axes:
            at[axis] = next(window)
    for axis, source in zip(batch_axes, batch_sources, strict=True):
        at[axis] = batch[source]
    return at, batch


def _gathered(node: Node, index: Index, read: Read) -> str:
    table, indices = node.inputs
    numbers, sizes = node.parameters["dimension_numbers"], node.parameters["slice_sizes"]
    at, batch = window_place(
        index,
        len(table.shape),
        numbers.offset_dims,
        numbers.collapsed_slice_dims,
        numbers.operand_batching_dims,
        numbers.start_indices_batching_dims,
    )
    mode = jax.lax.GatherScatterMode.from_any(node.parameters["mode"])
    inside = []
    for place, axis in enumerate(numbers.start_index_map):
        start = read(indices, Index(indices.shape, coordinates=[*batch, place]))
        most = table.shape[axis] - sizes[axis]
        if mode is jax.lax.GatherScatterMode.FILL_OR_DROP:
            inside.append(f"{start}>=0&&{start}<={most}")
        at[axis] = plus(at[axis], f"clipped({start},{most})" if most else 0)
    found = read(table, Index(table.shape, coordinates=at))
    if not inside:
        return found
    return f"({'&&'.join(inside)}?{found}:{_fill(node)})"


def _fill(node: Node) -> str:
    """Return the value of an entry outside the table."""
    value, dtype = node.parameters["fill_value"], node.outputs[0].dtype
    if value is None and np.issubdtype(dtype, np.floating):
        value = np.nan
    elif value is None:
        value = np.iinfo(dtype).min if np.issubdtype(dtype, np.signedinteger) else True
    return literal(np.asarray(value, dtype)[()], dtype)


def _padded(node: Node, index: Index, read: Read) -> str:
    x, filling = node.inputs
    inside: list[str] = []
    at: list[Number] = []
    for here, size, (low, _, inner) in zip(
        index.coordinates, x.shape, node.parameters["padding_config"], strict=True
    ):
        if inner:
            raise CannotTranslate("nothing can be padded between entries in kernels")
        place = plus(here, -low)
        if isinstance(place, int) and not 0 <= place < size:
            return read(filling, Index.first(()))
        if isinstance(place, str):
            inside.append(f"unsigned({place})<{size}u")
        at.append(place)
    found = read(x, Index(x.shape, coordinates=at))
    if not inside:
        return found
    return f"({'&&'.join(inside)}?{found}:{read(filling, Index.first(()))})"


def _joined(node: Node, index: Index, read: Read) -> str:
    axis = node.parameters["dimension"]
    here, first = index.coordinates[axis], 0
    parts = []
    for x in node.inputs:
        size = x.shape[axis]
        if isinstance(here, int) and not first <= here < first + size:
            first += size
            continue
        at = list(index.coordinates)
        at[axis] = plus(here, -first)
        first += size
        if size:
            parts.append((first, read(x, Index(x.shape, coordinates=at))))
    *others, (_, chain) = parts
    for limit, expression in reversed(others):
        chain = f"({here}<{limit}?{expression}:{chain})"
    return chain


FREE: Final[dict[str, Rule]] = {
    "broadcast_in_dim": _broadcast,
    "reshape": _reshaped,
    "squeeze": _reshaped,
    "expand_dims": _reshaped,
    "transpose": _transposed,
    "rev": _reversed,
    "slice": _sliced,
    "dynamic_slice": _dynamic_slice,
    "row": _row,
    "iota": _iota,
}
"""By primitive: what is read in place of an entry."""

LOOKED_UP: Final[dict[str, Rule]] = {
    "gather": _gathered,
    "pad": _padded,
    "concatenate": _joined,
}
"""The same, where it is worth to do it once only."""
