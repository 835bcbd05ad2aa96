"""Places in arrays, as C: a flat index and its coordinates, each found from the other on demand.

Where coordinates of one array are put together again for another in the same order, the flat index
comes back: `i / 3 % 4 * 3 + i % 3` is `i`.
"""

import math
from collections.abc import Sequence
from typing import Self

Number = int | str
"""A number that is known, or an expression."""


class Coordinate(str):
    """A coordinate that was taken out of a flat index: `flat / stride % size`."""

    flat: str
    extent: int
    """Number of values of the flat index."""
    stride: int
    size: int

    @classmethod
    def of(cls, flat: str, extent: int, stride: int, size: int) -> "Number":
        """Return the coordinate, or the flat index itself."""
        if size == 1:
            return 0
        if stride == 1 and size == extent:
            return flat
        text = flat if stride == 1 else f"unsigned({flat})/{stride}u"
        if stride * size < extent:
            text = f"unsigned({text})%{size}u" if stride == 1 else f"({text})%{size}u"
        part = cls(f"int({text})")
        part.flat, part.extent, part.stride, part.size = flat, extent, stride, size
        return part


class Index:
    """A place in an array of some shape."""

    def __init__(
        self,
        shape: Sequence[int],
        flat: Number | None = None,
        coordinates: Sequence[Number] | None = None,
    ) -> None:
        """One of the two is given; an expression for a flat index is that of a variable."""
        self.shape = tuple(shape)
        self._flat = flat
        self._coordinates = None if coordinates is None else list(coordinates)

    @classmethod
    def first(cls, shape: Sequence[int]) -> Self:
        """Return the index of the first entry."""
        return cls(shape, flat=0)

    @property
    def flat(self) -> Number:
        """The place in the array's entries, the last axis fastest."""
        if self._flat is None:
            assert self._coordinates is not None
            self._flat = _joined(self._coordinates, self.shape)
        return self._flat

    @property
    def coordinates(self) -> list[Number]:
        """The place on each axis."""
        if self._coordinates is None:
            assert self._flat is not None
            extent, rest, found = math.prod(self.shape), math.prod(self.shape), []
            for size in self.shape:
                rest //= size
                if isinstance(self._flat, int):
                    found.append(self._flat // rest % size)
                else:
                    found.append(Coordinate.of(self._flat, extent, rest, size))
            self._coordinates = found
        return self._coordinates

    def reshaped(self, shape: Sequence[int]) -> "Index":
        """Return the same entry where the array has another shape."""
        return Index(shape, flat=self.flat)


def plus(a: Number, b: Number) -> Number:
    """Return the sum."""
    if isinstance(a, int) and isinstance(b, int):
        return a + b
    if a == 0:
        return b
    if b == 0:
        return a
    return f"({a}+{b})"


def times(a: Number, factor: int) -> Number:
    """Return the product."""
    if isinstance(a, int):
        return a * factor
    if factor == 0:
        return 0
    return a if factor == 1 else f"{a}*{factor}"


def _joined(coordinates: Sequence[Number], shape: Sequence[int]) -> Number:
    terms: list[tuple[Number, int]] = []  # coordinates with their strides
    stride = math.prod(shape)
    for coordinate, size in zip(coordinates, shape, strict=True):
        stride //= size
        if size == 1:
            continue
        if terms and terms[-1][1] == stride * size:
            both = _side_by_side(terms[-1][0], coordinate, size)
            if both is not None:
                terms[-1] = both, stride
                continue
        terms.append((coordinate, stride))
    total: Number = 0
    for coordinate, stride in terms:
        total = plus(total, times(coordinate, stride))
    return total


def _side_by_side(a: Number, b: Number, size: int) -> Number | None:
    """Two coordinates as one, if they were neighbours in a flat index. `size`: of the second."""
    if not (isinstance(a, Coordinate) and isinstance(b, Coordinate)) or a.flat != b.flat:
        return None
    if a.extent != b.extent or a.stride != b.stride * b.size or size != b.size:
        return None
    return Coordinate.of(a.flat, a.extent, b.stride, a.size * b.size)
