"""Numbers as people type them: `2*3`, `1,5`, `pi/4`, `sqrt(2)`, and changes such as `+=0.5`."""

import ast
import dataclasses
import math
import operator
from collections.abc import Callable
from typing import Final

from kinetix.errors import CommandError

_LONGEST: Final = 200
_LARGEST_POWER: Final = 64.0
_NAMES: Final = {"pi": math.pi, "tau": math.tau, "e": math.e}
_FUNCTIONS: Final[dict[str, Callable[[float], float]]] = {
    "sqrt": math.sqrt,
    "sin": lambda degrees: math.sin(math.radians(degrees)),
    "cos": lambda degrees: math.cos(math.radians(degrees)),
    "tan": lambda degrees: math.tan(math.radians(degrees)),
    "abs": abs,
    "round": lambda value: float(round(value)),
}
"""Angles are in degrees."""


def _power(base: float, exponent: float) -> float:
    if abs(exponent) > _LARGEST_POWER:
        raise OverflowError
    return base**exponent


_OPERATORS: Final[dict[type[ast.operator], Callable[[float, float], float]]] = {
    ast.Add: operator.add,
    ast.Sub: operator.sub,
    ast.Mult: operator.mul,
    ast.Div: operator.truediv,
    ast.Mod: operator.mod,
    ast.Pow: _power,
}
_OTHER_UNITS: Final[dict[str, dict[str, float]]] = {
    "m": {"cm": 0.01, "mm": 0.001},
    "°": {"rad": 180.0 / math.pi},
    "rad": {"°": math.pi / 180.0},
}
"""By a field's unit: the others that it takes, each in the field's own; also per second."""
_CHANGES: Final[dict[str, Callable[[float, float], float]]] = {
    "+": operator.add,
    "-": operator.sub,
    "*": operator.mul,
    "/": operator.truediv,
}


@dataclasses.dataclass(frozen=True, kw_only=True)
class Change:
    """Input of a numeric field: a value, or a change of the present one."""

    amount: float
    operator: str = ""
    """`+`, `-`, `*` or `/`; empty: the amount replaces the value."""

    @property
    def relative(self) -> bool:
        """True if it starts from the present value."""
        return bool(self.operator)

    def of(self, value: float) -> float:
        """Return the value after the change."""
        return _CHANGES[self.operator](value, self.amount) if self.operator else self.amount

    def scaled(self, factor: float) -> "Change":
        """Return the same change in a unit of which `factor` make one of the typed unit."""
        if self.operator in ("*", "/"):
            return self
        return dataclasses.replace(self, amount=self.amount * factor)

    def __str__(self) -> str:
        """Write it as it is typed."""
        return f"{self.operator}={self.amount:g}" if self.operator else f"{self.amount:g}"


def parse(text: str, unit: str = "") -> Change:
    """Read what was typed into a number's field.

    Args:
        text: A sum such as `2*3`, or a change such as `+=0.5` or `*=2`.
        unit: The field's unit, which may stand behind it, as another of its kind may (`20 cm`).

    Raises:
        CommandError: The text is neither a number nor a calculation.
    """
    words = text.strip()
    head, slash, per = unit.partition("/")
    known = {f"{other}{slash}{per}": size for other, size in _OTHER_UNITS.get(head, {}).items()}
    typed = next((each for each in (*known, unit) if words.endswith(each)), "")
    words = words.removesuffix(typed).strip()
    sign = words[0] if words[1:2] == "=" and words[0] in _CHANGES else ""
    change = Change(amount=_value(words[2:] if sign else words, text), operator=sign)
    if sign == "/" and change.amount == 0.0:
        raise _refused(text)
    return change.scaled(known.get(typed, 1.0))


def _value(words: str, text: str) -> float:
    for typed, meant in (("×", "*"), ("÷", "/"), ("−", "-"), ("^", "**"), (",", ".")):
        words = words.replace(typed, meant)
    try:
        if len(words) > _LONGEST:
            raise _refused(text)
        value = float(_evaluated(ast.parse(words.strip(), mode="eval").body, text))
    except (SyntaxError, ValueError, ArithmeticError, RecursionError, MemoryError, TypeError):
        raise _refused(text) from None
    if not math.isfinite(value):
        raise _refused(text)
    return value


def _evaluated(node: ast.expr, text: str) -> float:
    match node:
        case ast.Constant(value=int() | float() as value) if not isinstance(value, bool):
            return float(value)
        case ast.Name(id=name) if name in _NAMES:
            return _NAMES[name]
        case ast.UnaryOp(op=ast.USub(), operand=operand):
            return -_evaluated(operand, text)
        case ast.UnaryOp(op=ast.UAdd(), operand=operand):
            return _evaluated(operand, text)
        case ast.BinOp(left=left, op=op, right=right) if type(op) in _OPERATORS:
            return _OPERATORS[type(op)](_evaluated(left, text), _evaluated(right, text))
        case ast.Call(func=ast.Name(id=name), args=[argument], keywords=[]) if name in _FUNCTIONS:
            return _FUNCTIONS[name](_evaluated(argument, text))
        case _:
            raise _refused(text)


def _refused(text: str) -> CommandError:
    return CommandError(
        f"“{text.strip()}” is not a number: type one, a sum such as 2*3, or a change such as +=0.5."
    )
