"""What the inspector shows besides fields to edit: names, angles, an arena of the level's own."""

import math

import pytest

from editor.settings import Settings
from kinetix.level.model import Arena, ArenaBody, Geometry
from tests.editor.core.helpers import a_level


def type_into(gui, name, words):
    """A double click turns a drag field into a text field."""
    x, y = gui.probe(name).centre
    gui.move(x, y)
    for pressed in (True, False, True, False):
        gui.button(x, y, pressed=pressed)
    gui.frames(2)
    gui.key("ctrl+a")
    gui.text(words)
    gui.key("return")
    gui.frames(2)


@pytest.mark.parametrize(("radians", "angle"), [(False, math.radians(1.5)), (True, 1.5)])
def test_angles_are_typed_in_the_unit_that_is_shown(make_gui, radians, angle):
    gui = make_gui(level=a_level())
    gui.session.settings.radians = radians
    gui.click("outliner.1")
    type_into(gui, "inspector.angle", "1.5")
    assert gui.level.body(1).angle == pytest.approx(angle)


def test_an_arena_of_the_levels_own_is_shown_and_cannot_be_changed(make_gui):
    level = a_level()
    corners = ((-2.0, -0.2), (2.0, -0.2), (2.0, 0.2), (-2.0, 0.2))
    own = ArenaBody(geometry=Geometry(position=(2.5, 0.1), vertices=corners))
    gui = make_gui(level=level.replace(arena=Arena(floor=own)))
    for part, shown in (("floor", True), ("ceiling", False)):
        gui.session.selection = (part,)
        gui.frames(3)
        assert gui.shows("inspector.role.red")
        assert gui.shows("inspector.geometry") is shown


def test_a_thing_is_renamed_by_a_double_click_in_the_outliner(make_gui):
    gui = make_gui(level=a_level())
    x, y = gui.probe("outliner.1").centre
    gui.move(x, y)
    for pressed in (True, False, True, False):
        gui.button(x, y, pressed=pressed)
    gui.frames(4)
    gui.text("Chassis")
    gui.key("return")
    gui.frames(3)
    assert gui.session.document.name_of(1) == "Chassis"
    assert not gui.session.document.dirty


def test_larger_text_makes_rows_higher_and_is_kept(make_gui, tmp_path):
    gui = make_gui(level=a_level())
    before = gui.probe("outliner.1")
    gui.session.settings.text_scale = 1.3
    gui.frames(3)
    after = gui.probe("outliner.1")
    assert after.high[1] - after.low[1] > 1.1 * (before.high[1] - before.low[1])
    gui.session.settings.save(tmp_path / "settings.json")
    assert Settings.load(tmp_path / "settings.json").text_scale == 1.3
