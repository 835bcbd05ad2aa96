"""Places in arrays, as C, name the entries that numpy finds."""

import re

import numpy as np
from hypothesis import given
from hypothesis import strategies as st

from kinetix.engine.native.flat_index import Index, plus, times

SHAPES = st.lists(st.integers(1, 4), min_size=0, max_size=4)


def value(expression, i):
    """What an expression in C is for one `i`."""
    if isinstance(expression, int):
        return expression
    text = re.sub(r"\b(unsigned|int)\b", "", expression).replace("/", "//")
    return eval(re.sub(r"(\d)u\b", r"\1", text), {"i": i})


@given(SHAPES)
def test_coordinates_of_a_flat_index_are_those_of_the_entry(shape):
    index = Index(shape, flat="i")
    for i in range(int(np.prod(shape))):
        assert [value(x, i) for x in index.coordinates] == list(np.unravel_index(i, shape))


@given(SHAPES)
def test_a_flat_index_comes_back_from_its_coordinates(shape):
    index = Index(shape, coordinates=Index(shape, flat="i").coordinates)
    assert index.flat == ("i" if int(np.prod(shape)) > 1 else 0)


@given(SHAPES, st.randoms())
def test_a_transposed_array_is_read_at_the_right_places(shape, random):
    order = list(range(len(shape)))
    random.shuffle(order)
    table = np.arange(int(np.prod(shape))).reshape(shape)
    turned = table.transpose(order)
    here = Index(turned.shape, flat="i").coordinates
    there = [0] * len(shape)
    for axis, source in enumerate(order):
        there[source] = here[axis]
    flat = Index(shape, coordinates=there).flat
    found = [table.ravel()[value(flat, i)] for i in range(table.size)]
    assert found == turned.ravel().tolist()


@given(SHAPES, SHAPES)
def test_axes_of_one_are_free(shape, ones):
    wide = [*shape, *[1 for _ in ones]]
    index = Index(wide, flat="i").reshaped(shape)
    assert index.flat == "i"
    assert [value(x, 0) for x in index.coordinates] == [0] * len(shape)


def test_sums_and_products_of_numbers_are_numbers():
    assert plus(2, 3) == 5
    assert plus("a", 0) == "a"
    assert times("a", 0) == 0
    assert times("a", 1) == "a"
    assert times(3, 4) == 12
