"""Writes a program as the body of a C++ function that one world's lanes run together.

What a lane does for all (`UNIFORM`) stands as it is; entries of arrays are done in loops over lanes
(`LANES`), as many in one loop as can be; `SYNC` stands where one lane may read what another wrote.
"""

import dataclasses

from kinetix.engine.native.allocation import placed, prolonged
from kinetix.engine.native.buffers import Buffer, Outside, Target
from kinetix.engine.native.elementwise import c_type
from kinetix.engine.native.emitter import Pen
from kinetix.engine.native.ir import Block, Value
from kinetix.engine.native.schedule import BlockWriter
from kinetix.engine.native.storage import Form


@dataclasses.dataclass(frozen=True)
class BodyText:
    """The text, and what it needs."""

    body: str
    constants: str
    near: int
    """Bytes of memory of a world that its lanes share."""
    far: int
    """The same, for large arrays, of which a world uses a part."""


@dataclasses.dataclass(frozen=True)
class WrittenBody:
    """The text, before it is decided where arrays lie."""

    lines: tuple[str, ...]
    constants: str
    buffers: tuple[Buffer, ...]

    def laid_out(self, largest: int) -> BodyText:
        """Give every array its place.

        Args:
            largest: Array that lies in near memory [bytes].
        """
        sizes, declared = {}, []
        for where, is_here in (("near", True), ("far", False)):
            buffers = [x for x in self.buffers if (x.span.size <= largest) == is_here]
            sizes[where] = placed(buffer.span for buffer in buffers)
            declared.extend(
                f"ARRAY({c_type(x.dtype)}, {x.name}, {where} + {x.span.place})" for x in buffers
            )
        return BodyText("\n".join([*declared, *self.lines]), self.constants, **sizes)


def written(program: Block) -> WrittenBody:
    """Write a program.

    Args:
        program: Of one world.

    Raises:
        CannotTranslate: There is no rule for an operation or a type.
    """
    pen = Pen(program)
    _take_arguments(pen, program)
    stores = [
        (value, Target(Outside(f"out{number}")))
        for number, value in enumerate(program.outputs)
        if value.size
    ]
    BlockWriter(pen, program, stores).write()
    prolonged([buffer.span for buffer in pen.buffers], pen.loops)
    return WrittenBody(tuple(pen.lines), "\n".join(pen.constants), tuple(pen.buffers))


def _take_arguments(pen: Pen, program: Block) -> None:
    """Copy what is read into registers or near memory."""
    used, copies = pen.forms.used_in(program), []
    for number, value in enumerate(program.inputs):
        if value not in used:
            continue
        name = f"in{number}"
        if pen.forms[value] is Form.UNIFORM:
            pen.declare(value, [f"{name}[{k}]" for k in range(value.size)])
            continue
        argument = Value(value.shape, value.dtype)
        pen.places[argument] = Outside(name)
        buffer = pen.places[value] = pen.buffer(value, program)
        copies.append((argument, Target(buffer)))
    pen.store(copies)
