"""Layouts: those that come with the app, and those that are kept under a name."""

from pathlib import Path

import pytest

from editor.session import Session
from editor.settings import Settings


def apply(gui, action):
    gui.session.queue(action)
    gui.frames(8)


def height_of_canvas(gui):
    probe = gui.probe("canvas")
    return probe.high[1] - probe.low[1]


def width_of_canvas(gui):
    probe = gui.probe("canvas")
    return probe.high[0] - probe.low[0]


def test_the_apps_own_layouts_differ_and_edit_is_the_first(gui):
    first = gui.probe("canvas")
    apply(gui, "view.layout_evaluate")
    assert height_of_canvas(gui) < 0.8 * (first.high[1] - first.low[1])
    apply(gui, "view.layout_play")
    assert width_of_canvas(gui) > 1.2 * (first.high[0] - first.low[0])
    apply(gui, "view.layout_edit")
    again = gui.probe("canvas")
    assert (again.low, again.high) == (
        pytest.approx(first.low, abs=2),
        pytest.approx(first.high, abs=2),
    )


def test_a_kept_layout_comes_back_in_this_run_and_in_the_next(make_gui, tmp_path: Path):
    gui = make_gui()
    apply(gui, "view.layout_play")
    wide = width_of_canvas(gui)
    apply(gui, "view.keep_layout")
    gui.text("Mine")
    gui.click("line.accept")
    assert "Mine" in gui.session.settings.layouts
    apply(gui, "view.layout_edit")
    narrow = width_of_canvas(gui)
    assert narrow < wide
    gui.session.view.layout = "Mine"
    gui.frames(10)
    assert width_of_canvas(gui) == pytest.approx(wide, abs=2)
    gui.session.settings.save(tmp_path / "settings.json")
    later = make_gui(session=Session(settings=Settings.load(tmp_path / "settings.json")))
    assert width_of_canvas(later) == pytest.approx(narrow, abs=2)
    later.session.view.layout = "Mine"
    later.frames(10)
    assert width_of_canvas(later) == pytest.approx(wide, abs=2)


def test_names_of_the_apps_layouts_are_taken(gui):
    apply(gui, "view.keep_layout")
    gui.text("Play")
    gui.click("line.accept")
    assert gui.session.settings.layouts == {}
    assert "comes with the app" in gui.session.toasts[-1].text


def test_every_layout_has_its_panels_in_front(gui):
    gui.frames(10)
    assert gui.shows("outliner.filter")
    assert gui.shows("level.name")
    assert gui.shows("problems.E101")
    gui.session.queue("view.layout_play")
    gui.frames(20)
    assert gui.session.viewer.timeline_open
    assert gui.shows("agents.choose.a")
    gui.session.queue("view.layout_evaluate")
    gui.frames(20)
    assert gui.shows("evaluate.source")
    assert gui.shows("agents.choose.a")


def test_a_panel_that_needs_room_gets_it_and_gives_it_back(gui):
    gui.frames(30)
    low = height_of_canvas(gui)
    whole = gui.session.camera
    apply(gui, "level.evaluate")
    assert height_of_canvas(gui) < low - 100
    assert gui.session.camera.zoom < whole.zoom  # the arena is still seen whole
    gui.session.view.front = "problems"
    gui.frames(8)
    assert height_of_canvas(gui) == pytest.approx(low, abs=2)
    assert gui.session.camera.zoom == pytest.approx(whole.zoom, rel=0.01)


def test_panels_that_come_back_take_no_room_and_ask_for_nothing(gui):
    gui.frames(35)
    low = height_of_canvas(gui)
    assert gui.shows("problems.E101")
    for hide, back in (("ctrl+g", "escape"), ("tab", "tab")):
        gui.key(hide)
        gui.frames(35)
        gui.key(back)
        gui.frames(35)
        assert gui.shows("problems.E101")
        assert height_of_canvas(gui) == pytest.approx(low, abs=2)


def test_who_has_zoomed_keeps_the_view_when_the_window_changes(gui):
    gui.frames(4)
    gui.host.size = (1000, 700)
    gui.frames(4)
    corner = gui.session.camera.to_screen((5.0, 5.0))
    assert gui.probe("canvas").low[1] < corner[1] < gui.probe("canvas").high[1]
    gui.wheel(*gui.screen(2.5, 2.5), 3)
    zoom = gui.session.camera.zoom
    gui.host.size = (1280, 800)
    gui.frames(4)
    assert gui.session.camera.zoom == zoom
    gui.key("home")
    gui.host.size = (1000, 700)
    gui.frames(4)
    assert gui.session.camera.zoom < zoom
