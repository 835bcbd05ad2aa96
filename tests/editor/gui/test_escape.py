"""Esc closes what is in front, and nothing else."""

import pytest

from editor.gallery.export import SetPlan
from tests.editor.core.helpers import a_level
from tests.editor.gui.windows import popup_open


@pytest.fixture
def gui(make_gui):
    gui = make_gui(level=a_level())
    gui.session.selection = (1,)
    gui.frames(2)
    return gui


def test_esc_closes_a_menu_and_keeps_the_selection(gui):
    gui.click("menu.file")
    assert popup_open()
    gui.key("escape")
    assert not popup_open()
    assert gui.session.selection == (1,)
    gui.key("escape")
    assert gui.session.selection == ()


def test_esc_closes_a_menu_with_an_open_submenu(gui):
    gui.click("menu.file")
    gui.move(*gui.probe("menu.examples").centre)
    gui.frames(30)
    assert gui.shows("menu.examples.s")
    gui.key("escape")
    gui.frames(30)
    assert not popup_open()
    assert gui.session.selection == (1,)


def test_esc_in_a_drop_down_of_the_gallery_leaves_the_gallery_open(gui):
    gui.session.queue("level.gallery")
    gui.frames(6)
    gui.click("gallery.sort")
    assert popup_open()
    gui.key("escape")
    assert not popup_open()
    assert gui.session.gallery.open
    gui.key("escape")
    assert not gui.session.gallery.open


def test_esc_in_a_drop_down_of_the_export_keeps_what_was_filled_in(gui):
    gui.session.queue("level.gallery")
    gui.frames(6)
    gui.session.gallery.tray = {"/levels/rocket.json": 1.0}
    gui.session.gallery.plan = SetPlan(name="My set")
    gui.frames(4)
    gui.click("export.form")
    gui.key("escape")
    assert gui.session.gallery.plan == SetPlan(name="My set")
    assert gui.shows("export.form") and not gui.shows("export.form.folder")
    gui.key("escape")
    assert gui.session.gallery.plan is None and gui.session.gallery.open


def test_esc_closes_the_list_under_the_pointer_and_keeps_the_selection(gui):
    gui.click_world(4.0, 3.0, button=3)
    assert popup_open()
    gui.key("escape")
    gui.frames(2)
    assert not popup_open()
    assert not gui.session.prompts
    assert gui.session.selection == (1,)
