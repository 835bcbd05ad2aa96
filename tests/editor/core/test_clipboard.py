"""Cut and Duplicate take shapes, with the joints and thrusters on them."""

import pytest

from editor.documents.commands import clip
from tests.editor.core.helpers import texts


def test_cut_leaves_what_is_not_put_on_the_clipboard(session, hand):
    session.selection = (3, 5, 6)
    hand.key("x", ctrl=True)
    assert [entity.id for entity in session.document.level.entities()] == [1, 2, 4, 5, 6]
    assert [body.id for body in clip.loads(session.clipboard.get()).bodies] == [3]
    assert (
        texts(session)[-1] == "2 items were kept: they are attached to something that was not cut."
    )
    hand.key("z", ctrl=True)
    session.selection = (1, 2, 5, 6)
    told = len(texts(session))
    hand.key("x", ctrl=True)
    assert [entity.id for entity in session.document.level.entities()] == [3, 4]
    assert len(texts(session)) == told
    hand.key("v", ctrl=True)
    assert len(list(session.document.level.entities())) == 6


def test_cut_says_which_joints_go_with_the_shapes(session, hand):
    session.selection = (2,)
    hand.key("x", ctrl=True)
    assert [entity.id for entity in session.document.level.entities()] == [1, 3, 4, 6]
    assert not clip.loads(session.clipboard.get()).joints
    assert texts(session)[-1] == "1 joint is gone: it led to what was not cut."


@pytest.mark.parametrize("chosen", [(5,), (6,), ("floor",)])
def test_what_cannot_be_duplicated_says_so(session, hand, chosen):
    session.selection = chosen
    hand.key("d", ctrl=True)
    assert texts(session) == ["Only shapes can be duplicated, with their joints and thrusters."]
