"""Operations entry by entry: a row of the table is the C for one entry."""

from collections.abc import Callable, Sequence
from typing import Any, Final

import numpy as np

from kinetix.engine.native.ir import CannotTranslate, Node

Rule = Callable[[Node, Sequence[str]], str]

C_TYPES: Final = {
    "float32": "float",
    "int8": "signed char",
    "uint8": "unsigned char",
    "int32": "int",
    "uint32": "unsigned",
    "bool": "bool",
}
"""Types that arrays may have."""


def c_type(dtype: np.dtype) -> str:
    """Return the type in C.

    Raises:
        CannotTranslate: The operation has no expression here.
    """
    if dtype.name not in C_TYPES:
        raise CannotTranslate(f"there are no arrays of {dtype.name} in kernels")
    return C_TYPES[dtype.name]


def literal(value: Any, dtype: np.dtype) -> str:
    """Return a number in C, exactly."""
    if dtype.kind == "b":
        return "true" if value else "false"
    if not np.issubdtype(dtype, np.floating):
        return f"({value})" if value >= 0 else f"({value + 1}-1)"
    if np.isnan(value):
        return "NOT_A_NUMBER"
    if np.isinf(value):
        return "INFINITE" if value > 0 else "(-INFINITE)"
    text = f"{float(value)!r}"
    return f"({text}{'f' if dtype.itemsize == 4 else ''})"


def _infix(operator: str) -> Rule:
    return lambda _, x: f"({x[0]}{operator}{x[1]})"


def _call(function: str) -> Rule:
    return lambda _, x: f"{function}({','.join(x)})"


def _is_real(node: Node) -> bool:
    return np.issubdtype(node.inputs[0].dtype, np.floating)


def _divided(node: Node, x: Sequence[str]) -> str:
    return f"({x[0]}/{x[1]})" if _is_real(node) else f"quotient({x[0]},{x[1]})"


def _remainder(node: Node, x: Sequence[str]) -> str:
    return f"{'fmodf' if _is_real(node) else 'remainder_of'}({x[0]},{x[1]})"


def _not(node: Node, x: Sequence[str]) -> str:
    return f"(!{x[0]})" if node.inputs[0].dtype.kind == "b" else f"(~{x[0]})"


def _power(node: Node, x: Sequence[str]) -> str:
    power = node.parameters["y"]
    return f"power<{power}>({x[0]})" if power >= 0 else f"(1/power<{-power}>({x[0]}))"


def _rounded(node: Node, x: Sequence[str]) -> str:
    to_even = int(node.parameters["rounding_method"]) == 1
    return f"{'rintf' if to_even else 'roundf'}({x[0]})"


def _converted(node: Node, x: Sequence[str]) -> str:
    source, target = node.inputs[0].dtype, node.outputs[0].dtype
    if target.kind == "b":
        return f"({x[0]}!=0)"
    if np.issubdtype(source, np.floating) and not np.issubdtype(target, np.floating):
        return f"{c_type(target).replace(' ', '_')}_of({x[0]})"
    return f"(({c_type(target)}){x[0]})"


def _selected(node: Node, x: Sequence[str]) -> str:
    if len(x) == 3:
        return f"({x[0]}?{x[2]}:{x[1]})"
    chain = x[-1]
    for case, expression in reversed(list(enumerate(x[1:-1]))):
        chain = f"({x[0]}=={case}?{expression}:{chain})"
    return chain


ELEMENTWISE: Final[dict[str, Rule]] = {
    "add": _infix("+"),
    "add_any": _infix("+"),
    "sub": _infix("-"),
    "mul": _infix("*"),
    "div": _divided,
    "rem": _remainder,
    "and": _infix("&"),
    "or": _infix("|"),
    "xor": _infix("^"),
    "not": _not,
    "eq": _infix("=="),
    "ne": _infix("!="),
    "lt": _infix("<"),
    "le": _infix("<="),
    "gt": _infix(">"),
    "ge": _infix(">="),
    "max": _call("larger"),
    "min": _call("smaller"),
    "neg": lambda _, x: f"(-{x[0]})",
    "abs": _call("magnitude"),
    "sign": _call("sign_of"),
    "sin": _call("sine"),
    "cos": _call("cosine"),
    "tan": _call("tangent"),
    "tanh": _call("hyperbolic_tangent"),
    "atan2": _call("angle_of"),
    "exp": _call("expf"),
    "log": _call("logf"),
    "sqrt": _call("sqrtf"),
    "rsqrt": lambda _, x: f"(1/sqrtf({x[0]}))",
    "floor": _call("floorf"),
    "ceil": _call("ceilf"),
    "round": _rounded,
    "is_finite": _call("is_finite"),
    "square": lambda _, x: f"power<2>({x[0]})",
    "integer_pow": _power,
    "convert_element_type": _converted,
    "select_n": _selected,
    "clamp": lambda _, x: f"smaller(larger({x[0]},{x[1]}),{x[2]})",
}
"""By primitive: from its operands' entries to that of the result."""
