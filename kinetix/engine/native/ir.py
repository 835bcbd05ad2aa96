"""Programs: blocks of operations on arrays."""

import dataclasses
import math
from collections.abc import Iterator
from typing import Any

import numpy as np
from jaxtyping import Shaped


class CannotTranslate(Exception):
    """There is no rule for something; the message says what."""


@dataclasses.dataclass(eq=False)
class Value:
    """One array."""

    shape: tuple[int, ...]
    dtype: np.dtype
    node: "Node | None" = None
    """Operation that computes it; None: an argument or a constant."""
    constant: Shaped[np.ndarray, "..."] | None = None

    @property
    def size(self) -> int:
        """Number of entries."""
        return math.prod(self.shape)


@dataclasses.dataclass(eq=False)
class Node:
    """One operation."""

    name: str
    """Name of the primitive."""
    inputs: list[Value]
    outputs: list[Value]
    parameters: dict[str, Any]
    blocks: list["Block"] = dataclasses.field(default_factory=list)
    """Of a loop (condition, body) or a conditional (its branches)."""


@dataclasses.dataclass(eq=False)
class Block:
    """Operations in an order in which they can be done."""

    inputs: list[Value]
    nodes: list[Node] = dataclasses.field(default_factory=list)
    outputs: list[Value] = dataclasses.field(default_factory=list)


def everywhere(block: Block) -> Iterator[Block]:
    """A block and all blocks in it."""
    yield block
    for node in block.nodes:
        for nested in node.blocks:
            yield from everywhere(nested)
