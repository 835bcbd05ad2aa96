"""Selecting, moving, turning and resizing with the pointer."""

import math

import pytest

from editor import actions
from editor.base.overlay import Cursor, HandleKind
from editor.editing.picking import handles, signed_distance
from kinetix.level.geometry import bounds_of, to_world
from kinetix.level.model import Level
from tests.editor.core.helpers import Hand, a_level, a_session, gap, texts


def handle(session, kind, index=0):
    found = handles(session.document.level, session.selection, session.metres)
    return next(h.at for h in found if h.kind is kind and h.index == index)


def position(session, body_id):
    return session.document.level.body(body_id).position


def test_a_click_selects_the_uppermost(session, hand):
    hand.click((1.95, 2.0))
    assert session.selection == (1,)
    hand.click((4.0, 3.0))
    assert session.selection == (3,)
    hand.click((3.0, 4.5))
    assert session.selection == ()


def test_shift_click_toggles(session, hand):
    hand.click((4.0, 3.0))
    hand.click((1.0, 4.0), shift=True)
    assert session.selection == (3, 4)
    hand.click((4.0, 3.0), shift=True)
    assert session.selection == (4,)


def test_clicking_again_goes_deeper(session, hand):
    at = (2.15, 2.0)
    seen = []
    for _ in range(4):
        hand.click(at)
        seen.append(session.selection)
    assert seen == [(5,), (2,), (1,), (5,)]


def test_a_late_or_distant_second_click_starts_over(session, hand):
    hand.click((2.15, 2.0))
    hand.wait(1.0)
    hand.click((2.15, 2.0))
    assert session.selection == (5,)


def test_alt_click_goes_deeper_at_any_time(session, hand):
    hand.click((2.15, 2.0))
    hand.wait(5.0)
    hand.click((2.15, 2.0), alt=True)
    assert session.selection == (2,)


def test_a_right_click_lists_the_stack(session, hand):
    hand.click((2.15, 2.0), button=3)
    (prompt,) = session.prompts
    assert [choice.ids for choice in prompt.choices if choice.ids] == [(5,), (2,), (1,)]
    session.answer(prompt, "1")
    assert session.selection == (2,)


def test_a_right_drag_pans_and_asks_nothing(session, hand):
    centre = session.camera.centre
    hand.press((2.15, 2.0), button=3)
    hand.hold((2.6, 2.0), button=3)
    hand.release((2.6, 2.0), button=3)
    assert session.prompts == []
    assert session.camera.centre != centre
    assert session.selection == ()


def test_a_band_to_the_right_takes_what_it_contains(session, hand):
    hand.drag((1.6, 1.6), (2.3, 2.4))
    assert set(session.selection) == {1, 5, 6}


def test_a_band_to_the_left_takes_what_it_touches(session, hand):
    hand.drag((2.3, 2.4), (1.9, 1.6))
    assert set(session.selection) == {1, 2, 5}


def test_a_band_with_shift_adds(session, hand):
    hand.click((4.0, 3.0))
    hand.drag((0.5, 3.5), (1.5, 4.5), shift=True)
    assert session.selection == (3, 4)


def test_a_cancelled_band_selects_what_was_selected(session, hand):
    hand.click((4.0, 3.0))
    hand.press((0.5, 3.5))
    hand.hold((1.5, 4.5))
    assert session.selection == (4,)
    hand.key("escape")
    assert session.selection == (3,)


def test_a_drag_moves_jointed_neighbours_along(session, hand):
    hand.drag((1.95, 2.0), (2.45, 2.5))
    assert position(session, 1) == pytest.approx((2.5, 2.5), abs=1e-5)
    assert position(session, 2) == pytest.approx((2.7, 2.5), abs=1e-5)
    assert session.document.history.undo_label == "Move 2 shapes"


def test_alt_drag_moves_one_body_and_its_joint(session, hand):
    hand.drag((1.95, 2.0), (2.45, 2.5), alt=True)
    level = session.document.level
    assert level.body(1).position == pytest.approx((2.5, 2.5), abs=1e-5)
    assert level.body(2).position == pytest.approx((2.2, 2.0), abs=1e-5)
    assert level.joints[0].anchor_a == pytest.approx((0.2, 0.0), abs=1e-6)
    assert gap(level, level.joints[0]) < 1e-6


def test_shift_keeps_to_one_axis(session, hand):
    hand.drag((4.0, 3.0), (4.4, 3.1), shift=True)
    assert position(session, 3) == pytest.approx((4.4, 3.0), abs=1e-5)


@pytest.mark.parametrize(
    ("way", "typed", "shift"),
    [
        ((0.3, 0.1), "0.5", (0.5, 0.0)),
        ((-0.3, 0.1), "0.5", (-0.5, 0.0)),
        ((0.3, 0.1), "-0.5", (-0.5, 0.0)),
        ((0.1, -0.3), "0.5", (0.0, -0.5)),
        ((-0.3, 0.1), "0.5x-0.2", (0.5, -0.2)),
    ],
)
def test_a_typed_shift_goes_the_way_of_the_drag(session, hand, way, typed, shift):
    hand.press((4.0, 3.0))
    hand.hold((4.0 + way[0], 3.0 + way[1]))
    hand.type(typed)
    hand.key("return")
    assert position(session, 3) == pytest.approx((4.0 + shift[0], 3.0 + shift[1]))


def test_less_than_three_pixels_is_no_drag(session, hand):
    hand.drag((4.0, 3.0), (4.02, 3.0))
    assert len(session.document.history.entries) == 1


@pytest.mark.parametrize("scale", [1.0, 2.0])
def test_reach_of_the_pointer_grows_with_the_scale_of_the_window(session, hand, scale):
    session.view.scale = scale
    session.settings.snap_smart = True
    pixel = 0.01 * scale  # [m]
    hand.click((2.2 + 7 * pixel, 2.0))
    assert session.selection == (5,)
    hand.drag((4.0, 3.0), (4.0 + 2 * pixel, 3.0))
    assert session.selection == (3,) and len(session.document.history.entries) == 1
    x, y = handle(session, HandleKind.RADIUS)
    hand.move((x + 6 * pixel, y))
    assert session.driver.feedback.cursor is Cursor.RESIZE
    assert session.rules().catch == pytest.approx(8 * pixel)


def test_locked_things_are_neither_picked_nor_moved(session, hand):
    session.selection = (3,)
    hand.key("l", ctrl=True)
    session.selection = ()
    hand.drag((4.0, 3.0), (4.5, 3.0))
    assert session.selection == ()
    assert position(session, 3) == pytest.approx((4.0, 3.0))


def test_the_arena_can_be_selected_but_not_moved(session, hand):
    hand.click((2.5, 0.2))
    assert session.selection == ()
    session.view.edit_arena = True
    hand.click((2.5, 0.2))
    assert session.selection == ("floor",)
    before = session.document.level
    hand.drag((2.5, 0.2), (2.5, 1.2))
    hand.key("delete")
    assert session.document.level == before


def test_the_rotation_handle_turns_in_steps(session, hand):
    session.selection = (3,)
    start = handle(session, HandleKind.ROTATE)
    body = session.document.level.body(3)
    reach = math.dist(start, body.position)
    angle = math.radians(90 + 32)
    end = (
        body.position[0] + reach * math.cos(angle),
        body.position[1] + reach * math.sin(angle),
    )
    hand.drag(start, end)
    assert math.degrees(session.document.level.body(3).angle) == pytest.approx(30, abs=1e-3)


def test_anchors_follow_a_turn(session, hand):
    session.selection = (1,)
    hand.key("q")
    hand.key("q", shift=True)
    level = session.document.level
    assert math.degrees(level.body(1).angle) == pytest.approx(16, abs=1e-3)
    assert gap(level, level.joints[0]) < 1e-6


def test_a_group_turns_about_its_centroid(session, hand):
    session.selection = (1, 2)
    centre = (2.1, 2.0)
    hand.key("[")
    level = session.document.level
    for body_id in (1, 2):
        assert math.dist(level.body(body_id).position, centre) == pytest.approx(0.1, abs=1e-5)
        assert math.degrees(level.body(body_id).angle) == pytest.approx(45, abs=1e-3)
    assert gap(level, level.joints[0]) < 1e-6


def test_a_corner_resizes_a_rectangle_and_holds_the_opposite_one(session, hand):
    session.selection = (1,)
    corner = handle(session, HandleKind.SCALE, 2)
    assert corner == pytest.approx((2.2, 2.2), abs=1e-6)
    hand.drag(corner, (2.6, 2.4))
    level = session.document.level
    left, bottom, right, top = bounds_of([level.body(1)])
    assert (left, bottom, right, top) == pytest.approx((1.8, 1.8, 2.6, 2.4), abs=1e-5)
    assert gap(level, level.joints[0]) < 1e-6


def test_an_edge_resizes_one_direction(session, hand):
    session.selection = (1,)
    edge = handle(session, HandleKind.SCALE_X, 1)
    hand.drag(edge, (2.4, 2.3))
    left, bottom, right, top = bounds_of([session.document.level.body(1)])
    assert (left, bottom, right, top) == pytest.approx((1.8, 1.8, 2.4, 2.2), abs=1e-5)


def test_the_rim_resizes_a_circle(session, hand):
    session.selection = (3,)
    hand.drag(handle(session, HandleKind.RADIUS), (4.5, 3.0))
    assert session.document.level.body(3).shape.radius == pytest.approx(0.5, abs=1e-5)


def test_a_group_scales_uniformly(session, hand):
    session.selection = (1, 2)
    before = session.document.level
    corner = handle(session, HandleKind.SCALE, 2)
    left, bottom, right, top = bounds_of([before.body(1), before.body(2)])
    hand.drag(corner, (left + 2 * (right - left), bottom + 2 * (top - bottom)))
    level = session.document.level
    assert level.body(2).shape.radius == pytest.approx(0.3, abs=1e-5)
    assert level.thrusters[0].position == pytest.approx((-0.3, 0.2), abs=1e-5)
    assert gap(level, level.joints[0]) < 1e-6


def test_a_group_grows_as_far_as_a_level_reaches(session, hand):
    session.selection = (1, 2, 3)
    hand.drag(handle(session, HandleKind.SCALE, 2), (90.0, 80.0))
    level = session.document.level
    assert max(level.body(3).position) == pytest.approx(15.0, abs=1e-3)
    assert gap(level, level.joints[0]) < 1e-6
    actions.run(session, "edit.undo")
    assert level != session.document.level == a_level()


def test_a_triangles_vertex_can_be_dragged():
    session = a_session(Level(name="Empty"))
    hand = Hand(session)
    hand.key("t")
    for corner in ((1, 1), (2, 1), (1, 2)):
        hand.click(corner)
    vertex = next(
        h
        for h in handles(session.document.level, session.selection, session.metres)
        if h.kind is HandleKind.VERTEX and math.dist(h.at, (1, 2)) < 1e-5
    )
    hand.drag(vertex.at, (1.0, 3.0))
    body = session.document.level.bodies[0]
    assert bounds_of([body]) == pytest.approx((1, 1, 2, 3), abs=1e-5)
    assert body.position == pytest.approx((4 / 3, 5 / 3), abs=1e-5)


def test_a_vertex_can_be_dragged_across_the_opposite_side():
    session = a_session(Level(name="Empty"))
    hand = Hand(session)
    hand.key("t")
    for corner in ((1, 1), (2, 1), (1.5, 2)):
        hand.click(corner)
    before = session.document.level
    hand.press((1.5, 2))
    hand.hold((1.5, 1.5))
    hand.hold((1.5, 1))
    assert session.driver.active
    assert "cannot go there" in session.hint
    assert session.driver.feedback.cursor is Cursor.REFUSED
    hand.hold((1.5, 0.5))
    assert "cannot go there" not in session.hint
    hand.release((1.5, 0.5))
    assert bounds_of(session.document.level.bodies) == pytest.approx((1, 0.5, 2, 1), abs=1e-5)
    session.document.undo()
    hand.drag((1.5, 2), (1.5, 1))
    assert "cannot go there" in texts(session)[-1]
    assert session.document.level.bodies == before.bodies
    assert not session.document.previewing


def test_a_selected_joint_and_thruster_can_be_dragged(session, hand):
    session.selection = (6,)
    hand.drag((1.85, 2.1), (1.95, 2.15))
    assert session.document.level.thrusters[0].position == pytest.approx((-0.05, 0.15), abs=1e-4)
    hand.click((2.2, 2.0))
    assert session.selection == (5,)
    hand.drag((2.2, 2.0), (2.1, 2.05))
    joint = session.document.level.joints[0]
    assert joint.anchor_a == pytest.approx((0.1, 0.05), abs=1e-5)
    assert gap(session.document.level, joint) < 1e-6


def test_a_thruster_is_dragged_to_another_shape_and_pushes_the_same_way(session, hand):
    level = session.document.level
    before = level.thrusters[0].angle + level.body(level.thrusters[0].body).angle
    session.selection = (6,)
    hand.drag((1.85, 2.1), (4.05, 3.05))
    thruster, body = session.document.level.thrusters[0], session.document.level.body(3)
    assert thruster.body == 3
    assert to_world(body, thruster.position) == pytest.approx((4.05, 3.05), abs=1e-4)
    assert thruster.angle + body.angle == pytest.approx(before)


def test_a_thruster_dropped_beside_all_shapes_stays_where_it_was_last_on_one(session, hand):
    level = session.document.level
    session.selection = (6,)
    hand.drag((1.85, 2.1), (3.0, 4.5))
    moved = session.document.level.thrusters[0]
    assert moved.body == level.thrusters[0].body
    assert (
        signed_distance(level.body(moved.body), to_world(level.body(moved.body), moved.position))
        < 1e-3
    )


def test_aiming_a_selected_thruster(session, hand):
    session.selection = (6,)
    hand.drag(handle(session, HandleKind.AIM), (1.85, 3.1), ctrl=True)
    assert session.document.level.thrusters[0].angle == pytest.approx(math.pi / 2, abs=1e-3)


@pytest.mark.parametrize(
    ("key", "mods", "shift"),
    [
        ("left", {}, (-0.05, 0.0)),
        ("up", {"shift": True}, (0.0, 0.5)),
        ("right", {"alt": True}, (0.005, 0.0)),
        ("down", {}, (0.0, -0.05)),
    ],
)
def test_arrows_nudge(session, hand, key, mods, shift):
    session.selection = (3,)
    hand.key(key, **mods)
    assert position(session, 3) == pytest.approx((4.0 + shift[0], 3.0 + shift[1]), abs=1e-5)
    assert session.editing
    session.document.undo()
    session.settings.nudge_step = 0.1
    hand.key(key, **mods)
    assert position(session, 3) == pytest.approx((4.0 + 2 * shift[0], 3.0 + 2 * shift[1]), abs=1e-5)


def test_quick_nudges_are_one_entry(session, hand):
    session.selection = (3,)
    for _ in range(5):
        hand.key("left")
        hand.wait(0.1)
    assert len(session.document.history.entries) == 2
    hand.wait(1.0)
    hand.key("left")
    assert len(session.document.history.entries) == 3


def test_selecting_never_changes_the_level(session, hand):
    before, entries = session.document.level, len(session.document.history.entries)
    for entity in before.entities():
        session.selection = (entity.id,)
        for _ in range(3):
            hand.wait()
            assert session.marks is not None
            handles(session.document.level, session.selection, session.metres)
    actions.run(session, "edit.select_all")
    assert session.document.level is before or session.document.level == before
    assert len(session.document.history.entries) == entries
    assert not session.document.dirty


def test_the_level_of_the_helpers_is_sound():
    level = a_level()
    assert gap(level, level.joints[0]) < 1e-6


def test_a_joint_dropped_on_other_bodies_joins_them_and_keeps_its_motor():
    level = a_level()
    ball = level.body(3).replace(id=9, position=(4.1, 3.0), role="none")
    level = level.replace(bodies=(*level.bodies, ball), next_id=10)
    session = a_session(level)
    session.selection = (5,)
    hand = Hand(session)
    hand.drag((2.2, 2.0), (4.05, 3.0))
    joint = session.document.level.joints[0]
    assert {joint.a, joint.b} == {3, 9}
    assert joint.motor.speed == 2.0
    assert joint.id == 5
    hand.drag((4.05, 3.0), (3.0, 1.5))
    joint = session.document.level.joints[0]
    assert {joint.a, joint.b} == {3, 9}


def test_guides_tell_their_length():
    from editor.base.overlay import Label, Line, Style
    from editor.editing.snapping import measured

    long = Line(a=(1.0, 1.0), b=(1.0, 2.5), style=Style.GUIDE)
    short = Line(a=(1.0, 1.0), b=(1.02, 1.0), style=Style.GUIDE)
    labels = [mark for mark in measured((long, short)) if isinstance(mark, Label)]
    assert [label.text for label in labels] == ["1.50 m"]
    assert labels[0].at == (1.0, 1.75)
