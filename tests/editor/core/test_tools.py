"""Drawing by synthetic pointer events: press, drag, release and click, move, click."""

import math

import pytest

from editor import actions
from editor.documents.document import Document
from editor.editing.tools import TOOLS
from kinetix.level.geometry import signed_area
from kinetix.level.model import Circle, Level
from tests.editor.core.helpers import Hand, a_level, a_session, texts


@pytest.fixture
def session():
    return a_session(Level(name="Empty"))


def drawn(session):
    return session.document.level.bodies[-1]


def test_a_circle_is_dragged_from_its_centre(session, hand):
    hand.key("c")
    hand.drag((2.0, 2.0), (2.3, 2.4))
    body = drawn(session)
    assert body.shape.radius == pytest.approx(0.5, abs=1e-6)
    assert body.position == pytest.approx((2.0, 2.0))
    assert session.selection == (body.id,)
    assert session.tool.id == "select"


def test_click_move_click_draws_the_same(session, hand):
    hand.key("c")
    hand.click((2.0, 2.0))
    assert session.driver.active
    hand.move((2.2, 2.0))
    hand.move((2.5, 2.0))
    hand.click((2.5, 2.0))
    assert drawn(session).shape.radius == pytest.approx(0.5, abs=1e-6)
    assert not session.driver.active


def test_a_rectangle_goes_from_corner_to_corner(session, hand):
    hand.key("r")
    hand.drag((1.0, 1.0), (2.0, 0.6))
    body = drawn(session)
    assert body.position == pytest.approx((1.5, 0.8))
    assert {tuple(round(abs(c), 6) for c in v) for v in body.shape.vertices} == {(0.5, 0.2)}
    assert signed_area(body.shape.vertices) > 0


def test_shift_makes_a_square_and_alt_draws_from_the_centre(session, hand):
    hand.key("r")
    hand.drag((2.0, 2.0), (2.5, 2.2), shift=True, alt=True)
    body = drawn(session)
    assert body.position == pytest.approx((2.0, 2.0))
    assert body.shape.vertices[0] == pytest.approx((0.5, 0.5))


def test_a_typed_size_overrides_the_dragged_one(session, hand):
    hand.key("r")
    hand.press((1.0, 1.0))
    hand.hold((1.5, 1.5))
    hand.type("1.2x0.4")
    hand.key("return")
    body = drawn(session)
    assert body.position == pytest.approx((1.6, 1.2))
    assert body.shape.vertices[0] == pytest.approx((0.6, 0.2))


def test_a_typed_number_can_be_corrected(session, hand):
    hand.key("c")
    hand.press((1.0, 1.0))
    hand.hold((1.5, 1.0))
    hand.type("0.39")
    hand.key("backspace")
    hand.release((1.5, 1.0))
    assert drawn(session).shape.radius == pytest.approx(0.3)


@pytest.mark.parametrize("corners", [((1, 1), (2, 1), (1, 2)), ((1, 1), (1, 2), (2, 1))])
def test_a_triangle_is_turned_counter_clockwise(session, hand, corners):
    hand.key("t")
    for corner in corners:
        hand.move(corner)
        hand.click(corner)
    body = drawn(session)
    assert signed_area(body.shape.vertices) == pytest.approx(0.5, abs=1e-5)
    assert body.position == pytest.approx((4 / 3, 4 / 3), abs=1e-5)


def test_a_click_whose_corner_snaps_sets_one_corner():
    session = a_session(Level(name="Empty"), snap_grid=True, grid_step=0.1)
    hand = Hand(session)
    hand.key("t")
    for corner in ((1.46, 2.46), (2.96, 2.46), (2.16, 3.46)):
        hand.move(corner)
        hand.click(corner)
    assert abs(signed_area(drawn(session).shape.vertices)) == pytest.approx(0.7, abs=0.1)


def test_a_flat_triangle_is_refused_with_a_message(session, hand):
    hand.key("t")
    for corner in ((1, 1), (2, 1), (3, 1.0001)):
        hand.click(corner)
    assert session.document.level.bodies == ()
    assert "too flat" in texts(session)[-1]
    assert not session.driver.active


def test_a_kept_tool_draws_several(session, hand):
    hand.key("c")
    hand.key("c")
    for x in (1.0, 2.0, 3.0):
        hand.drag((x, 2.0), (x + 0.2, 2.0))
    assert len(session.document.level.bodies) == 3
    assert session.tool.id == "circle"


def test_a_joint_takes_the_two_bodies_under_it():
    session = a_session(a_level().replace(joints=()))
    hand = Hand(session)
    hand.key("j")
    hand.move((2.15, 2.05))
    assert session.hint == TOOLS["joint"].hint
    hand.click((2.15, 2.05))
    (joint,) = session.document.level.joints
    assert (joint.kind, joint.a, joint.b) == ("revolute", 1, 2)
    assert joint.anchor_a == pytest.approx((0.15, 0.05), abs=1e-5)
    assert joint.anchor_b == pytest.approx((-0.05, 0.05), abs=1e-5)
    assert joint.motor is not None and joint.motor.on


def test_a_click_near_the_hub_of_a_wheel_means_its_centre():
    session = a_session(a_level().replace(joints=()))
    session.settings.snap_smart = True
    hand = Hand(session)
    hand.key("j")
    hand.click((2.17, 2.03))
    (joint,) = session.document.level.joints
    assert joint.anchor_b == pytest.approx((0.0, 0.0), abs=1e-9)


def test_the_hub_is_not_taken_where_no_other_shape_is():
    level = a_level()
    wheel = level.bodies[1].replace(shape=Circle(radius=0.3), position=(2.28, 2.0))
    session = a_session(level.replace(joints=(), bodies=(level.bodies[0], wheel)))
    session.settings.snap_smart = True
    hand = Hand(session)
    hand.key("j")
    hand.click((2.2, 2.03))
    (joint,) = session.document.level.joints
    assert {joint.a, joint.b} == {1, 2}


def test_shapes_that_only_touch_can_be_joined():
    level = a_level()
    other = level.bodies[0].replace(id=9, position=(2.0, 2.5))
    edge = max(y for _, y in other.shape.vertices)
    other = other.replace(position=(2.0, 2.0 + 2 * edge + 0.002))
    session = a_session(level.replace(joints=(), bodies=(level.bodies[0], other), next_id=10))
    hand = Hand(session)
    hand.key("j")
    hand.click((2.0, 2.0 + edge + 0.001))
    (joint,) = session.document.level.joints
    assert {joint.a, joint.b} == {1, 9}
    hand.key("j")
    hand.click((2.0, 2.0 + edge - 0.1))
    assert len(session.document.level.joints) == 1


def test_a_weld_remembers_the_angle_between_its_bodies():
    level = a_level()
    bodies = (level.bodies[0].replace(angle=0.3), level.bodies[1].replace(angle=1.0))
    session = a_session(level.replace(joints=(), bodies=bodies))
    hand = Hand(session)
    hand.key("w")
    hand.click((2.15, 2.05))
    (joint,) = session.document.level.joints
    assert joint.kind == "fixed"
    assert joint.motor is None
    assert joint.reference_angle == pytest.approx(0.7, abs=1e-6)


def test_a_joint_needs_two_shapes(session, hand):
    hand.key("j")
    hand.move((2.0, 2.0))
    assert session.hint == "A joint needs two overlapping shapes"
    hand.click((2.0, 2.0))
    assert session.document.level.joints == ()
    assert "A joint needs two overlapping shapes" in texts(session)


def test_three_shapes_under_a_joint_ask_for_the_pair():
    level = a_level()
    third = level.bodies[1].replace(id=9, position=(2.1, 2.0))
    session = a_session(level.replace(joints=(), bodies=(*level.bodies, third), next_id=10))
    hand = Hand(session)
    hand.key("j")
    hand.click((2.12, 2.0))
    (prompt,) = session.prompts
    assert len(prompt.choices) == 3
    wanted = next(c for c in prompt.choices if set(c.ids) == {1, 9})
    session.answer(prompt, wanted.id)
    (joint,) = session.document.level.joints
    assert {joint.a, joint.b} == {1, 9}
    assert session.prompts == []


def test_a_pair_is_joined_in_the_level_in_which_it_was_clicked():
    level = a_level()
    third = level.bodies[1].replace(id=9, position=(2.1, 2.0))
    level = level.replace(joints=(), bodies=(*level.bodies, third), next_id=10)
    session = a_session(level)
    asked = session.document
    hand = Hand(session)
    hand.key("j")
    hand.click((2.12, 2.0))
    session.open_tab(Document(level))
    session.answer(session.prompts[-1], "0")
    assert len(asked.level.joints) == 1
    assert session.document.level == level


def test_two_selected_shapes_decide_the_pair():
    level = a_level()
    third = level.bodies[1].replace(id=9, position=(2.1, 2.0))
    session = a_session(level.replace(joints=(), bodies=(*level.bodies, third), next_id=10))
    session.selection = (9, 1)
    hand = Hand(session)
    hand.key("j")
    hand.click((2.12, 2.0))
    (joint,) = session.document.level.joints
    assert (joint.a, joint.b) == (1, 9)


def test_a_body_can_be_joined_to_the_floor(session, hand):
    hand.key("c")
    hand.drag((2.0, 0.4), (2.3, 0.4))
    hand.key("j")
    hand.click((2.0, 0.3))
    (joint,) = session.document.level.joints
    assert (joint.a, joint.b) == ("floor", 1)


@pytest.mark.parametrize(
    ("end", "degrees"),
    [((3.0, 2.0), 0), ((2.0, 3.0), 90), ((1.0, 2.04), 180), ((2.7, 2.74), 45), ((2.8, 1.8), -15)],
)
def test_a_thruster_pushes_where_it_is_dragged(session, hand, end, degrees):
    hand.key("c")
    hand.drag((2.0, 2.0), (2.5, 2.0))
    hand.key("h")
    hand.drag((2.0, 2.0), end)
    (thruster,) = session.document.level.thrusters
    assert math.degrees(thruster.angle) == pytest.approx(degrees, abs=1e-3)


def test_ctrl_aims_a_thruster_freely(session, hand):
    hand.key("c")
    hand.drag((2.0, 2.0), (2.5, 2.0))
    hand.key("h")
    hand.drag((2.0, 2.0), (3.0, 2.4), ctrl=True)
    (thruster,) = session.document.level.thrusters
    assert thruster.angle == pytest.approx(math.atan2(0.4, 1.0), abs=1e-5)


def test_a_thruster_snaps_through_the_centre(session, hand):
    hand.key("c")
    hand.drag((2.0, 2.0), (2.5, 2.0))
    hand.key("h")
    # From (1.7, 1.88) the centre lies at 21.8°, no multiple of 15°.
    hand.drag((1.7, 1.88), (2.7, 2.2))
    (thruster,) = session.document.level.thrusters
    assert thruster.angle == pytest.approx(math.atan2(0.12, 0.3), abs=1e-4)


def test_a_thruster_needs_a_body(session, hand):
    hand.key("h")
    hand.drag((2.0, 2.0), (3.0, 2.0))
    assert session.document.level.thrusters == ()
    assert "A thruster needs a shape to push" in texts(session)


def test_new_things_have_defaults_whatever_was_deleted(session, hand):
    hand.key("c")
    hand.drag((2.0, 2.0), (2.5, 2.0))
    fresh = drawn(session)
    odd = fresh.replace(
        friction=3.0, restitution=0.5, role="red", density=9.0, angular_velocity=4.0
    )
    level = session.document.level.replace(bodies=(odd,))
    session = a_session(level)
    hand = Hand(session)
    session.selection = (odd.id,)
    hand.key("delete")
    hand.key("c")
    hand.drag((2.0, 2.0), (2.5, 2.0))
    assert drawn(session).replace(id=fresh.id) == fresh


TOOL_GESTURES = {
    "rectangle": [((1.5, 1.5), (2.3, 2.2))],
    "circle": [((1.5, 1.5), (2.3, 2.2))],
    "triangle": [((1.5, 1.5), (1.5, 1.5)), ((2.5, 1.5), (2.5, 1.5))],
    "thruster": [((2.0, 2.0), (2.6, 2.6))],
    "joint": [((2.15, 2.0), (2.15, 2.0))],
    "weld": [((2.15, 2.0), (2.15, 2.0))],
    "select": [((2.0, 2.0), (3.0, 2.5))],
}


def leave_by_escape(session, hand):
    hand.key("escape")


def leave_by_tool_key(session, hand):
    hand.key("c")


def leave_by_space(session, hand):
    hand.key("space")
    hand.key("escape")


def leave_by_focus(session, hand):
    from editor.base.events import FocusEvent

    actions.handle(session, FocusEvent(focused=False))


def leave_by_undo(session, hand):
    hand.key("z", ctrl=True)


WAYS_OUT = (leave_by_escape, leave_by_tool_key, leave_by_space, leave_by_focus, leave_by_undo)


@pytest.mark.parametrize("way", WAYS_OUT, ids=lambda way: way.__name__)
@pytest.mark.parametrize("tool", TOOL_GESTURES)
def test_every_way_out_of_a_gesture_leaves_the_document_as_it_was(tool, way):
    session = a_session()
    hand = Hand(session)
    before = session.document.level
    actions.run(session, f"tool.{tool}")
    *clicks, last = TOOL_GESTURES[tool]
    for start, _ in clicks:
        hand.click(start)
    hand.press(last[0])
    hand.hold(last[1])
    hand.hold((last[1][0] + 0.1, last[1][1]))
    assert session.driver.active
    way(session, hand)
    assert not session.driver.active
    assert session.document.level == before
    assert session.document.shown == before
    assert len(session.document.history.entries) == 1
    hand.release(last[1])
    assert session.document.level == before


@pytest.mark.parametrize("tool", TOOL_GESTURES)
def test_the_wheel_only_zooms(tool):
    from editor.base.events import WheelEvent

    session = a_session()
    hand = Hand(session)
    actions.run(session, f"tool.{tool}")
    start, end = TOOL_GESTURES[tool][0]
    hand.press(start)
    hand.hold((end[0] + 0.01, end[1]))
    before, zoom = session.document.level, session.camera.zoom
    actions.handle(session, WheelEvent(dy=3.0, screen=(300.0, 300.0)))
    assert session.document.level == before
    assert session.camera.zoom > zoom
    assert session.driver.active


def test_hovering_and_drawing_never_touch_the_committed_level(session, hand):
    before = session.document.level
    for tool in TOOLS:
        actions.run(session, f"tool.{tool}")
        for k in range(20):
            hand.move((0.25 * k, 2.5))
    assert session.document.level is before


FLOOR_TOP = 0.4


@pytest.mark.parametrize("smart", [True, False], ids=["shapes", "grid"])
@pytest.mark.parametrize("size", [0.06, 0.1])
def test_a_small_rectangle_on_the_floor_keeps_its_height(size, smart):
    level = Level(name="Empty")
    session = a_session(level, snap_smart=smart, snap_grid=not smart, grid_step=0.25)
    hand = Hand(session)
    hand.key("r")
    hand.drag((1.0, FLOOR_TOP), (1.0 + size, FLOOR_TOP + size))
    corners = drawn(session).shape.vertices
    # The grid may take the corner to a line near it, but not to that of the first corner.
    assert max(y for _, y in corners) * 2 == pytest.approx(size, abs=0.02 if smart else 0.045)
    assert max(x for x, _ in corners) * 2 == pytest.approx(size, abs=0.02 if smart else 0.045)


@pytest.mark.parametrize("end", [(4.497, 0.704), (4.203, 0.997), (4.2, 1.0), (3.902, 0.696)])
def test_a_circle_drawn_along_the_grid_has_exactly_its_radius(end):
    session = a_session(Level(name="Empty"), snap_smart=True, snap_grid=True)
    hand = Hand(session)
    hand.key("c")
    hand.drag((4.203, 0.697), end)
    body = drawn(session)
    # As near as a level's single precision comes.
    assert (*body.position, body.shape.radius) == pytest.approx((4.2, 0.7, 0.3), abs=5e-7)


@pytest.mark.parametrize("end", [(3.32, 3.06), (3.21, 3.22), (3.0, 2.72)])
def test_the_grid_takes_a_circles_radius_in_any_direction(end):
    session = a_session(Level(name="Empty"), snap_smart=False, snap_grid=True, grid_step=0.1)
    hand = Hand(session)
    hand.key("c")
    hand.drag((3.01, 2.99), end)
    assert drawn(session).shape.radius == pytest.approx(0.3, abs=5e-7)


def test_a_circle_drawn_without_snapping_ends_at_the_pointer():
    session = a_session(Level(name="Empty"), snap_smart=False, snap_grid=False)
    hand = Hand(session)
    hand.key("c")
    hand.drag((2.0, 2.0), (2.3, 2.01))
    assert drawn(session).shape.radius == pytest.approx(math.hypot(0.3, 0.01), abs=1e-5)


def test_a_small_circle_on_the_floor_keeps_its_radius():
    session = a_session(Level(name="Empty"), snap_smart=True)
    hand = Hand(session)
    hand.key("c")
    hand.drag((2.5, FLOOR_TOP), (2.55, FLOOR_TOP + 0.05))
    assert drawn(session).shape.radius == pytest.approx(math.hypot(0.05, 0.05), abs=1e-4)


def test_a_small_triangle_keeps_its_corners_apart():
    session = a_session(Level(name="Empty"), snap_smart=True)
    hand = Hand(session)
    hand.key("t")
    for corner in ((2.5, FLOOR_TOP), (2.56, FLOOR_TOP + 0.01), (2.53, FLOOR_TOP + 0.06)):
        hand.click(corner)
    assert len(drawn(session).shape.vertices) == 3


def test_a_shape_on_the_floor_is_made_low_without_collapsing():
    session = a_session(Level(name="Empty"), snap_smart=True)
    hand = Hand(session)
    hand.key("r")
    hand.drag((1.0, FLOOR_TOP), (1.5, FLOOR_TOP + 0.5))
    hand.drag((1.25, FLOOR_TOP + 0.5), (1.25, FLOOR_TOP + 0.06))
    corners = drawn(session).shape.vertices
    assert max(y for _, y in corners) * 2 == pytest.approx(0.06, abs=0.01)


def test_two_wheels_drawn_alike_are_equal():
    from editor.documents.commands.fields import shared_value

    session = a_session(Level(name="Empty"))
    hand = Hand(session)
    for x, y in ((1.0, 1.0), (3.13, 2.7)):
        hand.key("c")
        hand.drag((x, y), (x + 0.2, y + 0.1))
    first, second = session.document.level.bodies
    assert first.shape == second.shape
    level = session.document.level
    nearly = second.shape.replace(radius=second.shape.radius + 1e-7)
    level = level.replace(bodies=(first, second.replace(shape=nearly)))
    assert shared_value(level, (first.id, second.id), "shape.radius")[1]
    other = second.shape.replace(radius=second.shape.radius + 1e-3)
    level = level.replace(bodies=(first, second.replace(shape=other)))
    assert not shared_value(level, (first.id, second.id), "shape.radius")[1]


def test_two_fingers_zoom_where_they_are_unless_switched_off(session):
    from editor.base.events import PinchEvent

    at = (300.0, 300.0)
    under, zoom = session.camera.to_world(at), session.camera.zoom
    actions.handle(session, PinchEvent(factor=1.5, screen=at))
    assert session.camera.zoom == pytest.approx(1.5 * zoom)
    assert session.camera.to_world(at) == pytest.approx(under, abs=1e-4)
    session.settings.pinch = False
    actions.handle(session, PinchEvent(factor=1.5, screen=at))
    assert session.camera.zoom == pytest.approx(1.5 * zoom)
