"""Marks on the level: key caps, labels, debug drawings."""

import dataclasses
import itertools

import numpy as np
import pytest
from imgui_bundle import imgui

from editor.drawing import debug_draw
from editor.drawing.strokes import Room
from editor.editing.picking import bodies_at
from editor.toolkit.widgets import px
from editor.window import canvas
from editor.worker.jobs import Job
from editor.worker.requests import PlaySolution
from kinetix.level.geometry import FLOOR_TOP
from kinetix.level.model import Body, Circle, Joint, Level, Motor, Polygon, Thruster
from tests.editor.core.helpers import a_level, a_session


def caps(gui):
    gui.frames(2)
    return {place.entity: place for place in gui.host.ui.workplace.canvas.caps}


def a_caterpillar(links=8):
    """Many driven joints close together."""
    bodies = tuple(
        Body(id=k + 1, shape=Circle(radius=0.1), position=(1.0 + 0.96 / links * k, 1.0))
        for k in range(links + 1)
    )
    joints = tuple(
        Joint(
            id=100 + k,
            kind="revolute",
            a=k + 1,
            b=k + 2,
            anchor_a=(0.06, 0.0),
            anchor_b=(-0.06, 0.0),
            motor=Motor(),
        )
        for k in range(links)
    )
    return Level(name="Caterpillar", bodies=bodies, joints=joints)


def test_hidden_things_have_no_key_caps(make_gui):
    gui = make_gui(session=a_session())
    assert set(caps(gui)) == {5, 6}
    gui.session.document.hidden = frozenset({5})
    assert set(caps(gui)) == {6}
    gui.session.settings.key_caps = False
    gui.frames(2)


def test_handles_are_caught_as_large_as_they_are_drawn(make_gui):
    gui = make_gui(session=a_session(text_scale=1.5), scale=2.0)
    gui.frames(2)
    assert gui.session.view.scale == px(1.0) == 3.0


@pytest.mark.parametrize(("size", "scale"), [((1024, 640), 1.0), ((1440, 900), 2.0)])
def test_key_caps_are_no_larger_than_the_machine_and_leave_each_other_room(make_gui, size, scale):
    gui = make_gui(session=a_session(level=a_caterpillar()), size=size, scale=scale)
    places = list(caps(gui).values())
    assert places
    for place in places:
        metres = (place.high[1] - place.low[1]) / gui.session.camera.scale
        assert metres < 0.2
    for a, b in itertools.combinations(places, 2):
        assert (
            a.high[0] <= b.low[0]
            or b.high[0] <= a.low[0]
            or a.high[1] <= b.low[1]
            or b.high[1] <= a.low[1]
        )


def test_the_caps_of_what_is_selected_are_always_there(make_gui):
    gui = make_gui(session=a_session(level=a_caterpillar(links=40)))
    few = caps(gui)
    left_out = next(joint.id for joint in gui.level.joints if joint.id not in few)
    gui.session.selection = (left_out,)
    assert left_out in caps(gui)


def test_labels_do_not_cover_each_other():
    room = Room()
    assert room.take((0, 0), (10, 10))
    assert not room.take((5, 5), (15, 15))
    assert room.take((10, 0), (20, 10))


def test_the_first_debug_drawing_shows_something(make_gui):
    gui = make_gui(level=a_level())
    gui.key("f3")
    assert gui.session.view.debug_draw
    assert gui.session.settings.debug_draw
    gui.key("f3")
    gui.session.settings.debug_draw = ["aabbs"]
    gui.key("f3")
    assert gui.session.settings.debug_draw == ["aabbs"]


@pytest.mark.parametrize(("speed", "drive", "way"), [(2.0, 1, 1), (-2.0, 1, -1), (-2.0, -1, 1)])
def test_the_arrow_of_a_motors_drive_points_the_way_it_turns(
    make_gui, monkeypatch, speed, drive, way
):
    level = a_level()
    joint = level.joints[0].replace(motor=Motor(speed=speed))
    session = a_session(level=level.replace(joints=(joint,)), debug_draw=["motors"])
    session.view.debug_draw = True
    gui = make_gui(session=session)
    arrows = []
    monkeypatch.setattr(
        debug_draw, "arrow", lambda draw, start, tip, *_: arrows.append((start, tip))
    )
    gui.key("space")
    simulator = session.playback.simulator
    simulator.state = dataclasses.replace(simulator.state, motor=np.array([drive], np.float32))
    gui.frames(3)
    (x, y), tip = arrows[-1]
    cx, cy = session.camera.to_screen((2.2, 2.0))
    turn = (x - cx) * (tip[1] - y) - (y - cy) * (tip[0] - x)
    assert turn * way < 0  # y points down in the window


def test_thrusters_have_caps_too(make_gui):
    level = a_level()
    alone = level.replace(
        joints=(), thrusters=(Thruster(id=6, body=1, position=(0.0, 0.0), binding=1),)
    )
    gui = make_gui(level=alone)
    assert set(caps(gui)) == {6}


def test_paste_in_the_menu_means_the_place_that_was_clicked(make_gui):
    gui = make_gui(level=a_level())
    gui.session.selection = (3,)
    gui.key("ctrl+c")
    gui.click_world(3.0, 1.5, button=3)
    gui.click("list.edit.paste")
    assert gui.level.bodies[-1].position == pytest.approx((3.0, 1.5), abs=0.03)


def test_a_click_on_a_key_cap_chooses_another_key(make_gui):
    gui = make_gui(level=a_level())
    for entity, choice, value in (
        (5, "2", lambda: gui.level.joints[0].motor.binding),
        (6, "1", lambda: gui.level.thrusters[0].binding),
    ):
        place = caps(gui)[entity]
        gui.click_at((place.low[0] + place.high[0]) / 2, (place.low[1] + place.high[1]) / 2)
        assert gui.session.prompts
        gui.click(f"list.{choice}")
        assert value() == int(choice)


def a_car(board_half_height=0.1):
    """A board with two driven wheels: all that stands near a joint is a shape."""
    board = Polygon(
        vertices=(
            (0.6, board_half_height),
            (-0.6, board_half_height),
            (-0.6, -board_half_height),
            (0.6, -board_half_height),
        )
    )
    wheels = (
        Body(id=2, shape=Circle(radius=0.25), position=(1.2, 0.8)),
        Body(id=3, shape=Circle(radius=0.25), position=(2.0, 0.8)),
    )
    joints = tuple(
        Joint(
            id=wheel.id + 2,
            kind="revolute",
            a=1,
            b=wheel.id,
            anchor_a=(wheel.position[0] - 1.6, wheel.position[1] - 0.9),
            anchor_b=(0.0, 0.0),
            motor=Motor(),
        )
        for wheel in wheels
    )
    bodies = (Body(id=1, shape=board, position=(1.6, 0.9)), *wheels)
    return Level(name="Car", bodies=bodies, joints=joints)


def middle(place):
    return (place.low[0] + place.high[0]) / 2, (place.low[1] + place.high[1]) / 2


@pytest.mark.parametrize("size", [(1024, 640), (1280, 800)])
def test_key_caps_keep_off_shapes_where_there_is_room_beside_them(make_gui, size):
    gui = make_gui(level=a_car(), size=size)
    for place in caps(gui).values():
        for x, y in itertools.product((place.low[0], place.high[0]), (place.low[1], place.high[1])):
            assert not bodies_at(gui.level, gui.session.camera.to_world((x, y)), arena=False)


def test_a_shape_under_a_key_cap_is_selected_and_dragged(make_gui):
    gui = make_gui(level=a_car(board_half_height=1.5))
    board = gui.level.bodies[0]
    place = caps(gui)[4]
    gui.click_at(*middle(place))
    assert not gui.session.prompts
    assert gui.session.selection == (1,)
    gui.session.selection = (4,)
    (x, y) = gui.session.camera.to_world(middle(caps(gui)[4]))
    gui.drag((x, y), (x + 0.5, y))
    assert not gui.session.prompts
    assert gui.level.bodies[0].position[0] > board.position[0] + 0.3
    gui.session.selection = (4,)
    at = middle(caps(gui)[4])
    gui.move(*at)
    gui.button(*at, pressed=True)
    gui.key("delete")
    gui.button(*at, pressed=False)
    gui.frames(2)
    assert not gui.session.prompts and all(joint.id != 4 for joint in gui.level.joints)
    gui.key("ctrl+z")
    gui.session.selection = (4,)
    gui.click_at(*middle(caps(gui)[4]))
    assert gui.session.prompts


@pytest.mark.parametrize(("size", "lines"), [((1440, 900), 5), ((800, 500), 3)])
def test_the_words_of_an_empty_level_stay_on_its_paper(make_gui, monkeypatch, size, lines):
    """In a small window the lines that have no room are left out, none lies over the floor."""
    drawn = []

    class Pen:
        def add_text(self, at, colour, words):
            extent = imgui.calc_text_size(words)
            drawn.append((at, (at[0] + extent.x, at[1] + extent.y)))

    gui = make_gui(level=Level(name="Nothing"), size=size)
    gui.session.settings.language = "de"
    gui.frames(40)
    teach = type(gui.host.ui.workplace.canvas)._teach
    monkeypatch.setattr(
        type(gui.host.ui.workplace.canvas),
        "_teach",
        lambda canvas, draw, camera: teach(canvas, Pen(), camera),
    )
    gui.frames(1)
    left, floor = gui.screen(0.0, FLOOR_TOP)
    right, top = gui.screen(5.0, 5.0)
    assert len(drawn) >= lines
    for low, high in drawn:
        assert left <= low[0] and high[0] <= right and top <= low[1] and high[1] <= floor


def test_a_wait_has_a_card_while_the_level_is_edited(make_gui, monkeypatch):
    drawn = []
    paint = canvas.paint_waiting

    def noted(session, draw, area):
        before = draw.vtx_buffer.size()
        paint(session, draw, area)
        drawn.append(draw.vtx_buffer.size() - before)

    monkeypatch.setattr(canvas, "paint_waiting", noted)
    gui = make_gui(session=a_session())
    gui.frames(2)
    assert not any(drawn)
    job = Job(PlaySolution(level=gui.level), "Playing the solution")
    job.since -= 1.0
    gui.session.expected = job
    gui.frames(2)
    assert all(drawn[-2:])
    gui.key("escape")
    assert gui.session.expected is None and job.cancelled
    assert not drawn[-1]
