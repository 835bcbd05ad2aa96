"""A function of one world as a list of operations on arrays, read off its jaxpr.

Calls are opened, and what the engine does for a batch of worlds (`engine/batch/`) is traced for
one. Loops and conditionals keep blocks of their own; what these take from outside they name.
"""

import dataclasses
from collections.abc import Callable, Sequence
from typing import Any, Final

import jax
import numpy as np
from jax.extend import core as jex

from kinetix.engine.native.ir import Block, Node, Value
from kinetix.engine.native.lowering import REWRITTEN


def program(function: Callable[..., Any], arguments: Sequence[jax.ShapeDtypeStruct]) -> Block:
    """Trace a function of arrays.

    Args:
        function: From arrays to any pytree of arrays.
        arguments: Their shapes and types.

    Returns:
        Operations of the program; dead ones are left out.
    """
    closed = jax.make_jaxpr(function)(*arguments)
    inputs = [_like(x.aval) for x in closed.jaxpr.invars]
    block = Block(inputs)
    _Reader(block).read(closed, inputs)
    _without_dead(block)
    return block


def _like(aval: Any) -> Value:
    return Value(tuple(aval.shape), np.dtype(aval.dtype))


class _Reader:
    """Reads jaxprs into one block."""

    def __init__(self, block: Block) -> None:
        self.block = block

    def read(self, closed: Any, arguments: Sequence[Value]) -> list[Value]:
        """Read a closed jaxpr into the block; its results become the block's outputs."""
        known: dict[Any, Value] = {}
        constants = [
            Value(np.shape(x), np.asarray(x).dtype, constant=np.asarray(x)) for x in closed.consts
        ]
        known.update(zip(closed.jaxpr.constvars, constants, strict=True))
        known.update(zip(closed.jaxpr.invars, arguments, strict=True))

        def value(atom: Any) -> Value:
            if not isinstance(atom, jex.Literal):
                return known[atom]
            like = _like(atom.aval)
            return dataclasses.replace(like, constant=np.asarray(atom.val, like.dtype))

        for equation in closed.jaxpr.eqns:
            inputs = [value(x) for x in equation.invars]
            results = self._read_one(equation, inputs)
            known.update(zip(equation.outvars, results, strict=True))
        self.block.outputs = [value(x) for x in closed.jaxpr.outvars]
        return self.block.outputs

    def add(self, name: str, inputs: list[Value], results: list[Value], **parameters: Any) -> Node:
        """Add an operation."""
        node = Node(name, inputs, results, parameters)
        for result in results:
            result.node = node
        self.block.nodes.append(node)
        return node

    def _read_one(self, equation: Any, inputs: list[Value]) -> list[Value]:
        name, parameters = equation.primitive.name, equation.params
        opened = OPENED.get(name)
        if opened is not None:
            return self.read(opened(equation), inputs)
        if name in SAME or (
            name == "convert_element_type" and inputs[0].dtype == parameters["new_dtype"]
        ):
            return inputs
        results = [_like(x.aval) for x in equation.outvars]
        rule = BLOCKS.get(name) or REWRITTEN.get(name)
        if rule is not None:
            rule(self, inputs, results, parameters)
        else:
            self.add(name, inputs, results, **parameters)
        return results


def _nested(closed: Any, arguments: Sequence[Value], inputs: list[Value]) -> Block:
    """The block of a loop or branch; `inputs` are those of the arguments that are its own."""
    block = Block(inputs)
    _Reader(block).read(closed, arguments)
    return block


def _while(
    reader: _Reader, inputs: list[Value], results: list[Value], parameters: dict[str, Any]
) -> None:
    conditions, constants = parameters["cond_nconsts"], parameters["body_nconsts"]
    start = inputs[conditions + constants :]
    node = reader.add("while", start, results)
    for closed, given in (
        (parameters["cond_jaxpr"], inputs[:conditions]),
        (parameters["body_jaxpr"], inputs[conditions : conditions + constants]),
    ):
        carry = [Value(x.shape, x.dtype) for x in results]
        node.blocks.append(_nested(closed, [*given, *carry], carry))


def _scan(
    reader: _Reader, inputs: list[Value], results: list[Value], parameters: dict[str, Any]
) -> None:
    constants, carried = _scan_parts(parameters)
    given, start = inputs[:constants], inputs[constants : constants + carried]
    node = reader.add(
        "scan", start, results, length=parameters["length"], reverse=parameters["reverse"]
    )
    carry = [Value(x.shape, x.dtype) for x in results[:carried]]
    turn = Value((), np.dtype(np.int32))
    body = Block([turn, *carry])
    inner = _Reader(body)
    rows = []
    for table in inputs[constants + carried :]:
        row = Value(table.shape[1:], table.dtype)
        inner.add("row", [table, turn], [row])
        rows.append(row)
    inner.read(parameters["jaxpr"], [*given, *carry, *rows])
    node.blocks.append(body)


def _scan_parts(parameters: dict[str, Any]) -> tuple[int, int]:
    """Count a scan's constants and what it carries; JAX 0.11 stores them in another way."""
    if "ft_in" in parameters:
        constants, carried, _ = parameters["ft_in"].unpack()
        return len(constants), len(carried)
    return parameters["num_consts"], parameters["num_carry"]


def _cond(
    reader: _Reader, inputs: list[Value], results: list[Value], parameters: dict[str, Any]
) -> None:
    node = reader.add("cond", inputs[:1], results)
    node.blocks = [_nested(branch, inputs[1:], []) for branch in parameters["branches"]]


def _worlds(equation: Any) -> Any:
    """Return the kernel of a batch, of one world."""
    shapes = [jax.ShapeDtypeStruct(x.aval.shape, x.aval.dtype) for x in equation.invars]
    return jax.make_jaxpr(equation.params["program"].whole)(*shapes)


OPENED: Final[dict[str, Callable[[Any], Any]]] = {
    "jit": lambda equation: equation.params["jaxpr"],
    "closed_call": lambda equation: equation.params["call_jaxpr"],
    "custom_jvp_call": lambda equation: equation.params["call_jaxpr"],
    "custom_vjp_call": lambda equation: equation.params["call_jaxpr"],
    "custom_vmap_call": lambda equation: equation.params["call"],
    "worlds": _worlds,
}
"""Operations that stand for others."""

SAME: Final = ("stop_gradient", "copy", "optimization_barrier")
"""Operations whose results are their arguments."""

BLOCKS: Final[dict[str, Callable[..., None]]] = {"while": _while, "scan": _scan, "cond": _cond}
"""Operations with blocks of their own."""


def _without_dead(block: Block, wanted: set[Value] | None = None) -> set[Value]:
    """Eliminate dead operations; returns all values that are read."""
    read = set() if wanted is None else wanted
    read.update(block.outputs)
    kept = []
    for node in reversed(block.nodes):
        if not any(result in read and result.size for result in node.outputs):
            continue
        for nested in node.blocks:
            _without_dead(nested, read)
        read.update(node.inputs)
        kept.append(node)
    block.nodes = kept[::-1]
    return read
