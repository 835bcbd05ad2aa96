"""Sums in number fields."""

import math

import pytest

from editor.base.arithmetic import parse
from kinetix.errors import CommandError


@pytest.mark.parametrize(
    ("text", "value"),
    [
        ("2*3", 6.0),
        ("1.5", 1.5),
        ("1,5", 1.5),
        ("1,5 + 2,5", 4.0),
        ("1,5*(2+1)", 4.5),
        ("0,5*sqrt(2,25)", 0.75),
        (" -0.25 ", -0.25),
        ("1/4 + 2", 2.25),
        ("2^3", 8.0),
        ("(1+2)*3", 9.0),
        ("pi/2", math.pi / 2),
        ("sqrt(2)", math.sqrt(2)),
        ("cos(60)", 0.5),
        ("30 °", 30.0),
        ("3×2", 6.0),
    ],
)
def test_sums_are_worked_out(text, value):
    change = parse(text, "°")
    assert not change.relative
    assert change.of(17.0) == pytest.approx(value)


@pytest.mark.parametrize(
    ("text", "unit", "value"),
    [
        ("20cm", "m", 0.2),
        ("2,5 mm", "m", 0.0025),
        ("0.2m", "m", 0.2),
        ("+=10*2 cm", "m", 1.2),
        ("*=2 cm", "m", 2.0),
        ("pi/2 rad", "°", 90.0),
        ("90°", "rad", math.pi / 2),
        ("1 rad/s", "°/s", 180 / math.pi),
        ("20 cm/s", "m/s", 0.2),
        ("2", "", 2.0),
    ],
)
def test_other_units_of_the_same_kind_are_taken(text, unit, value):
    assert parse(text, unit).of(1.0) == pytest.approx(value)


@pytest.mark.parametrize(
    ("text", "unit"), [("20cm", ""), ("1 rad", "m"), ("20 cm", "m/s"), ("1,2,3", "m")]
)
def test_units_of_another_kind_are_refused(text, unit):
    with pytest.raises(CommandError, match="is not a number"):
        parse(text, unit)


@pytest.mark.parametrize(
    ("text", "value"), [("+=0.5", 2.5), ("-=1/2", 1.5), ("*=2", 4.0), ("/=4", 0.5), ("*= 1+2", 6.0)]
)
def test_changes_start_from_the_present_value(text, value):
    assert parse(text).of(2.0) == pytest.approx(value)


@pytest.mark.parametrize(
    "text",
    [
        "",
        "abc",
        "2*",
        "1/0",
        "/=0",
        "9**9**9",
        "__import__('os')",
        "(1).real",
        "1e400",
        "True",
        "'a'*3",
        "sqrt(-1)",
        "(" * 300,
        "1+" * 5000 + "1",
    ],
)
def test_anything_else_is_refused_with_a_sentence(text):
    with pytest.raises(CommandError, match="is not a number"):
        parse(text)
