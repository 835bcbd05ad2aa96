"""Sizes that are dragged or typed at a handle."""

import pytest

from editor.documents.commands.sizes import extent
from tests.editor.core.helpers import Hand, a_level, a_session, texts

LONE = a_level().replace(bodies=a_level().bodies[:1], joints=(), thrusters=())


@pytest.fixture
def lone():
    session = a_session(LONE)
    session.selection = (1,)
    return session, Hand(session)


def sides(session):
    shape = session.document.level.body(1).shape
    return [extent(shape, 0), extent(shape, 1)]


@pytest.mark.parametrize(
    ("at", "to"), [((2.2, 2.2), (2.4, 2.4)), ((2.2, 2.2), (2.4, 2.2)), ((2.2, 2.0), (2.4, 2.0))]
)
def test_a_typed_size_holds_with_shift(lone, at, to):
    session, hand = lone
    hand.press(at)
    hand.hold(to, shift=True)
    hand.type("0.2")
    hand.release(to, shift=True)
    assert sides(session) == pytest.approx([0.2, 0.2], abs=1e-5)


def test_two_typed_sizes_hold_with_shift(lone):
    session, hand = lone
    hand.press((2.2, 2.2))
    hand.hold((2.4, 2.4), shift=True)
    hand.type("0.2x0.3")
    hand.release((2.4, 2.4), shift=True)
    assert sides(session) == pytest.approx([0.2, 0.3], abs=1e-5)


def test_a_drag_through_the_opposite_corner_stops_at_a_size_that_is_kept(lone):
    session, hand = lone
    hand.drag((2.2, 2.2), (1.0, 1.0))
    assert sides(session) == pytest.approx([0.02, 0.02], abs=1e-5)
    assert texts(session) == []


def test_a_group_shrinks_as_far_as_its_smallest_shape():
    session = a_session()
    session.selection = (3, 4)
    hand = Hand(session)
    hand.drag((4.2, 2.8), (0.5, 4.9))
    radii = [session.document.level.body(each).shape.radius for each in (3, 4)]
    assert radii == pytest.approx([0.02, 0.02], abs=1e-5)
    assert texts(session) == []
