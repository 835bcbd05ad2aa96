"""Pair lists and the collision filter."""

import itertools

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from kinetix.engine.pairs import candidate_pairs, collision_matrix, pair_counts
from kinetix.engine.spec import Capacity, SceneSpec


@pytest.mark.parametrize(
    ("sizes", "counts"), [((5, 2), (4, 10, 1)), ((6, 3), (9, 18, 3)), ((12, 4), (60, 48, 6))]
)
def test_counts_are_those_of_the_published_sizes(sizes, counts):
    capacity = Capacity(polygons=sizes[0], circles=sizes[1], joints=0, thrusters=0)
    assert pair_counts(capacity) == counts
    assert len(candidate_pairs(capacity)) == sum(counts)


def test_every_pair_but_those_of_the_arena_stands_once():
    capacity = Capacity(polygons=7, circles=3, joints=0, thrusters=0)
    seen = {tuple(sorted(pair)) for pair in candidate_pairs(capacity).tolist()}
    arena = set(itertools.combinations(range(4), 2))
    assert seen == set(itertools.combinations(range(10), 2)) - arena
    assert len(seen) == len(candidate_pairs(capacity))


@settings(max_examples=50, deadline=None)
@given(st.lists(st.tuples(st.integers(0, 8), st.integers(0, 8), st.booleans()), max_size=8))
def test_the_matrix_separates_components(joints):
    a, b = (np.array([joint[k] for joint in joints], dtype=int) for k in (0, 1))
    active = np.array([joint[2] for joint in joints], dtype=bool)
    matrix = collision_matrix(9, a, b, active)
    reach = np.eye(9, dtype=bool)
    for first, second, on in joints:
        if on:
            reach[first, second] = reach[second, first] = True
    for _ in range(9):
        reach = reach @ reach
    assert (matrix == ~reach).all()


def test_capacities_compare_and_hash():
    small = Capacity(polygons=5, circles=2, joints=1, thrusters=1)
    large = Capacity(polygons=12, circles=4, joints=6, thrusters=2)
    assert large.covers(small)
    assert not small.covers(large)
    assert small.union(large) == large
    assert hash(SceneSpec(capacity=small)) == hash(SceneSpec(capacity=small))
