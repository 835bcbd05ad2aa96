"""Keys and results that come during a gesture."""

import pytest


@pytest.mark.parametrize("tool", ["select", "rectangle"])
def test_backspace_in_a_gesture_deletes_nothing(session, hand, tool):
    session.selection = (3,)
    session.choose_tool(tool)
    before = session.document.level
    at, to = ((4.0, 3.0), (4.3, 3.0)) if tool == "select" else ((2.5, 3.5), (2.9, 3.9))
    hand.press(at)
    hand.hold(to)
    hand.type("0.5")
    for _ in range(5):
        hand.key("backspace")
    assert session.driver.active
    assert session.document.level == before
    hand.type("1" if tool == "select" else "1x1")
    hand.release(to)
    assert len(session.document.level.bodies) == len(before.bodies) + (tool == "rectangle")
    if tool == "select":
        assert session.document.level.body(3).position == pytest.approx((5.0, 3.0))
    hand.key("backspace")
    assert len(session.document.level.bodies) == len(before.bodies) - (tool == "select")
