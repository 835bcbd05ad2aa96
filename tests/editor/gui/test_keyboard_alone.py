"""What can be done without a mouse: shapes are placed, menus are opened."""

import pytest

from kinetix.level.model import Circle, Level
from tests.editor.gui.windows import popup_open


@pytest.fixture
def gui(make_gui):
    return make_gui(level=Level(name="Empty"))


@pytest.mark.parametrize("tool", ["r", "c", "t"])
def test_return_places_a_shape_in_the_middle_of_the_view_and_arrows_move_it(gui, tool):
    gui.key("return")
    assert not gui.level.bodies, "Select places nothing"
    gui.key(tool)
    gui.key("return")
    (body,) = gui.level.bodies
    x, y = gui.session.camera.centre
    assert body.position == pytest.approx((round(x, 1), round(y, 1)))
    assert isinstance(body.shape, Circle) == (tool == "c")
    assert gui.session.selection == (body.id,) and gui.session.tool.id == "select"
    gui.key("left")
    assert gui.level.bodies[0].position[0] < body.position[0]


def test_shapes_that_are_placed_in_a_row_do_not_cover_each_other(gui):
    gui.session.camera = gui.session.camera.panned((-300.0, 0.0))
    gui.key("c")
    gui.key("c")
    for _ in range(3):
        gui.key("enter")
    places = [body.position for body in gui.level.bodies]
    assert len(set(places)) == 3 and gui.session.tool.id == "circle"
    assert places[0][0] > 4.0


def test_f10_opens_the_first_menu_and_arrows_go_through_them(gui):
    gui.session.view.interface = False
    gui.key("f10")
    assert popup_open() and gui.shows("menu.file.new")
    gui.key("right")
    gui.key("down")
    assert gui.shows("menu.edit.undo") and not gui.shows("menu.file.new")
    gui.key("escape")
    assert not popup_open()
    gui.frames(4)
    gui.key("c")
    gui.key("return")
    gui.key("f10")
    for key in ("right", "down", "return"):
        gui.key(key)
    assert not popup_open() and not gui.level.bodies, "undone"
    gui.frames(4)
    gui.key("c")
    gui.key("return")
    (body,) = gui.level.bodies
    gui.key("right")
    assert gui.level.bodies[0].position[0] > body.position[0], "the arrows are the app's again"


def test_a_menu_that_the_mouse_opens_leaves_the_arrows_to_the_app(gui):
    gui.key("c")
    gui.key("return")
    (body,) = gui.level.bodies
    bar = gui.probe("menu.help")
    gui.click("menu.file")
    gui.click("menu.file")
    gui.click_at(bar.centre[0] + 200, bar.centre[1])
    assert not popup_open()
    gui.key("right")
    assert gui.level.bodies[0].position[0] > body.position[0]
