"""Operations that are replaced by others: a table of replacements."""

from collections.abc import Callable, Sequence
from typing import Any, Final, Protocol

import numpy as np

from kinetix.engine.native.ir import Node, Value


class Reader(Protocol):
    """Receiver of operations."""

    def add(self, name: str, inputs: list[Value], results: list[Value], **parameters: Any) -> Node:
        """Add an operation."""
        ...


Rule = Callable[[Reader, list[Value], list[Value], dict[str, Any]], None]


def _split(
    reader: Reader, inputs: list[Value], results: list[Value], parameters: dict[str, Any]
) -> None:
    axis, first = parameters["axis"], 0
    for result in results:
        start = [0] * len(result.shape)
        start[axis] = first
        first += result.shape[axis]
        reader.add("slice", inputs, [result], start_indices=start, strides=None)


def _unstack(
    reader: Reader, inputs: list[Value], results: list[Value], parameters: dict[str, Any]
) -> None:
    (table,), axis = inputs, parameters["axis"]
    shape = (*table.shape[:axis], 1, *table.shape[axis + 1 :])
    for place, result in enumerate(results):
        start = [0] * len(table.shape)
        start[axis] = place
        part = Value(shape, table.dtype)
        reader.add("slice", inputs, [part], start_indices=start, strides=None)
        reader.add("reshape", [part], [result])


def _stack(
    reader: Reader, inputs: list[Value], results: list[Value], parameters: dict[str, Any]
) -> None:
    axis, parts = parameters["axis"], []
    for x in inputs:
        part = Value((*x.shape[:axis], 1, *x.shape[axis:]), x.dtype)
        reader.add("reshape", [x], [part])
        parts.append(part)
    reader.add("concatenate", parts, results, dimension=axis)


def _best(reduction: str, is_worse: str) -> Rule:
    """Return the place of the first of the largest, or smallest."""

    def rule(
        reader: Reader, inputs: list[Value], results: list[Value], parameters: dict[str, Any]
    ) -> None:
        (x,), (result,), axes = inputs, results, parameters["axes"]
        best = Value(result.shape, x.dtype)
        reader.add(reduction, [x], [best], axes=axes)
        kept = [axis for axis in range(len(x.shape)) if axis not in axes]
        everywhere = _broadcast(reader, best, x.shape, kept)
        worse, place, found = (
            Value(x.shape, dtype) for dtype in (np.dtype(bool), result.dtype, result.dtype)
        )
        last = Value((), result.dtype, constant=np.asarray(x.shape[axes[0]] - 1, result.dtype))
        reader.add(is_worse, [x, everywhere], [worse])
        reader.add("iota", [], [place], dimension=axes[0])
        reader.add("select_n", [worse, place, last], [found])
        reader.add("reduce_min", [found], [result], axes=axes)

    return rule


def _cumsum(
    reader: Reader, inputs: list[Value], results: list[Value], parameters: dict[str, Any]
) -> None:
    (x,), (result,), axis = inputs, results, parameters["axis"]
    shape = (*x.shape, x.shape[axis])
    number = np.dtype(np.int32)
    entry, source, target = Value(shape, x.dtype), Value(shape, number), Value(shape, number)
    kept = [len(x.shape) if a == axis else a for a in range(len(x.shape))]
    reader.add("broadcast_in_dim", [x], [entry], broadcast_dimensions=kept)
    reader.add("iota", [], [source], dimension=len(x.shape))
    reader.add("iota", [], [target], dimension=axis)
    counts, counted = Value(shape, np.dtype(bool)), Value(shape, x.dtype)
    zero = Value((), x.dtype, constant=np.zeros((), x.dtype))
    order = [target, source] if parameters["reverse"] else [source, target]
    reader.add("le", order, [counts])
    reader.add("select_n", [counts, zero, entry], [counted])
    reader.add("reduce_sum", [counted], [result], axes=(len(x.shape),))


def _dot(
    reader: Reader, inputs: list[Value], results: list[Value], parameters: dict[str, Any]
) -> None:
    """Products first, then their sums along the last axes."""
    (a, b), (result,) = inputs, results
    (of_a, of_b), (batch_a, batch_b) = parameters["dimension_numbers"]
    free = [
        [axis for axis in range(len(x.shape)) if axis not in (*contracted, *batch)]
        for x, contracted, batch in ((a, of_a, batch_a), (b, of_b, batch_b))
    ]
    shape = (*result.shape, *[a.shape[axis] for axis in of_a])
    first, last = len(batch_a), len(result.shape)
    wide = []
    for x, contracted, batch, own, begin in (
        (a, of_a, batch_a, free[0], first),
        (b, of_b, batch_b, free[1], first + len(free[0])),
    ):
        places = [0] * len(x.shape)
        for number, axis in enumerate(batch):
            places[axis] = number
        for number, axis in enumerate(own):
            places[axis] = begin + number
        for number, axis in enumerate(contracted):
            places[axis] = last + number
        wide.append(_broadcast(reader, x, shape, places))
    product = Value(shape, result.dtype)
    reader.add("mul", wide, [product])
    reader.add("reduce_sum", [product], [result], axes=tuple(range(last, len(shape))))


def _broadcast(reader: Reader, x: Value, shape: Sequence[int], axes: Sequence[int]) -> Value:
    wide = Value(tuple(shape), x.dtype)
    reader.add("broadcast_in_dim", [x], [wide], broadcast_dimensions=list(axes))
    return wide


REWRITTEN: Final[dict[str, Rule]] = {
    "split": _split,
    "stack": _stack,
    "unstack": _unstack,
    "argmax": _best("reduce_max", "lt"),
    "argmin": _best("reduce_min", "gt"),
    "cumsum": _cumsum,
    "dot_general": _dot,
}
"""By primitive."""
