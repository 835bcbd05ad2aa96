"""Changes of a part of an array, in place where nobody needs what was there."""

from typing import TYPE_CHECKING, Final

from kinetix.engine.native.buffers import Buffer, Target
from kinetix.engine.native.dependencies import Item
from kinetix.engine.native.flat_index import Index, Number, plus
from kinetix.engine.native.indexing import Read, starts_of, window_place
from kinetix.engine.native.ir import CannotTranslate, Node
from kinetix.engine.native.storage import Form

if TYPE_CHECKING:
    from kinetix.engine.native.schedule import BlockWriter

SCATTERED: Final = {
    "scatter": "{0}={1};",
    "scatter-add": "{0}+={1};",
    "scatter_add": "{0}+={1};",
}
"""By primitive: what becomes of an entry that a change goes to."""


def updated(node: Node, index: Index, read: Read) -> str:
    """Return an entry of a small array of which a part was replaced."""
    base, update, *starts = node.inputs
    begins = starts_of(starts, base.shape, update.shape, read)
    inside: list[str] = []
    at: list[Number] = []
    for here, begin, size, extent in zip(
        index.coordinates, begins, update.shape, base.shape, strict=True
    ):
        if size == extent:
            at.append(here)
            continue
        place = f"({here}-{begin})"
        inside.append(f"unsigned{place}<{size}u")
        at.append(place if size > 1 else 0)
    new = read(update, Index(update.shape, coordinates=at))
    return f"({'&&'.join(inside)}?{new}:{read(base, index)})" if inside else new


def update(writer: "BlockWriter", item: Item, node: Node) -> None:
    """Replace a part."""
    pen = writer.pen
    base, new, *starts = node.inputs
    is_small = pen.forms[new] is Form.UNIFORM
    buffer = _own(writer, item, node, busy=not is_small and base in pen.forms.roots([new]))
    pen.places[node.outputs[0]] = buffer
    if not new.size:
        return
    with pen.work([buffer]) as lines:
        begins = starts_of(starts, base.shape, new.shape, pen.read)
        index = Index(new.shape, flat="i" if new.size > 1 else 0)
        at = [plus(a, b) for a, b in zip(begins, index.coordinates, strict=True)]
        place = Index(base.shape, coordinates=at).flat
        lines.append(f"LANES(i,{new.size}) {{" if new.size > 1 else "ONCE {")
        lines.append(f"{buffer.name}[{place}]={pen.read(new, index)};")
        lines.append("}")


def scatter(writer: "BlockWriter", item: Item, node: Node) -> None:
    """Change entries here and there, one after the other.

    Raises:
        CannotTranslate: There is no rule for this kind of change.
    """
    pen, change = writer.pen, SCATTERED.get(node.name)
    if change is None:
        raise CannotTranslate(f"kernels have no rule for {node.name}")
    base, indices, updates = node.inputs
    buffer = _own(writer, item, node, busy=base in pen.forms.roots([indices, updates]))
    with pen.work([buffer]) as lines:
        turn = pen.name("j")
        lines.append(f"ONCE TURNS for(int {turn}=0;{turn}<{updates.size};{turn}++) {{")
        place, inside = _scattered_to(node, Index(updates.shape, flat=turn), pen.read)
        entry = pen.read(updates, Index(updates.shape, flat=turn))
        lines.append(f"if({inside}) " + change.format(f"{buffer.name}[{place}]", entry))
        lines.append("}")
    pen.places[node.outputs[0]] = buffer


def _scattered_to(node: Node, index: Index, read: Read) -> tuple[Number, str]:
    """Return the index of a change, and the condition that it is in the array."""
    base, indices, _ = node.inputs
    numbers = node.parameters["dimension_numbers"]
    at, batch = window_place(
        index,
        len(base.shape),
        numbers.update_window_dims,
        numbers.inserted_window_dims,
        numbers.operand_batching_dims,
        numbers.scatter_indices_batching_dims,
    )
    inside = ["true"]
    for number, axis in enumerate(numbers.scatter_dims_to_operand_dims):
        start = read(indices, Index(indices.shape, coordinates=[*batch, number]))
        inside.append(f"unsigned({start})<{base.shape[axis]}u")
        at[axis] = plus(at[axis], start)
    return Index(base.shape, coordinates=at).flat, "&&".join(inside)


def _own(writer: "BlockWriter", item: Item, node: Node, *, busy: bool) -> Buffer:
    """Return the buffer of an array of which a part is changed: its own, or that of a copy."""
    base, result = node.inputs[0], node.outputs[0]
    buffer = None if busy else writer.to_overwrite(base, item)
    if buffer is not None:
        buffer.tenants.append(result)
        return buffer
    buffer = writer.pen.buffer(result, writer.block)
    writer.pen.store([(base, Target(buffer))])
    return buffer
