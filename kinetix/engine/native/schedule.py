"""A block, written in an order in which as much as can be stands in the same loop over lanes."""

import collections
from collections.abc import Sequence

from kinetix.engine.native import control_flow, reducing, updates
from kinetix.engine.native.buffers import Buffer, Target
from kinetix.engine.native.dependencies import Item, Items
from kinetix.engine.native.emitter import Pen
from kinetix.engine.native.flat_index import Index
from kinetix.engine.native.fusion import Lanes
from kinetix.engine.native.ir import Block, Value
from kinetix.engine.native.storage import Form


class BlockWriter:
    """A block while it is being written."""

    def __init__(
        self,
        pen: Pen,
        block: Block,
        stores: Sequence[tuple[Value, Target]] = (),
        ends: Sequence[Value] = (),
    ) -> None:
        """Take on a block.

        Args:
            pen: Writes.
            block: The operations.
            stores: Where some of its results go.
            ends: What is read once all is done.
        """
        self.pen = pen
        self.block = block
        self._items = Items(pen, block, stores)
        self._readers: dict[Value, set[Item]] = collections.defaultdict(set)
        for item in [*self._items.all, Item(pen.forms.roots(ends))]:
            for value in item.reads:
                self._readers[value].add(item)
        self._done: set[Item] = set()

    def write(self) -> None:
        """Write all operations."""
        left = self._items.all
        while left:
            ready = [item for item in left if self._is_ready(item)]
            alone = [x for x in ready if not x.count and not self._is_heavy(x)]
            shared = [x for x in ready if x.count]
            if not ready:
                self._unlock(left)
                continue
            if alone:
                done = alone
                with self.pen.work():
                    for item in alone:
                        self._compute(item)
            elif shared:
                done = self._write_lanes(shared[0].count, left)
            else:
                done = [self._best(ready)]
                self._write_heavy(done[0])
            self._done.update(done)
            left = [item for item in left if item not in self._done]

    def _is_heavy(self, item: Item) -> bool:
        """Return whether an operation is written by itself."""
        node = item.node
        if node is None:
            return False
        if node.name == "dynamic_update_slice":
            return self.pen.forms[node.outputs[0]] is Form.STORED
        return bool(node.blocks) or node.name.startswith("scatter")

    def _is_ready(self, item: Item, group: Sequence[Item] = ()) -> bool:
        inside = self.pen.temporaries if group else {}
        if not all(x in self.pen.places or x in inside for x in item.reads):
            return False
        return item.target is None or not self._is_awaited(item, group)

    def _is_awaited(self, item: Item, group: Sequence[Item]) -> bool:
        """Return whether what a store overwrites is still to be read."""
        assert item.target is not None and item.source is not None
        place = item.target.place
        if item.overwrites_own and not item.is_copied:
            return True
        if not isinstance(place, Buffer) or self.pen.is_stored(item.source, item.target):
            return False
        for tenant in place.tenants:
            if tenant in item.gives:
                continue
            for reader in self._readers[tenant] - self._done - {item}:
                if reader not in group:
                    return True
                if any(value is tenant and at != "i" for value, at in reader.seen):
                    return True
        return False

    def _unlock(self, left: Sequence[Item]) -> None:
        """Break a cycle of stores by copying one source."""
        for item in left:
            source = item.source
            if source is None or item.is_copied:
                continue
            if all(x in self.pen.places for x in item.reads):
                copy = Value(source.shape, source.dtype)
                buffer = self.pen.buffer(copy, self.block)
                self.pen.store([(source, Target(buffer))])
                self.pen.places[copy] = buffer
                for value in item.reads:
                    self._readers[value].discard(item)
                item.source, item.reads, item.is_copied = copy, {copy}, True
                self._readers[copy].add(item)
                return
        raise AssertionError("nothing that is left of a block can be done")

    def _best(self, ready: Sequence[Item]) -> Item:
        """Return the first that overwrites nothing that is still to be read."""
        for item in ready:
            assert item.node is not None
            if not item.node.inputs or self.to_overwrite(item.node.inputs[0], item):
                return item
        return ready[0]

    def to_overwrite(self, value: Value, item: Item) -> Buffer | None:
        """Return the buffer of a value, if only this item needs it any more."""
        place = self.pen.places.get(value)
        if not isinstance(place, Buffer) or place.home is not self.block:
            return None
        if any(self._readers[tenant] - self._done - {item} for tenant in place.tenants):
            return None
        return place

    def _compute(self, item: Item) -> None:
        """Every lane computes a small value for itself."""
        node, read = item.node, self.pen.read
        assert node is not None
        result = node.outputs[0]
        places = [Index(result.shape, flat=k) for k in range(result.size)]
        if node.name in reducing.REDUCTIONS:
            entries = [reducing.folded(node, place, read) for place in places]
        elif node.name == "dynamic_update_slice":
            entries = [updates.updated(node, place, read) for place in places]
        else:
            entries = [self.pen.computed(result, place) for place in places]
        self.pen.declare(result, entries)

    def _write_lanes(self, count: int, left: Sequence[Item]) -> list[Item]:
        lanes = Lanes(self.pen, count)
        lanes.write(left, self._is_ready, self._is_wanted, self.block)
        for item in lanes.items:
            for value in item.gives if item.target is not None else ():
                self._items.missing[value] -= 1
                if not self._items.missing[value]:
                    self.pen.places[value] = self._items.joined[value]
        return lanes.items

    def _is_wanted(self, value: Value, group: Sequence[Item]) -> bool:
        return bool(self._readers[value] - set(group))

    def _write_heavy(self, item: Item) -> None:
        node = item.node
        assert node is not None
        if node.name == "dynamic_update_slice":
            updates.update(self, item, node)
        elif node.blocks:
            control_flow.CONTROL[node.name](self, item, node)
        else:
            updates.scatter(self, item, node)
