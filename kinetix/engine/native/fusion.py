"""One loop over the lanes with as much in it as can be: what is computed entry by entry."""

from collections.abc import Callable, Sequence

import numpy as np

from kinetix.engine.native import reducing
from kinetix.engine.native.buffers import Buffer, Outside, Target
from kinetix.engine.native.dependencies import Item
from kinetix.engine.native.elementwise import c_type
from kinetix.engine.native.emitter import Misplaced, Pen
from kinetix.engine.native.flat_index import Index
from kinetix.engine.native.ir import Block, Node, Value


class Lanes:
    """The loop while it is being written."""

    def __init__(self, pen: Pen, count: int) -> None:
        self.items: list[Item] = []
        self._pen = pen
        self._count = count
        self._before: list[str] = []
        self._sums: list[tuple[Value, Node, str]] = []
        self._stores: list[tuple[str, Target]] = []

    def write(
        self,
        candidates: Sequence[Item],
        is_ready: Callable[[Item, Sequence[Item]], bool],
        is_wanted: Callable[[Value, Sequence[Item]], bool],
        home: Block,
    ) -> None:
        """Write all that fits.

        Args:
            candidates: Items of the block that are not done.
            is_ready: Whether one can be done beside those that are in the loop.
            is_wanted: Whether a value is read by others than these.
            home: The block.
        """
        pen, head = self._pen, f"LANES(i,{self._count}) {{"
        with pen.work() as lines:
            pen.loaded = {}
            while self._grows(candidates, is_ready):
                pass
            for value, name in pen.temporaries.items():
                if is_wanted(value, self.items):
                    buffer = pen.places[value] = pen.buffer(value, home)
                    pen.mark_written(buffer)
                    lines.append(f"{buffer.name}[i]={name};")
            for text, target in self._stores:
                pen.mark_written(target.place)
                lines.append(text)
            pen.temporaries, pen.loaded = {}, None
            lines[:] = [*self._before, head, *lines, "}"]
        for value, node, total in self._sums:
            name = node.name.removeprefix("reduce_").upper()
            pen.declare(value, [f"ALL_{name}({total})"])

    def _grows(
        self, candidates: Sequence[Item], is_ready: Callable[[Item, Sequence[Item]], bool]
    ) -> bool:
        before = len(self.items)
        for item in candidates:
            if item.count != self._count or item in self.items:
                continue
            if is_ready(item, [*self.items, item]) and self._is_added(item):
                self.items.append(item)
        return len(self.items) > before

    def _is_added(self, item: Item) -> bool:
        """Add an item, if what it reads of others in the loop is at its own place."""
        pen = self._pen
        lines, loaded, read = len(pen.lines), dict(pen.loaded or {}), set(pen.read_now)
        pen.seen = item.seen = set()
        try:
            if item.source is not None and item.target is not None:
                self._store(item.source, item.target)
                item.overwrites_own = _reads_elsewhere(item, item.target.place)
                if item.overwrites_own:
                    self._stores.pop()
                    raise Misplaced
            elif item.node is not None:
                self._compute(item.node)
        except Misplaced:
            del pen.lines[lines:]
            pen.loaded, pen.read_now = loaded, read
            return False
        return True

    def _store(self, source: Value, target: Target) -> None:
        if self._pen.is_stored(source, target):
            return
        index = Index(source.shape, flat="i")
        at = target.at(index)
        entry = self._pen.read(source, index)
        # First all that is read, then what is written.
        if not entry.isidentifier():
            name = self._pen.name("t")
            self._pen.lines.append(f"const {c_type(source.dtype)} {name}={entry};")
            entry = name
        self._stores.append((f"{target.place.name}[{at}]={entry};", target))

    def _compute(self, node: Node) -> None:
        pen, result = self._pen, node.outputs[0]
        kind, is_reduction = c_type(result.dtype), node.name in reducing.REDUCTIONS
        if is_reduction and result.size == 1:
            x = node.inputs[0]
            entry = pen.read(x, Index(x.shape, flat="i"))
            name = pen.name("s")
            self._before.append(f"{kind} {name}={reducing.nothing(node)};")
            pen.lines.append(f"{name}={reducing.REDUCTIONS[node.name](name, entry)};")
            self._sums.append((result, node, name))
            return
        name, index = pen.name("t"), Index(result.shape, flat="i")
        if is_reduction:
            self._reduce(node, index, name)
        else:
            entry = pen.computed(result, index)
            pen.lines.append(f"const {kind} {name}={entry};")
        pen.temporaries[result] = name

    def _reduce(self, node: Node, index: Index, name: str) -> None:
        """One lane reduces all entries that go into one result."""
        pen, x, axes = self._pen, node.inputs[0], node.parameters["axes"]
        sizes = [x.shape[axis] for axis in axes]
        count, kind = int(np.prod(sizes)), c_type(node.outputs[0].dtype)
        if count <= reducing.UNIFORM_SIZE:
            pen.lines.append(f"const {kind} {name}={reducing.folded(node, index, pen.read)};")
            return
        turn = pen.name("j")
        pen.lines.append(f"{kind} {name}={reducing.nothing(node)};")
        pen.lines.append(f"TURNS for(int {turn}=0;{turn}<{count};{turn}++) {{")
        outer, pen.loaded = pen.loaded, dict(pen.loaded or {})
        inner = Index(sizes, flat=turn).coordinates
        entry = pen.read(x, reducing.beside(x, axes, index, inner))
        pen.lines.append(f"{name}={reducing.REDUCTIONS[node.name](name, entry)};")
        pen.lines.append("}")
        pen.loaded = outer


def _reads_elsewhere(item: Item, place: Buffer | Outside) -> bool:
    """Return whether an item reads memory at other places than the one that is being written."""
    tenants = place.tenants if isinstance(place, Buffer) else ()
    return any(value in tenants and at != "i" for value, at in item.seen)
