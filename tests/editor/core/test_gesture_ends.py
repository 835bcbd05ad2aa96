"""Gestures stop typed values at a level's limits, and refuse what cannot be dragged."""

import pytest

from editor.actions import run
from editor.base.events import RIGHT
from editor.base.overlay import HandleKind
from editor.documents.commands.fields import SetField
from editor.documents.commands.sizes import extent
from editor.editing import gauges
from kinetix.level.model import Level, Limits
from tests.editor.core.helpers import Hand, a_level, a_session, texts


@pytest.mark.parametrize("chosen", [(5, 6), (5, 7)])
def test_several_joints_and_thrusters_are_not_taken_for_the_arena(chosen):
    level = a_level()
    other = level.joints[0].replace(id=7, a=3, b=4, anchor_a=(0.0, 0.0), anchor_b=(3.0, -1.0))
    session = a_session(level.replace(joints=(*level.joints, other), next_id=8))
    session.selection = chosen
    before = session.document.level
    Hand(session).drag((2.2, 2.0), (2.6, 2.3))
    assert session.document.level == before
    assert texts(session) == ["Joints and thrusters are dragged one at a time: select one alone."]


@pytest.mark.parametrize(("typed", "radius"), [("6", 5.0), ("0.001", 0.02)])
def test_a_typed_radius_stops_at_the_limits(session, hand, typed, radius):
    hand.key("c")
    hand.press((2.5, 2.5))
    hand.hold((2.9, 2.5))
    hand.type(typed)
    assert [mark.text for mark in session.marks if hasattr(mark, "text")][-1] == (
        f"radius {radius:.2f} m"
    )
    hand.key("return")
    assert session.document.level.bodies[-1].shape.radius == pytest.approx(radius)


def test_a_typed_side_stops_at_the_limit(session, hand):
    hand.key("r")
    hand.press((2.5, 2.5))
    hand.hold((2.9, 2.9))
    hand.type("0.01x1")
    hand.key("return")
    shape = session.document.level.bodies[-1].shape
    assert (extent(shape, 0), extent(shape, 1)) == pytest.approx((0.02, 1.0), abs=1e-5)


def test_a_rectangle_without_height_says_what_to_type(session, hand):
    hand.key("r")
    hand.press((2.5, 2.5))
    hand.hold((2.9, 2.5))
    hand.type("1")
    hand.key("return")
    assert len(session.document.level.bodies) == 4
    assert texts(session) == ["Type width and height, as in 1x0.5."]


@pytest.mark.parametrize(
    ("kind", "typed", "value"),
    [
        (HandleKind.MOTOR, "25", 20.0),
        (HandleKind.MOTOR, "-25", -20.0),
        (HandleKind.LIMIT_MAX, "9999", 100.0),
    ],
)
def test_a_number_typed_at_a_handle_stops_at_the_limit(kind, typed, value):
    level = a_level()
    limited = level.joints[0].replace(limits=Limits(min=-0.5, max=0.5))
    session = a_session(level.replace(joints=(limited,)))
    hand = Hand(session)
    session.selection = (5,)
    available = gauges.handles_of(session.document.level, (5,), session.metres)
    at = next(handle.at for handle in available if handle.kind is kind)
    hand.press(at)
    hand.hold((at[0] + 0.1, at[1]))
    for character in typed:
        hand.type(character)
    assert session.driver.active
    hand.key("return")
    joint = session.document.level.joints[0]
    assert (joint.motor.speed if kind is HandleKind.MOTOR else joint.limits.max) == value
    assert texts(session) == []


def test_gravity_has_no_handle_in_an_empty_level():
    session = a_session(Level(name="Empty"))
    hand = Hand(session)
    hand.move((0.5, 4.1))
    assert "gravity" not in session.hint
    hand.drag((0.5, 4.1), (3.0, 2.0))
    assert session.document.history.undo_label is None


def test_the_grabbed_shape_leads_on_the_grid():
    level = a_level()
    places = {3: (4.03, 3.03), 4: (1.0, 4.01)}
    bodies = tuple(b.replace(position=places.get(b.id, b.position)) for b in level.bodies)
    session = a_session(level.replace(bodies=bodies), snap_grid=True, grid_step=0.1)
    session.selection = (3, 4)
    Hand(session).drag((1.0, 4.01), (1.31, 4.31))
    assert session.document.level.body(4).position == pytest.approx((1.3, 4.3), abs=1e-5)


def test_an_edit_that_comes_during_a_drag_keeps_the_drag_as_a_step_of_its_own(session, hand):
    before = session.document.level
    session.selection = (3,)
    hand.press((4.0, 3.0))
    hand.hold((4.5, 3.0))
    session.execute(SetField(ids=(3,), field="friction", value=0.25))
    assert not session.driver.active
    hand.hold((4.9, 3.0))
    hand.release((4.9, 3.0))
    body = session.document.level.body(3)
    assert (body.position[0], body.friction) == (pytest.approx(4.5), 0.25)
    run(session, "edit.undo")
    assert session.document.level.body(3) == body.replace(friction=before.body(3).friction)
    run(session, "edit.undo")
    assert session.document.level == before


def test_an_edit_that_comes_with_a_press_lets_the_drag_go_on(session, hand):
    hand.press((4.0, 3.0))
    session.execute(SetField(ids=(3,), field="friction", value=0.25))
    hand.hold((4.5, 3.0))
    hand.release((4.5, 3.0))
    body = session.document.level.body(3)
    assert (body.position[0], body.friction) == (pytest.approx(4.5), 0.25)


def test_an_edit_between_two_clicks_drops_what_they_would_make(session, hand):
    hand.key("r")
    hand.click((2.5, 2.5))
    hand.move((3.0, 3.0))
    assert session.driver.active
    session.execute(SetField(ids=(3,), field="friction", value=0.25))
    assert not session.driver.active and not session.document.previewing
    assert len(session.document.level.bodies) == 4
    assert session.document.level.body(3).friction == 0.25


def test_only_one_thing_is_offered_a_name(session, hand):
    for chosen, offered in (((3,), True), ((1, 3), False)):
        session.selection = chosen
        hand.click((4.0, 3.0), button=RIGHT)
        menu = session.prompts[-1]
        assert ("edit.rename" in [choice.id for choice in menu.choices]) is offered
        session.answer(menu, None)
    assert run(session, "edit.select_all")
