"""The arrow that puts a joint back to its saved place."""

import math

import pytest

from kinetix.level.geometry import referenced_body, to_world
from tests.editor.core.helpers import Hand, a_level


def ends(level):
    joint = level.entity(5)
    return [
        to_world(referenced_body(level, body), anchor)
        for body, anchor in ((joint.a, joint.anchor_a), (joint.b, joint.anchor_b))
    ]


def test_a_joint_that_is_put_back_stays_in_one_piece(make_gui):
    gui = make_gui(level=a_level())
    Hand(gui.session).drag((2.3, 2.05), (2.6, 2.4), alt=True)
    assert gui.level.body(2).position != a_level().body(2).position
    gui.session.selection = (5,)
    gui.frames(4)
    gui.click("reset.anchor_a")
    a, b = ends(gui.level)
    assert math.dist(a, b) < 1e-5
    assert gui.level.entity(5).anchor_a == pytest.approx((0.2, 0.0), abs=1e-5)
    assert gui.session.document.history.undo_label == "Move joint"
    gui.frames(2)
    assert not gui.shows("reset.anchor_a")
