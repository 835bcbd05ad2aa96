"""Writes a program as the body of a C++ function that one world's lanes run together.

What a lane does for all (`UNIFORM`) stands as it is; entries of arrays are done in loops over lanes
(`LANES`), as many in one loop as can be; `SYNC` stands where one lane may read what another wrote.
"""

import collections
import contextlib
import dataclasses
from collections.abc import Iterable, Iterator, Sequence
from typing import Any, Final

import numpy as np

from kinetix.engine.native.elementwise import ELEMENTWISE, c_type, literal
from kinetix.engine.native.forms import Form, Forms, is_serial_reduction
from kinetix.engine.native.index import Index, Number, plus, times
from kinetix.engine.native.memory import Span, placed, prolonged
from kinetix.engine.native.program import Block, CannotTranslate, Node, Value
from kinetix.engine.native.reading import FREE, LOOKED_UP, starts_of


@dataclasses.dataclass(eq=False)
class Buffer:
    """Memory of a world."""

    name: str
    dtype: np.dtype
    size: int
    home: Block
    """Where it was made: elsewhere it must not be overwritten."""
    span: Span
    tenants: list[Value] = dataclasses.field(default_factory=list)
    """Values that lie or lay there."""


@dataclasses.dataclass(eq=False)
class Outside:
    """An argument in the device's memory."""

    name: str


Registers = list[str]
Place = Buffer | Outside | Registers


SCATTERED: Final = {"scatter": "{0}={1};", "scatter-add": "{0}+={1};", "scatter_add": "{0}+={1};"}
"""What becomes of an entry that a change goes to."""

NEVER: Final = 1 << 60
"""A time after all others."""


class _Misplaced(Exception):
    """Something is read at another place than the one at which it is being computed."""


@dataclasses.dataclass(eq=False)
class Item:
    """A piece of work of a block."""

    order: int
    reads: set[Value]
    gives: list[Value]
    node: Node | None = None
    count: int = 0
    """Entries, of work that the lanes share."""
    source: Value | None = None
    """What is stored, of a store."""
    target: "Target | None" = None
    is_copied: bool = False
    """Whether the source is a copy, made so that what it was could be overwritten."""
    seen: set[tuple[Value, Number]] = dataclasses.field(default_factory=set)
    """What was read of memory, and where."""


@dataclasses.dataclass(eq=False)
class Target:
    """Where entries go."""

    place: Buffer | Outside
    shape: tuple[int, ...] | None = None
    """Of the whole, where a part of it is written."""
    axis: int = 0
    first: Number = 0
    """Of the part, on that axis; without a shape: in all entries."""

    def at(self, index: Index) -> Number:
        """The place of an entry of the part."""
        if self.shape is None:
            return plus(self.first, index.flat)
        at = list(index.coordinates)
        at[self.axis] = plus(at[self.axis], self.first)
        return Index(self.shape, coordinates=at).flat


@dataclasses.dataclass(eq=False)
class Written:
    """The text, and what it needs."""

    body: str
    constants: str
    near: int
    """Bytes of memory of a world that its lanes share."""
    far: int
    """The same, for large arrays, of which a world uses a part."""


def written(program: Block, largest: int) -> Written:
    """Write a program.

    Args:
        program: Of one world.
        largest: Array that lies in near memory [bytes].

    Raises:
        CannotTranslate: There is no rule for an operation or a type.
    """
    return _Writer(program).whole(largest)


class _Writer:
    def __init__(self, program: Block) -> None:
        self.program = program
        self.forms = Forms(program)
        self.lines: list[str] = []
        self.constants: list[str] = []
        self.known_constants: dict[Any, str] = {}
        self.places: dict[Value, Place] = {}
        self.buffers: list[Buffer] = []
        self.loops: list[tuple[int, int]] = []
        self.number = 0
        self.time = 0
        self.joined: dict[Value, Buffer] = {}
        self.missing: dict[Value, int] = {}
        self.readers: dict[Value, set[Item]] = {}
        self.done: set[Item] = set()
        self.used: dict[Block, set[Value]] = {}
        # Of what is being written now.
        self.home = program
        self.temporaries: dict[Value, str] = {}
        self.loaded: dict[tuple[str, Number], str] | None = None
        self.item: Item | None = None
        self.guards = 0
        self.read_now: set[Buffer] = set()
        # Since the last time that the lanes waited for each other.
        self.unread: set[Buffer] = set()
        self.read_since = False

    def whole(self, largest: int) -> Written:
        """The text of the whole function."""
        self._arguments()
        outputs = []
        for number, value in enumerate(self.program.outputs):
            if value.size:
                outputs.append((value, Target(Outside(f"out{number}"))))
        self._block(self.program, outputs)
        prolonged([buffer.span for buffer in self.buffers], self.loops)
        far = [buffer for buffer in self.buffers if buffer.span.size > largest]
        near = [buffer for buffer in self.buffers if buffer.span.size <= largest]
        sizes = [placed(buffer.span for buffer in some) for some in (near, far)]
        declared = [
            f"ARRAY({c_type(b.dtype)}, {b.name}, {where} + {b.span.place})"
            for where, some in (("near", near), ("far", far))
            for b in some
        ]
        return Written(
            body="\n".join([*declared, *self.lines]),
            constants="\n".join(self.constants),
            near=sizes[0],
            far=sizes[1],
        )

    # --- names, memory, waiting ---

    def name(self, letter: str) -> str:
        self.number += 1
        return f"{letter}{self.number}"

    def buffer(self, value: Value) -> Buffer:
        size = value.size * value.dtype.itemsize
        buffer = Buffer(
            self.name("m"),
            value.dtype,
            value.size,
            self.home,
            Span(size, self.time, self.time),
            [value],
        )
        self.buffers.append(buffer)
        return buffer

    def declare(self, value: Value, expressions: Sequence[str], *, constant: bool = True) -> None:
        """Keep a value in registers."""
        kind = f"{'const ' if constant else ''}{c_type(value.dtype)}"
        names = []
        for expression in expressions:
            names.append(self.name("r"))
            self.lines.append(f"{kind} {names[-1]}={expression};")
        self.places[value] = names

    def wait(self) -> None:
        """Have the lanes wait for each other where any has written or read."""
        if self.unread or self.read_since:
            self.lines.append("SYNC")
        self.unread, self.read_since = set(), False

    @contextlib.contextmanager
    def work(self, writes: Iterable[Place] = ()) -> Iterator[list[str]]:
        """A piece of text of which is known what memory it reads and writes."""
        self.time += 1
        outer, self.lines, self.read_now = self.lines, [], set()
        try:
            yield self.lines
        finally:
            text, self.lines = self.lines, outer
        written_to = {place for place in writes if isinstance(place, Buffer)}
        if self.read_now & self.unread or (written_to and self.read_since):
            self.wait()
        self.lines.extend(text)
        self.unread |= written_to
        self.read_since |= bool(self.read_now)
        self._touched(self.read_now | written_to)

    def _touched(self, buffers: Iterable[Buffer]) -> None:
        for buffer in buffers:
            buffer.span.first = min(buffer.span.first, self.time)
            buffer.span.last = self.time

    # --- reading ---

    def read(self, value: Value, index: Index) -> str:
        """The C of an entry."""
        if value.constant is not None:
            return self._constant(value, index)
        if value in self.temporaries:
            if index.flat != "i":
                raise _Misplaced
            return self.temporaries[value]
        place = self.places.get(value)
        if place is not None:
            return self._placed(value, place, index)
        if self.forms[value] is not Form.INLINE:
            raise _Misplaced
        return self._computed(value, index)

    def _computed(self, value: Value, index: Index) -> str:
        """The C of an entry by the operation that it comes from."""
        node = value.node
        assert node is not None
        rule = ELEMENTWISE.get(node.name)
        if rule is not None:
            return rule(node, [self.read(x, _same_place(x, index)) for x in node.inputs])
        if node.name in FREE:
            return FREE[node.name](node, index, self.read)
        rule = LOOKED_UP.get(node.name)
        if rule is None:
            raise CannotTranslate(f"kernels have no rule for {node.name}")
        self.guards += 1
        try:
            return rule(node, index, self.read)
        finally:
            self.guards -= 1

    def _placed(self, value: Value, place: Place, index: Index) -> str:
        if isinstance(place, list):
            return _chosen(place, index.flat)
        if isinstance(place, Buffer):
            self.read_now.add(place)
        if self.item is not None:
            self.item.seen.add((value, index.flat))
        text = f"{place.name}[{index.flat}]"
        if self.loaded is None or self.guards:
            return text
        key = place.name, index.flat
        if key not in self.loaded:
            self.loaded[key] = self.name("l")
            self.lines.append(f"const {c_type(value.dtype)} {self.loaded[key]}={text};")
        return self.loaded[key]

    def _constant(self, value: Value, index: Index) -> str:
        table = value.constant
        assert table is not None
        flat = np.ravel(table)
        if not flat.size:
            return literal(np.zeros((), value.dtype)[()], value.dtype)
        if isinstance(index.flat, int):
            return literal(flat[index.flat], value.dtype)
        if (flat == flat[0]).all():
            return literal(flat[0], value.dtype)
        key = value.dtype, flat.tobytes()
        if key not in self.known_constants:
            name = self.known_constants[key] = self.name("k")
            entries = ",".join(literal(x, value.dtype) for x in flat)
            self.constants.append(
                f"TABLE({c_type(value.dtype)}, {name}, {flat.size}) {{{entries}}};"
            )
        return f"{self.known_constants[key]}[{index.flat}]"

    # --- arguments and blocks ---

    def _arguments(self) -> None:
        copied = []
        used = self._used_in(self.program)
        for number, value in enumerate(self.program.inputs):
            if not value.size or value not in used:
                continue
            outside = Outside(f"in{number}")
            if self.forms[value] is Form.UNIFORM:
                self.declare(value, [f"in{number}[{k}]" for k in range(value.size)])
                continue
            argument = Value(value.shape, value.dtype)
            self.places[argument] = outside
            copied.append((argument, value))
        targets = []
        for argument, value in copied:
            self.places[value] = self.buffer(value)
            targets.append((argument, Target(self.places[value])))
        self._store(targets)

    def _used_in(self, block: Block) -> set[Value]:
        """What is read in a block and in those in it."""
        if block not in self.used:
            found = self.forms.roots(block.outputs)
            for node in block.nodes:
                found |= self.forms.roots(node.inputs)
                for nested in node.blocks:
                    found |= self._used_in(nested)
            self.used[block] = found
        return self.used[block]

    def _block(
        self, block: Block, stores: Sequence[tuple[Value, Target]], ends: Sequence[Value] = ()
    ) -> None:
        """All operations of a block.

        Args:
            block: The operations.
            stores: Where some of its results go.
            ends: What is read once all is done.
        """
        outer = self.home, self.readers, self.done
        self.home = block
        items = self._items(block, stores)
        self.readers = collections.defaultdict(set)
        end = Item(len(items), self.forms.roots(ends), [])
        for item in [*items, end]:
            for value in item.reads:
                self.readers[value].add(item)
        self.done = set()
        self._in_some_order(items)
        self.home, self.readers, self.done = outer

    def _items(self, block: Block, stores: Sequence[tuple[Value, Target]]) -> list[Item]:
        items: list[Item] = []

        def add(reads: Iterable[Value], gives: list[Value], **more: Any) -> None:
            items.append(Item(len(items), self.forms.roots(list(reads)), gives, **more))

        for node in block.nodes:
            forms = {self.forms[x] for x in node.outputs if x.size}
            if forms == {Form.INLINE} or not forms:
                continue
            result = node.outputs[0]
            if node.blocks:
                reads = {*node.inputs}
                for nested in node.blocks:
                    reads |= self._used_in(nested)
                add(reads - self._made_in(node), node.outputs, node=node)
            elif node.name == "concatenate" and forms == {Form.STORED}:
                self._parts(node, add)
            elif node.name.startswith("reduce_"):
                alone = result.size == 1 and not is_serial_reduction(node)
                count = node.inputs[0].size if alone else result.size
                if is_serial_reduction(node):
                    count = 0
                add(node.inputs, node.outputs, node=node, count=count)
            elif forms == {Form.STORED} and (node.name in ELEMENTWISE or node.name in LOOKED_UP):
                add(node.inputs, node.outputs, node=node, count=result.size)
            else:
                add(node.inputs, node.outputs, node=node)
        for value, target in stores:
            self._store_items(value, target, add)
        return items

    def _made_in(self, node: Node) -> set[Value]:
        """All values that blocks of a node make or are given."""
        found: set[Value] = set()
        for block in node.blocks:
            found |= set(block.inputs)
            for nested in block.nodes:
                found |= {*nested.outputs, *self._made_in(nested)}
        return found

    def _parts(self, node: Node, add: Any) -> None:
        """Store the parts of joined arrays one by one."""
        result = node.outputs[0]
        buffer = self.joined[result] = self.buffer(result)
        buffer.span.first = NEVER
        axis, first = node.parameters["dimension"], 0
        parts = [x for x in node.inputs if x.size]
        self.missing[result] = len(parts)
        for x in node.inputs:
            if x.size:
                target = Target(buffer, result.shape, axis, first)
                add([x], [result], source=x, target=target, count=x.size)
            first += x.shape[axis]

    def _store_items(self, value: Value, target: Target, add: Any) -> None:
        node = value.node
        if (
            node is not None
            and node.name == "concatenate"
            and self.forms[value] is Form.INLINE
            and target.shape is None
        ):
            axis, first = node.parameters["dimension"], 0
            if all(size == 1 for size in value.shape[:axis]):
                for x in node.inputs:
                    if x.size:
                        inner = times(first, int(np.prod(value.shape[axis + 1 :])))
                        self._store_items(
                            x, Target(target.place, first=plus(target.first, inner)), add
                        )
                    first += x.shape[axis]
                return
        add([value], [], source=value, target=target, count=value.size)

    # --- order ---

    def _in_some_order(self, items: list[Item]) -> None:
        left = list(items)
        while left:
            ready = [item for item in left if self._is_ready(item)]
            if not ready:
                self._broken(left)
                continue
            alone = [x for x in ready if not x.count and not self._is_heavy(x)]
            shared = [x for x in ready if x.count]
            if alone:
                chosen = alone
                with self.work():
                    for item in alone:
                        self._uniform(item)
            elif shared:
                chosen = self._group(shared[0], left)
            else:
                chosen = [self._best(ready)]
                self._heavy(chosen[0])
            for item in chosen:
                self.done.add(item)
            gone = set(chosen)
            left = [item for item in left if item not in gone]

    def _is_heavy(self, item: Item) -> bool:
        node = item.node
        if node is None:
            return False
        if node.name == "dynamic_update_slice":
            return self.forms[node.outputs[0]] is Form.STORED
        return bool(node.blocks) or node.name.startswith("scatter")

    def _is_there(self, value: Value) -> bool:
        return value in self.places

    def _is_ready(self, item: Item, group: Sequence[Item] = ()) -> bool:
        inside = self.temporaries if group else {}
        if not all(self._is_there(x) or x in inside for x in item.reads):
            return False
        return item.target is None or not self._is_awaited(item, group)

    def _is_awaited(self, item: Item, group: Sequence[Item]) -> bool:
        """Tell whether what the item overwrites is still to be read."""
        assert item.target is not None
        place = item.target.place
        if not isinstance(place, Buffer) or self._is_stored(item):
            return False
        for tenant in place.tenants:
            if tenant in item.gives:
                continue
            for reader in self.readers.get(tenant, ()):
                if reader in self.done or reader is item:
                    continue
                if reader not in group:
                    return True
                if any(value is tenant and at != "i" for value, at in reader.seen):
                    return True
        return False

    def _is_stored(self, item: Item) -> bool:
        """Tell whether what a store wants is so already."""
        assert item.target is not None
        source, target = item.source, item.target
        return (
            source is not None
            and self.places.get(source) is target.place
            and target.shape is None
            and target.first == 0
        )

    def _broken(self, left: list[Item]) -> None:
        """Copies that wait for each other: one goes to a place of its own first."""
        for item in left:
            source = item.source
            if source is None or item.is_copied:
                continue
            if all(self._is_there(x) for x in item.reads):
                copy = Value(source.shape, source.dtype)
                self._store([(source, Target(self.buffer(copy)))])
                self.places[copy] = self.buffers[-1]
                for root in item.reads:
                    self.readers[root].discard(item)
                item.source, item.reads, item.is_copied = copy, {copy}, True
                self.readers[copy].add(item)
                return
        raise AssertionError("no operation of a block can be done")

    def _best(self, ready: list[Item]) -> Item:
        """The first that overwrites nothing that is still to be read."""
        for item in ready:
            assert item.node is not None
            base = item.node.inputs[0] if item.node.inputs else None
            if base is None or self._may_overwrite(base, item) is not None:
                return item
        return ready[0]

    def _may_overwrite(self, value: Value, item: Item) -> Buffer | None:
        """The buffer of a value, if nobody else needs it any more."""
        place = self.places.get(value)
        if not isinstance(place, Buffer) or place.home is not self.home:
            return None
        for tenant in place.tenants:
            if any(x not in self.done and x is not item for x in self.readers.get(tenant, ())):
                return None
        return place

    # --- every lane for itself ---

    def _uniform(self, item: Item) -> None:
        node = item.node
        assert node is not None
        result = node.outputs[0]
        if is_reduction(node):
            entries = [self._folded(node, Index(result.shape, flat=k)) for k in range(result.size)]
        elif node.name == "dynamic_update_slice":
            entries = [self._updated(node, Index(result.shape, flat=k)) for k in range(result.size)]
        else:
            entries = [
                self._computed(result, Index(result.shape, flat=k)) for k in range(result.size)
            ]
        self.declare(result, entries)

    def _updated(self, node: Node, index: Index) -> str:
        base, update, *starts = node.inputs
        begins = starts_of(starts, base.shape, update.shape, self.read)
        inside, at = [], []
        for here, begin, size, extent in zip(
            index.coordinates, begins, update.shape, base.shape, strict=True
        ):
            if size == extent:
                at.append(here)
                continue
            place = f"({here}-{begin})"
            inside.append(f"unsigned{place}<{size}u")
            at.append(place if size > 1 else 0)
        new = self.read(update, Index(update.shape, coordinates=at))
        return f"({'&&'.join(inside)}?{new}:{self.read(base, index)})" if inside else new

    def _folded(self, node: Node, index: Index) -> str:
        """All entries that go into one result, one after the other."""
        x, axes = node.inputs[0], node.parameters["axes"]
        total = None
        for inner in np.ndindex(*[x.shape[axis] for axis in axes]):
            entry = self.read(x, _beside(x, axes, index, inner))
            total = entry if total is None else _combined(node, total, entry)
        return total if total is not None else _nothing(node)

    # --- lanes side by side ---

    def _group(self, first: Item, left: list[Item]) -> list[Item]:
        """One loop over lanes with as much in it as can be."""
        group: list[Item] = []
        self.temporaries, self.loaded = {}, {}
        sums: list[tuple[Value, Node, str]] = []
        self.time += 1
        outer, self.lines, self.read_now = self.lines, [], set()
        stores: list[tuple[Value, Target]] = []
        before: list[str] = []
        again = True
        while again:
            again = False
            for item in left:
                if (
                    item.count != first.count
                    or item in group
                    or not self._is_ready(item, [*group, item])
                ):
                    continue
                if self._add(item, before, sums, stores):
                    group.append(item)
                    again = True
        # A store that was let in because its readers are in the group must stay behind them.
        self.item = None
        members = set(group)
        written_to: set[Buffer] = set()
        for value, text in self.temporaries.items():
            if self.readers.get(value, set()) <= members:
                continue
            buffer = self.places[value] = self.buffer(value)
            written_to.add(buffer)
            self.lines.append(f"{buffer.name}[i]={text};")
        for text, target in stores:
            if isinstance(target.place, Buffer):
                written_to.add(target.place)
            self.lines.append(text)
        inner, self.lines = self.lines, outer
        self.temporaries, self.loaded = {}, None
        if self.read_now & self.unread or (written_to and self.read_since):
            self.wait()
        self.lines.extend(before)
        self.lines.append(f"LANES(i,{first.count}) {{")
        self.lines.extend(inner)
        self.lines.append("}")
        for value, node, total in sums:
            self.declare(value, [f"ALL_{node.name.removeprefix('reduce_').upper()}({total})"])
        self.unread |= written_to
        self.read_since |= bool(self.read_now)
        self._touched(self.read_now | written_to)
        for item in group:
            for value in item.gives:
                if value in self.missing and item.source is not None:
                    self.missing[value] -= 1
                    if not self.missing[value]:
                        self.places[value] = self.joined[value]
        return group

    def _add(
        self,
        item: Item,
        before: list[str],
        sums: list[tuple[Value, Node, str]],
        stores: list[tuple[str, Target]],
    ) -> bool:
        """Add an item to the loop that is being written, if it fits."""
        lines, loaded, seen = len(self.lines), dict(self.loaded or {}), set(self.read_now)
        self.item = item
        item.seen = set()
        try:
            self._add_lines(item, before, sums, stores)
        except _Misplaced:
            del self.lines[lines:]
            self.loaded, self.read_now = loaded, seen
            return False
        finally:
            self.item = None
        return True

    def _add_lines(
        self,
        item: Item,
        before: list[str],
        sums: list[tuple[Value, Node, str]],
        stores: list[tuple[str, Target]],
    ) -> None:
        node = item.node
        if item.source is not None:
            assert item.target is not None
            if self._is_stored(item):
                return
            index = Index(item.source.shape, flat="i")
            at = item.target.at(index)
            text = self.read(item.source, index)
            if not text.isidentifier():
                name = self.name("t")
                self.lines.append(f"const {c_type(item.source.dtype)} {name}={text};")
                text = name
            stores.append((f"{item.target.place.name}[{at}]={text};", item.target))
            return
        assert node is not None
        result = node.outputs[0]
        kind = c_type(result.dtype)
        if is_reduction(node) and result.size == 1:
            x = node.inputs[0]
            text = self.read(x, Index(x.shape, flat="i"))
            name = self.name("s")
            before.append(f"{kind} {name}={_nothing(node)};")
            self.lines.append(f"{name}={_combined(node, name, text)};")
            sums.append((result, node, name))
            return
        name = self.name("t")
        index = Index(result.shape, flat="i")
        if is_reduction(node):
            self._serial(node, index, name)
        else:
            text = self._computed(result, index)
            self.lines.append(f"const {kind} {name}={text};")
        self.temporaries[result] = name

    def _serial(self, node: Node, index: Index, name: str) -> None:
        """One lane reduces all entries that go into one result."""
        x, axes = node.inputs[0], node.parameters["axes"]
        sizes = [x.shape[axis] for axis in axes]
        kind = c_type(node.outputs[0].dtype)
        if np.prod(sizes) <= 4:
            self.lines.append(f"const {kind} {name}={self._folded(node, index)};")
            return
        self.lines.append(f"{kind} {name}={_nothing(node)};")
        turn = self.name("j")
        self.lines.append(f"TURNS for(int {turn}=0;{turn}<{int(np.prod(sizes))};{turn}++) {{")
        outer = self.loaded
        self.loaded = dict(outer or {})
        inner = Index(sizes, flat=turn).coordinates
        entry = self.read(x, _beside(x, axes, index, inner))
        self.lines.append(f"{name}={_combined(node, name, entry)};")
        self.loaded = outer
        self.lines.append("}")

    def _store(self, stores: Sequence[tuple[Value, Target]]) -> None:
        """Store some values at once: none of them hangs on a place that another goes to."""
        by_count: dict[int, list[tuple[Value, Target]]] = collections.defaultdict(list)
        for value, target in stores:
            if value.size:
                by_count[value.size].append((value, target))
        for count, some in by_count.items():
            places = [target.place for _, target in some]
            with self.work(places) as lines:
                lines.append(f"LANES(i,{count}) {{")
                self.loaded = {}
                texts = [
                    (self.read(value, Index(value.shape, flat="i")), target, value)
                    for value, target in some
                ]
                for text, target, value in texts:
                    at = target.at(Index(value.shape, flat="i"))
                    lines.append(f"{target.place.name}[{at}]={text};")
                self.loaded = None
                lines.append("}")

    # --- loops, conditionals and changes of a part ---

    def _heavy(self, item: Item) -> None:
        node = item.node
        assert node is not None
        if node.name == "while":
            self._while(item, node)
        elif node.name == "scan":
            self._scan(item, node)
        elif node.name == "cond":
            self._cond(node)
        elif node.name == "dynamic_update_slice":
            self._update(item, node)
        elif node.name.startswith("scatter"):
            self._scatter(item, node)
        else:
            raise CannotTranslate(f"kernels have no rule for {node.name}")

    def _carry(
        self, item: Item, starts: Sequence[Value], results: Sequence[Value], inner: Sequence[Value]
    ) -> None:
        """Give what a loop carries its place, with what it starts from."""
        assert item.node is not None
        used = set().union(*[self._used_in(block) for block in item.node.blocks])
        copies, taken = [], set()
        for start, result, own in zip(starts, results, inner, strict=True):
            if not start.size:
                continue
            if self.forms[own] is Form.UNIFORM:
                with self.work():
                    entries = [
                        self.read(start, Index(start.shape, flat=k)) for k in range(start.size)
                    ]
                    self.declare(own, entries, constant=False)
                self.places[result] = self.places[own]
                continue
            buffer = self._may_overwrite(start, item)
            if buffer is None or buffer in taken or any(x in used for x in buffer.tenants):
                buffer = self.buffer(own)
                copies.append((start, Target(buffer)))
            taken.add(buffer)
            buffer.tenants.append(own)
            self.places[own] = buffer
            buffer.tenants.append(result)
            self.places[result] = buffer
        self._store(copies)

    def _turn(
        self, body: Block, carried: Sequence[Value], extra: Sequence[tuple[Value, Target]]
    ) -> None:
        """A loop's body: what it carries is replaced at its end."""
        results = body.outputs[: len(carried)]
        stores = list(extra)
        buffers = []
        for own in carried:
            place = self.places.get(own)
            if isinstance(place, Buffer):
                buffers.append((place, place.home))
                place.home = body
        for own, result in zip(carried, results, strict=True):
            place = self.places.get(own)
            if isinstance(place, Buffer) and result is not own:
                stores.append((result, Target(place)))
        kept = [
            result
            for own, result in zip(carried, results, strict=True)
            if isinstance(self.places.get(own), list)
        ]
        self._block(body, stores, kept)
        changed = []
        with self.work():
            for own, result in zip(carried, results, strict=True):
                place = self.places.get(own)
                if isinstance(place, list) and result is not own:
                    entries = [
                        self.read(result, Index(result.shape, flat=k)) for k in range(len(place))
                    ]
                    for name, entry in zip(place, entries, strict=True):
                        new = self.name("n")
                        self.lines.append(f"const {c_type(own.dtype)} {new}={entry};")
                        changed.append(f"{name}={new};")
        self.lines.extend(changed)
        for place, home in buffers:
            place.home = home

    def _while(self, item: Item, node: Node) -> None:
        condition, body = node.blocks
        self._carry(item, node.inputs, node.outputs, body.inputs)
        for own, other in zip(body.inputs, condition.inputs, strict=True):
            if own in self.places:
                self.places[other] = self.places[own]
                if isinstance(self.places[own], Buffer):
                    self.places[own].tenants.append(other)
        with self._looped("TURNS for(;;) {"):
            self._block(condition, [], condition.outputs)
            with self.work():
                going = self.read(condition.outputs[0], Index.first(()))
                self.lines.append(f"if(!{going}) break;")
            self._turn(body, body.inputs, [])

    def _scan(self, item: Item, node: Node) -> None:
        (body,) = node.blocks
        turn, *carried = body.inputs
        self._carry(item, node.inputs, node.outputs[: len(carried)], carried)
        length, name = node.parameters["length"], self.name("j")
        collected = []
        for result, row in zip(
            node.outputs[len(carried) :], body.outputs[len(carried) :], strict=True
        ):
            if result.size:
                buffer = self.places[result] = self.buffer(result)
                collected.append((row, Target(buffer, first=times(name, row.size))))
        self.places[turn] = [name]
        head = f"TURNS for(int {name}=0;{name}<{length};{name}++) {{"
        if node.parameters["reverse"]:
            head = f"TURNS for(int {name}={length - 1};{name}>=0;{name}--) {{"
        with self._looped(head):
            self._turn(body, carried, collected)

    @contextlib.contextmanager
    def _looped(self, head: str) -> Iterator[None]:
        if not head.startswith("else"):
            self.wait()
        self.unread, self.read_since = set(), False
        self.time += 1
        start = self.time
        self.lines.append(head)
        yield
        self.wait()
        self.lines.append("}")
        self.time += 1
        self.loops.append((start, self.time))
        self.read_since = True

    def _cond(self, node: Node) -> None:
        targets = []
        for result in node.outputs:
            if not result.size:
                continue
            if self.forms[result] is Form.UNIFORM:
                zero = literal(np.zeros((), result.dtype)[()], result.dtype)
                self.declare(result, [zero] * result.size, constant=False)
            else:
                self.places[result] = self.buffer(result)
            targets.append(result)
        with self.work():
            chosen = self.name("c")
            index = self.read(node.inputs[0], Index.first(()))
            self.lines.append(f"const int {chosen}={index};")
        self.wait()
        last = len(node.blocks) - 1
        for number, block in enumerate(node.blocks):
            test = f"if({chosen}>={number})" if number == last else f"if({chosen}<={number})"
            with self._looped(f"{'else ' if number else ''}{test} {{"):
                stores = [
                    (value, Target(self.places[result]))
                    for value, result in zip(block.outputs, node.outputs, strict=True)
                    if isinstance(self.places.get(result), Buffer)
                ]
                kept = [
                    value
                    for value, result in zip(block.outputs, node.outputs, strict=True)
                    if isinstance(self.places.get(result), list)
                ]
                self._block(block, stores, kept)
                with self.work():
                    for value, result in zip(block.outputs, node.outputs, strict=True):
                        names = self.places.get(result)
                        if isinstance(names, list):
                            for k, name in enumerate(names):
                                entry = self.read(value, Index(value.shape, flat=k))
                                self.lines.append(f"{name}={entry};")

    def _base(self, item: Item, node: Node, *, busy: bool) -> Buffer:
        """The buffer of an array of which a part is changed: its own, or a copy."""
        base, result = node.inputs[0], node.outputs[0]
        buffer = None if busy else self._may_overwrite(base, item)
        if buffer is None:
            buffer = self.buffer(result)
            self._store([(base, Target(buffer))])
        else:
            buffer.tenants.append(result)
        return buffer

    def _update(self, item: Item, node: Node) -> None:
        base, update, *starts = node.inputs
        busy = self.forms[update] is not Form.UNIFORM and base in self.forms.roots([update])
        buffer = self._base(item, node, busy=busy)
        if not update.size:
            self.places[node.outputs[0]] = buffer
            return
        with self.work([buffer]) as lines:
            begins = starts_of(starts, base.shape, update.shape, self.read)
            index = Index(update.shape, flat="i" if update.size > 1 else 0)
            at = [plus(a, b) for a, b in zip(begins, index.coordinates, strict=True)]
            place = Index(base.shape, coordinates=at).flat
            lines.append(f"LANES(i,{update.size}) {{" if update.size > 1 else "ONCE {")
            lines.append(f"{buffer.name}[{place}]={self.read(update, index)};")
            lines.append("}")
        self.places[node.outputs[0]] = buffer

    def _scatter(self, item: Item, node: Node) -> None:
        """Changes here and there, one after the other."""
        base, indices, updates = node.inputs
        text = SCATTERED.get(node.name)
        if text is None:
            raise CannotTranslate(f"kernels have no rule for {node.name}")
        numbers = node.parameters["dimension_numbers"]
        busy = base in self.forms.roots([indices, updates])
        buffer = self._base(item, node, busy=busy)
        with self.work([buffer]) as lines:
            turn = self.name("j")
            lines.append(f"ONCE TURNS for(int {turn}=0;{turn}<{updates.size};{turn}++) {{")
            index = Index(updates.shape, flat=turn)
            batch = [
                x
                for axis, x in enumerate(index.coordinates)
                if axis not in numbers.update_window_dims
            ]
            window = [index.coordinates[axis] for axis in numbers.update_window_dims]
            at: list[Number] = [0] * len(base.shape)
            left_out = {*numbers.inserted_window_dims, *numbers.operand_batching_dims}
            for axis in range(len(base.shape)):
                if axis not in left_out:
                    at[axis] = window.pop(0)
            for axis, source in zip(
                numbers.operand_batching_dims, numbers.scatter_indices_batching_dims, strict=True
            ):
                at[axis] = batch[source]
            inside = []
            for number, axis in enumerate(numbers.scatter_dims_to_operand_dims):
                start = self.read(indices, Index(indices.shape, coordinates=[*batch, number]))
                inside.append(f"unsigned({start})<{base.shape[axis]}u")
                at[axis] = plus(at[axis], start)
            place = Index(base.shape, coordinates=at).flat
            change = text.format(f"{buffer.name}[{place}]", self.read(updates, index))
            lines.append(f"if({'&&'.join(inside)}) {change}" if inside else change)
            lines.append("}")
        self.places[node.outputs[0]] = buffer


def is_reduction(node: Node) -> bool:
    """Tell whether an operation makes one entry of several."""
    return node.name.startswith("reduce_")


def _same_place(value: Value, index: Index) -> Index:
    """The same place in an operand; on an axis of one, that one stands for all."""
    if value.shape == index.shape:
        return index
    if value.size == 1:
        return Index.first(value.shape)
    at = [0 if size == 1 else x for x, size in zip(index.coordinates, value.shape, strict=True)]
    return Index(value.shape, coordinates=at)


def _beside(value: Value, axes: Sequence[int], index: Index, inner: Sequence[Number]) -> Index:
    """The place of one of the entries that go into a result."""
    kept, reduced, at = iter(index.coordinates), iter(inner), []
    for axis in range(len(value.shape)):
        at.append(next(reduced) if axis in axes else next(kept))
    return Index(value.shape, coordinates=at)


def _chosen(names: Sequence[str], at: Number) -> str:
    if isinstance(at, int):
        return names[at]
    chain = names[-1]
    for number, name in reversed(list(enumerate(names[:-1]))):
        chain = f"({at}=={number}?{name}:{chain})"
    return chain


def _combined(node: Node, a: str, b: str) -> str:
    return {
        "reduce_sum": f"({a}+{b})",
        "reduce_max": f"larger({a},{b})",
        "reduce_min": f"smaller({a},{b})",
        "reduce_or": f"({a}|{b})",
        "reduce_and": f"({a}&{b})",
    }[node.name]


def _nothing(node: Node) -> str:
    """What a reduction starts from."""
    dtype = node.outputs[0].dtype
    if node.name == "reduce_sum":
        return "0"
    if node.name in ("reduce_or", "reduce_and"):
        return "false" if node.name == "reduce_or" else "true"
    least = node.name == "reduce_max"
    if np.issubdtype(dtype, np.floating):
        return "(-INFINITE)" if least else "INFINITE"
    info = np.iinfo(dtype)
    return literal(info.min if least else info.max, dtype)
