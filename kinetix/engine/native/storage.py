"""Storage of each array of a program: registers, memory, or none.

- UNIFORM: a few numbers that every lane computes for itself and keeps in registers;
- STORED: in the world's memory, its entries computed by the lanes side by side;
- INLINE: computed where it is read: tables read elsewhere, and what is read only once.
"""

import collections
import enum
from collections.abc import Sequence

from kinetix.engine.native.elementwise import ELEMENTWISE
from kinetix.engine.native.indexing import FREE, LOOKED_UP
from kinetix.engine.native.ir import Block, Node, Value, everywhere
from kinetix.engine.native.reducing import REDUCTIONS, UNIFORM_SIZE, is_uniform


class Form(enum.Enum):
    """See above."""

    UNIFORM = enum.auto()
    STORED = enum.auto()
    INLINE = enum.auto()


class Forms:
    """The form of every value of a program."""

    def __init__(self, top: Block) -> None:
        self._home: dict[Node, Block] = {}
        self._uses: dict[Value, list[tuple[Block, Node | None]]] = collections.defaultdict(list)
        self._found: dict[Value, Form] = {}
        self._used: dict[Block, set[Value]] = {}
        for block in everywhere(top):
            for node in block.nodes:
                self._home[node] = block
                for x in node.inputs:
                    self._uses[x].append((block, node))
            for x in block.outputs:
                self._uses[x].append((block, None))

    def __getitem__(self, value: Value) -> Form:
        if value not in self._found:
            self._found[value] = self._form(value)
        return self._found[value]

    def roots(self, values: Sequence[Value]) -> set[Value]:
        """Return the values in registers or memory that some values are computed from."""
        found: set[Value] = set()
        open_ = list(values)
        while open_:
            value = open_.pop()
            if value.constant is not None or not value.size:
                continue
            if self[value] is Form.INLINE:
                assert value.node is not None
                open_.extend(value.node.inputs)
            else:
                found.add(value)
        return found

    def used_in(self, block: Block) -> set[Value]:
        """Return the values in registers or memory that a block reads, nested blocks included."""
        if block not in self._used:
            found = self.roots(block.outputs)
            for node in block.nodes:
                found |= self.roots(node.inputs)
                for nested in node.blocks:
                    found |= self.used_in(nested)
            self._used[block] = found
        return self._used[block]

    def _form(self, value: Value) -> Form:
        node, small = value.node, value.size <= UNIFORM_SIZE
        if value.constant is not None:
            return Form.INLINE
        if node is None:
            return Form.UNIFORM if small else Form.STORED
        if node.name in FREE:
            if not small or all(self._is_known(x) for x in node.inputs):
                return Form.INLINE
            return Form.UNIFORM
        if node.name in ELEMENTWISE or node.name in LOOKED_UP:
            if small:
                return Form.UNIFORM
            return Form.INLINE if self._is_read_once(value) else Form.STORED
        if node.name in REDUCTIONS:
            return Form.UNIFORM if is_uniform(node) else Form.STORED
        if node.name in ("while", "cond", "dynamic_update_slice"):
            return Form.UNIFORM if small else Form.STORED
        if node.name == "scan":
            carried = node.outputs.index(value) < len(node.inputs)
            return Form.UNIFORM if small and carried else Form.STORED
        return Form.STORED

    def _is_known(self, value: Value) -> bool:
        """Return whether reading it costs nothing."""
        if value.constant is not None:
            return True
        if self[value] is Form.INLINE:
            assert value.node is not None
            return all(self._is_known(x) for x in value.node.inputs)
        return self[value] is Form.UNIFORM

    def _is_read_once(self, value: Value) -> bool:
        """Return whether each entry is read at most once, in the block where it is made."""
        assert value.node is not None
        uses = self._uses[value]
        if len(uses) != 1 or uses[0][0] is not self._home[value.node]:
            return False
        reader = uses[0][1]
        if reader is None:
            return True
        result = reader.outputs[0]
        if reader.name in ELEMENTWISE or reader.name == "gather":
            return result.size <= value.size
        if reader.name in FREE:
            if result.size > value.size:
                return False
            return result.size <= UNIFORM_SIZE or self._is_read_once(result)
        if reader.name in REDUCTIONS or reader.name in ("pad", "concatenate"):
            return True
        if reader.name == "dynamic_update_slice":
            return reader.inputs[0] is not value and reader.inputs[1] is value
        return reader.name in ("while", "scan")
