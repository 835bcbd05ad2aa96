"""Loops and conditionals: what is carried is kept in registers, or changed in place."""

from collections.abc import Callable, Iterator, Sequence
from typing import TYPE_CHECKING, Final

import numpy as np

from kinetix.engine.native.buffers import Buffer, Place, Target
from kinetix.engine.native.dependencies import Item
from kinetix.engine.native.elementwise import c_type, literal
from kinetix.engine.native.emitter import Pen
from kinetix.engine.native.flat_index import Index, times
from kinetix.engine.native.ir import Block, Node, Value
from kinetix.engine.native.storage import Form

if TYPE_CHECKING:
    from kinetix.engine.native.schedule import BlockWriter


def _while(writer: "BlockWriter", item: Item, node: Node) -> None:
    pen, (condition, body) = writer.pen, node.blocks
    _carry(writer, item, node, node.outputs, body.inputs)
    for own, other in zip(body.inputs, condition.inputs, strict=True):
        if own in pen.places:
            _move_in(pen, other, pen.places[own])
    with pen.braces("TURNS for(;;) {"):
        _inner(writer, condition, ends=condition.outputs)
        with pen.work():
            going = pen.read(condition.outputs[0], Index.first(()))
            pen.lines.append(f"if(!{going}) break;")
        _turn(writer, body, body.inputs, [])


def _scan(writer: "BlockWriter", item: Item, node: Node) -> None:
    pen, (body,) = writer.pen, node.blocks
    turn, *carried = body.inputs
    number, length, name = len(carried), node.parameters["length"], pen.name("j")
    _carry(writer, item, node, node.outputs[:number], carried)
    collected = []
    for result, row in zip(node.outputs[number:], body.outputs[number:], strict=True):
        if result.size:
            buffer = pen.places[result] = pen.buffer(result, writer.block)
            collected.append((row, Target(buffer, first=times(name, row.size))))
    pen.places[turn] = [name]
    head = f"TURNS for(int {name}=0;{name}<{length};{name}++) {{"
    if node.parameters["reverse"]:
        head = f"TURNS for(int {name}={length - 1};{name}>=0;{name}--) {{"
    with pen.braces(head):
        _turn(writer, body, carried, collected)


def _cond(writer: "BlockWriter", item: Item, node: Node) -> None:
    del item
    pen = writer.pen
    for result in node.outputs:
        if result.size and pen.forms[result] is Form.UNIFORM:
            zero = literal(np.zeros((), result.dtype)[()], result.dtype)
            pen.declare(result, [zero] * result.size, changes=True)
        elif result.size:
            pen.places[result] = pen.buffer(result, writer.block)
    with pen.work():
        chosen = pen.name("c")
        index = pen.read(node.inputs[0], Index.first(()))
        pen.lines.append(f"const int {chosen}={index};")
    last = len(node.blocks) - 1
    for number, block in enumerate(node.blocks):
        test = f"{chosen}{'>=' if number == last else '<='}{number}"
        head = f"{'else ' if number else ''}if({test}) {{"
        with pen.braces(head, follows=number > 0):
            results = list(zip(block.outputs, node.outputs, strict=True))
            stores = [(value, Target(place)) for value, place in _buffers(pen, results)]
            small = list(_registers(pen, results))
            _inner(writer, block, stores, [value for value, _ in small])
            with pen.work():
                for value, names in small:
                    for name, entry in zip(names, pen.entries(value), strict=True):
                        pen.lines.append(f"{name}={entry};")


CONTROL: Final[dict[str, Callable[["BlockWriter", Item, Node], None]]] = {
    "while": _while,
    "scan": _scan,
    "cond": _cond,
}
"""By primitive."""


def _inner(
    writer: "BlockWriter",
    block: Block,
    stores: Sequence[tuple[Value, Target]] = (),
    ends: Sequence[Value] = (),
) -> None:
    type(writer)(writer.pen, block, stores, ends).write()


def _move_in(pen: Pen, value: Value, place: Place) -> None:
    pen.places[value] = place
    if isinstance(place, Buffer):
        place.tenants.append(value)


def _carry(
    writer: "BlockWriter", item: Item, node: Node, results: Sequence[Value], inner: Sequence[Value]
) -> None:
    """Give what a loop carries its place, with what it starts from."""
    pen, copies, taken = writer.pen, [], set()
    used = set().union(*[pen.forms.used_in(block) for block in node.blocks])
    for start, result, own in zip(node.inputs, results, inner, strict=True):
        if not start.size:
            continue
        if pen.forms[own] is Form.UNIFORM:
            with pen.work():
                pen.declare(own, pen.entries(start), changes=True)
            pen.places[result] = pen.places[own]
            continue
        buffer = writer.to_overwrite(start, item)
        if buffer is None or buffer in taken or used.intersection(buffer.tenants):
            buffer = pen.buffer(own, writer.block)
            copies.append((start, Target(buffer)))
        taken.add(buffer)
        _move_in(pen, own, buffer)
        _move_in(pen, result, buffer)
    pen.store(copies)


def _turn(
    writer: "BlockWriter",
    body: Block,
    carried: Sequence[Value],
    collected: Sequence[tuple[Value, Target]],
) -> None:
    """A loop's body: at its end, what is carried is replaced."""
    pen = writer.pen
    results = [
        (new, own) for own, new in zip(carried, body.outputs, strict=False) if new is not own
    ]
    buffers = [place for own in carried if isinstance(place := pen.places.get(own), Buffer)]
    homes = [buffer.home for buffer in buffers]
    for buffer in buffers:
        buffer.home = body
    stores = [(new, Target(place)) for new, place in _buffers(pen, results)]
    small = list(_registers(pen, results))
    _inner(writer, body, [*collected, *stores], [new for new, _ in small])
    changes = []
    with pen.work():
        for new, names in small:
            for name, entry in zip(names, pen.entries(new), strict=True):
                kept = pen.name("n")
                pen.lines.append(f"const {c_type(new.dtype)} {kept}={entry};")
                changes.append(f"{name}={kept};")
        pen.lines.extend(changes)
    for buffer, home in zip(buffers, homes, strict=True):
        buffer.home = home


def _buffers(pen: Pen, pairs: Sequence[tuple[Value, Value]]) -> Iterator[tuple[Value, Buffer]]:
    """Of pairs of a new value and that whose place it takes: those in memory."""
    for new, old in pairs:
        place = pen.places.get(old)
        if isinstance(place, Buffer):
            yield new, place


def _registers(pen: Pen, pairs: Sequence[tuple[Value, Value]]) -> Iterator[tuple[Value, list[str]]]:
    """The same: those in registers."""
    for new, old in pairs:
        place = pen.places.get(old)
        if isinstance(place, list):
            yield new, place
