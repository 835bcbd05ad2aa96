"""Storage of the entries of a value: registers, a world's memory, or an argument."""

import dataclasses

import numpy as np

from kinetix.engine.native.allocation import Span
from kinetix.engine.native.flat_index import Index, Number, plus
from kinetix.engine.native.ir import Block, Value


@dataclasses.dataclass(eq=False)
class Buffer:
    """Memory of a world."""

    name: str
    dtype: np.dtype
    home: Block
    """Block in which it was made: in others it must not be overwritten."""
    span: Span
    tenants: list[Value]
    """Values that lie or lay there."""


@dataclasses.dataclass(eq=False)
class Outside:
    """An argument or a result, in the device's memory."""

    name: str


Registers = list[str]
Place = Buffer | Outside | Registers


@dataclasses.dataclass(eq=False)
class Target:
    """Destination of entries."""

    place: Buffer | Outside
    shape: tuple[int, ...] | None = None
    """Of the whole, where a part of it is written."""
    axis: int = 0
    first: Number = 0
    """Of the part, on that axis; without a shape: in all entries."""

    def at(self, index: Index) -> Number:
        """Return the place of an entry of the part."""
        if self.shape is None:
            return plus(self.first, index.flat)
        at = list(index.coordinates)
        at[self.axis] = plus(at[self.axis], self.first)
        return Index(self.shape, coordinates=at).flat


def chosen(names: Registers, at: Number) -> str:
    """Choose one of several registers."""
    if isinstance(at, int):
        return names[at]
    chain = names[-1]
    for number, name in reversed(list(enumerate(names[:-1]))):
        chain = f"({at}=={number}?{name}:{chain})"
    return chain
