"""The text while it is written: names, what lies where, and when lanes wait for each other."""

import collections
import contextlib
from collections.abc import Iterable, Iterator, Sequence
from typing import Any, Final

import numpy as np

from kinetix.engine.native.allocation import Span
from kinetix.engine.native.buffers import Buffer, Place, Target, chosen
from kinetix.engine.native.elementwise import ELEMENTWISE, c_type, literal
from kinetix.engine.native.flat_index import Index, Number
from kinetix.engine.native.indexing import FREE, LOOKED_UP
from kinetix.engine.native.ir import Block, CannotTranslate, Value
from kinetix.engine.native.storage import Form, Forms

NEVER: Final = 1 << 60
"""A time after all others."""


class Misplaced(Exception):
    """Something is read at another place than the one at which it is being computed."""


class Pen:
    """Writes lines, and knows what the lanes read and wrote since they last waited."""

    def __init__(self, program: Block) -> None:
        self.forms = Forms(program)
        self.lines: list[str] = []
        self.places: dict[Value, Place] = {}
        self.buffers: list[Buffer] = []
        self.loops: list[tuple[int, int]] = []
        """Start and end of each."""
        self.tables: dict[Any, str] = {}
        """Names of constant arrays."""
        self.constants: list[str] = []
        self.time = 0
        # Of the loop over lanes that is being written.
        self.temporaries: dict[Value, str] = {}
        self.loaded: dict[tuple[str, Number], str] | None = None
        self.seen: set[tuple[Value, Number]] = set()
        """Loads from memory, as (value, flat index)."""
        self.read_now: set[Buffer] = set()
        # Since lanes last waited for each other.
        self.unread: set[Buffer] = set()
        self.read_since = False
        self._written: set[Buffer] = set()
        self._number = 0
        self._guards = 0

    def name(self, letter: str) -> str:
        """Return a new name."""
        self._number += 1
        return f"{letter}{self._number}"

    def buffer(self, value: Value, home: Block) -> Buffer:
        """Return the memory for a value; where it lies is decided in the end."""
        span = Span(value.size * value.dtype.itemsize, self.time, self.time)
        buffer = Buffer(self.name("m"), value.dtype, home, span, [value])
        self.buffers.append(buffer)
        return buffer

    def declare(self, value: Value, entries: Sequence[str], *, changes: bool = False) -> None:
        """Keep a value in registers."""
        kind = f"{'' if changes else 'const '}{c_type(value.dtype)}"
        names = []
        for entry in entries:
            names.append(self.name("r"))
            self.lines.append(f"{kind} {names[-1]}={entry};")
        self.places[value] = names

    def wait(self) -> None:
        """Have the lanes wait for each other, if any has written or read."""
        if self.unread or self.read_since:
            self.lines.append("SYNC")
        self.unread, self.read_since = set(), False

    @contextlib.contextmanager
    def work(self, writes: Iterable[Place] = ()) -> Iterator[list[str]]:
        """Write a piece of text of which is known what memory it reads and writes.

        Args:
            writes: Places; `mark_written` adds more until it ends.
        """
        self.time += 1
        outer, self.lines, self.read_now = self.lines, [], set()
        self._written = written = {place for place in writes if isinstance(place, Buffer)}
        try:
            yield self.lines
        finally:
            text, self.lines = self.lines, outer
        if self.read_now & self.unread or (written and self.read_since):
            self.wait()
        self.lines.extend(text)
        self.unread |= written
        self.read_since |= bool(self.read_now)
        for buffer in self.read_now | written:
            buffer.span.first = min(buffer.span.first, self.time)
            buffer.span.last = self.time

    def mark_written(self, place: Place) -> None:
        """Note that the text being written writes to a place."""
        if isinstance(place, Buffer):
            self._written.add(place)

    @contextlib.contextmanager
    def braces(self, head: str, *, follows: bool = False) -> Iterator[None]:
        """Write a loop or a branch; what is alive before it and read in it lives until its end.

        Args:
            head: Its first line.
            follows: Whether nothing may stand between it and what is before.
        """
        if not follows:
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

    def entries(self, value: Value) -> list[str]:
        """Return the C of all entries of a small value."""
        return [self.read(value, Index(value.shape, flat=k)) for k in range(value.size)]

    def read(self, value: Value, index: Index) -> str:
        """Return the C of an entry.

        Raises:
            Misplaced: It is being computed by another lane.
        """
        if value.constant is not None:
            return self._constant(value, index)
        if value in self.temporaries:
            if index.flat != "i":
                raise Misplaced
            return self.temporaries[value]
        place = self.places.get(value)
        if place is not None:
            return self._placed(value, place, index)
        if self.forms[value] is not Form.INLINE:
            raise Misplaced
        return self.computed(value, index)

    def computed(self, value: Value, index: Index) -> str:
        """Return the C of an entry by the operation that it comes from."""
        node = value.node
        assert node is not None
        rule = ELEMENTWISE.get(node.name)
        if rule is not None:
            entry = rule(node, [self.read(x, _same_place(x, index)) for x in node.inputs])
            # C computes with whole integers, and numbers of 8 bits would not wrap around.
            is_narrow = value.dtype.kind in "iu" and value.dtype.itemsize == 1
            return f"(({c_type(value.dtype)}){entry})" if is_narrow else entry
        if node.name in FREE:
            return FREE[node.name](node, index, self.read)
        if node.name not in LOOKED_UP:
            raise CannotTranslate(f"kernels have no rule for {node.name}")
        self._guards += 1
        try:
            return LOOKED_UP[node.name](node, index, self.read)
        finally:
            self._guards -= 1

    def _placed(self, value: Value, place: Place, index: Index) -> str:
        if isinstance(place, list):
            return chosen(place, index.flat)
        if isinstance(place, Buffer):
            self.read_now.add(place)
        self.seen.add((value, index.flat))
        text = f"{place.name}[{index.flat}]"
        # Behind a condition there may be nothing to load.
        if self.loaded is None or self._guards:
            return text
        key = place.name, index.flat
        if key not in self.loaded:
            self.loaded[key] = self.name("l")
            self.lines.append(f"const {c_type(value.dtype)} {self.loaded[key]}={text};")
        return self.loaded[key]

    def _constant(self, value: Value, index: Index) -> str:
        assert value.constant is not None
        entries = np.ravel(value.constant)
        if isinstance(index.flat, int):
            return literal(entries[index.flat], value.dtype)
        if (entries == entries[0]).all():
            return literal(entries[0], value.dtype)
        key = value.dtype, entries.tobytes()
        if key not in self.tables:
            name = self.tables[key] = self.name("k")
            text = ",".join(literal(x, value.dtype) for x in entries)
            kind = c_type(value.dtype)
            self.constants.append(f"TABLE({kind}, {name}, {entries.size}) {{{text}}};")
        return f"{self.tables[key]}[{index.flat}]"

    def is_stored(self, source: Value, target: Target) -> bool:
        """Return whether a value lies where it shall go."""
        is_whole = target.shape is None and target.first == 0
        return is_whole and self.places.get(source) is target.place

    def store(self, stores: Sequence[tuple[Value, Target]]) -> None:
        """Store several values together; none of them reads a place that another one overwrites."""
        by_count: dict[int, list[tuple[Value, Target]]] = collections.defaultdict(list)
        for value, target in stores:
            if value.size:
                by_count[value.size].append((value, target))
        for count, some in by_count.items():
            with self.work([target.place for _, target in some]) as lines:
                self.loaded = {}
                lines.append(f"LANES(i,{count}) {{")
                entries = [self.read(value, Index(value.shape, flat="i")) for value, _ in some]
                for entry, (value, target) in zip(entries, some, strict=True):
                    at = target.at(Index(value.shape, flat="i"))
                    lines.append(f"{target.place.name}[{at}]={entry};")
                lines.append("}")
                self.loaded = None


def _same_place(value: Value, index: Index) -> Index:
    """Return the same place in an operand; on an axis of one, that one stands for all."""
    if value.shape == index.shape:
        return index
    if value.size == 1:
        return Index.first(value.shape)
    at = [0 if size == 1 else x for x, size in zip(index.coordinates, value.shape, strict=True)]
    return Index(value.shape, coordinates=at)
