"""Messages of msgspec about values that do not fit are replaced by plain sentences."""

from typing import Annotated, Literal

import msgspec
import pytest

from kinetix.wording import misfit


class Settings(msgspec.Struct, forbid_unknown_fields=True):
    """A field of each kind."""

    count: int
    share: float | None = None
    tries: Annotated[int, msgspec.Meta(ge=1)] = 1
    pair: tuple[int, int] = (1, 2)
    kind: Literal["x", "y"] = "x"
    names: list[str] = []
    rates: dict[str, float] = {}
    on: bool = False
    short: Annotated[str, msgspec.Meta(max_length=3)] = ""


@pytest.mark.parametrize(
    ("value", "told"),
    [
        ({}, "the field 'count' is missing"),
        ({"count": "s"}, "$.count: expected a whole number, got a string"),
        ({"count": 1.5}, "$.count: expected a whole number, got a fraction"),
        ({"count": 1, "share": "x"}, "$.share: expected a number or nothing, got a string"),
        ({"count": 1, "tries": 0}, "$.tries: expected a number >= 1"),
        ({"count": 1, "pair": [1]}, "$.pair: expected 2 items, got 1"),
        ({"count": 1, "kind": "z"}, "$.kind: 'z' is none of the choices"),
        ({"count": 1, "names": [None]}, "$.names[0]: expected a string, got nothing"),
        ({"count": 1, "rates": {"a": []}}, "$.rates[...]: expected a number, got an array"),
        ({"count": 1, "on": {}}, "$.on: expected true or false, got an object"),
        ({"count": 1, "short": "long"}, "$.short: expected a string of length <= 3"),
        ({"count": 1, "cuont": 2}, "unknown field 'cuont'"),
        ([1], "expected an object, got an array"),
    ],
)
def test_what_does_not_fit_is_told_in_words(value, told):
    with pytest.raises(msgspec.ValidationError) as caught:
        msgspec.convert(value, Settings)
    assert misfit(caught.value) == told


def test_what_others_say_is_left_as_it_is():
    assert misfit(ValueError("no network can be made")) == "no network can be made"
