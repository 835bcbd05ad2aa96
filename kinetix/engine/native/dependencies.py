"""Pieces of work of a block, each of which is done once all that it reads is there."""

import dataclasses
from collections.abc import Iterable, Iterator, Sequence

import numpy as np

from kinetix.engine.native import reducing
from kinetix.engine.native.buffers import Buffer, Target
from kinetix.engine.native.elementwise import ELEMENTWISE
from kinetix.engine.native.emitter import NEVER, Pen
from kinetix.engine.native.flat_index import Number, plus, times
from kinetix.engine.native.indexing import LOOKED_UP
from kinetix.engine.native.ir import Block, Node, Value
from kinetix.engine.native.storage import Form


@dataclasses.dataclass(eq=False)
class Item:
    """A piece of work: an operation, or that something is stored somewhere."""

    reads: set[Value]
    gives: list[Value] = dataclasses.field(default_factory=list)
    node: Node | None = None
    """The operation; None: a store."""
    count: int = 0
    """Entries that the lanes share; 0: every lane does it for itself, or it is a loop."""
    source: Value | None = None
    target: Target | None = None
    """Target of a store."""
    overwrites_own: bool = False
    """True if it writes an array of which it reads other entries."""
    is_copied: bool = False
    """True if it reads a copy, so that the original may be overwritten."""
    seen: set[tuple[Value, Number]] = dataclasses.field(default_factory=set)
    """Loads from memory, as (value, flat index)."""


class Items:
    """The work of a block, and where joined arrays are put together."""

    def __init__(self, pen: Pen, block: Block, stores: Sequence[tuple[Value, Target]]) -> None:
        self._pen = pen
        self._block = block
        self.joined: dict[Value, Buffer] = {}
        self.missing: dict[Value, int] = {}
        """Parts that are still to be stored."""
        self.all = [item for node in block.nodes for item in self._of(node)]
        for value, target in stores:
            self.all.extend(self._store(value, target))

    def _reads(self, values: Iterable[Value]) -> set[Value]:
        return self._pen.forms.roots(list(values))

    def _of(self, node: Node) -> Iterator[Item]:
        forms = {self._pen.forms[x] for x in node.outputs if x.size}
        if not forms - {Form.INLINE}:
            return
        result = node.outputs[0]
        if node.name == "concatenate" and forms == {Form.STORED}:
            yield from self._parts(node)
            return
        reads, count = self._reads(node.inputs), 0
        if node.blocks:
            reads |= {x for block in node.blocks for x in self._pen.forms.used_in(block)}
            reads -= made_in(node)
        elif node.name in reducing.REDUCTIONS:
            if not reducing.is_serial(node):
                count = node.inputs[0].size if result.size == 1 else result.size
        elif node.name in ELEMENTWISE or node.name in LOOKED_UP:
            count = result.size if forms == {Form.STORED} else 0
        yield Item(reads, node.outputs, node, count)

    def _parts(self, node: Node) -> Iterator[Item]:
        """Joined arrays are stored one by one."""
        result, axis, first = node.outputs[0], node.parameters["dimension"], 0
        buffer = self.joined[result] = self._pen.buffer(result, self._block)
        buffer.span.first = NEVER
        self.missing[result] = sum(x.size > 0 for x in node.inputs)
        for x in node.inputs:
            if x.size:
                target = Target(buffer, result.shape, axis, first)
                yield Item(self._reads([x]), [result], None, x.size, x, target)
            first += x.shape[axis]

    def _store(self, value: Value, target: Target) -> Iterator[Item]:
        node = value.node
        if (
            node is None
            or node.name != "concatenate"
            or self._pen.forms[value] is not Form.INLINE
            or any(size > 1 for size in value.shape[: node.parameters["dimension"]])
        ):
            yield Item(self._reads([value]), [], None, value.size, value, target)
            return
        axis, first = node.parameters["dimension"], 0
        inner = int(np.prod(value.shape[axis + 1 :]))
        for x in node.inputs:
            if x.size:
                begin = plus(target.first, times(first, inner))
                yield from self._store(x, Target(target.place, first=begin))
            first += x.shape[axis]


def made_in(node: Node) -> set[Value]:
    """Return all values that the blocks of an operation make or are given."""
    found: set[Value] = set()
    for block in node.blocks:
        found |= set(block.inputs)
        for inner in block.nodes:
            found |= {*inner.outputs, *made_in(inner)}
    return found
