"""A locked shape holds the shapes that are jointed to it."""

from editor import actions
from tests.editor.core.helpers import texts


def test_a_nudge_of_a_locked_shape_moves_nothing_that_hangs_on_it(session, hand):
    session.selection = (1,)
    actions.run(session, "edit.lock")
    before = session.document.level
    hand.key("right")
    assert session.document.level == before
    assert texts(session) == ["What is selected is locked: unlock it first."]


def test_what_hangs_on_a_locked_shape_stays_while_others_move(session, hand):
    session.document.locked = frozenset({1})
    session.selection = (1, 3)
    before = session.document.level
    hand.drag((4.0, 3.0), (4.5, 3.2))
    hand.key("right")
    after = session.document.level
    assert [b.id for b, old in zip(after.bodies, before.bodies, strict=True) if b != old] == [3]
    assert texts(session) == ["1 locked thing stays as it is."]


def test_undo_selects_nothing_that_is_hidden(session, hand):
    session.selection = (3, 4)
    hand.key("right")
    session.time += 5.0
    hand.key("right")
    session.selection = (3,)
    hand.key("h", ctrl=True)
    hand.key("z", ctrl=True)
    assert session.selection == (4,)
    hand.key("z", ctrl=True, shift=True)
    assert 3 not in session.selection


def test_the_arena_cannot_be_hidden(session, hand):
    session.selection = ("floor",)
    hand.key("h", ctrl=True)
    assert session.document.hidden == frozenset() and session.selection == ("floor",)
    assert texts(session) == ["Floor, walls and ceiling cannot be hidden."]
    session.selection = ("floor", 3)
    hand.key("h", ctrl=True)
    assert session.document.hidden == {3}
