"""The bar at the top: nothing covers anything, however narrow the window and large the scale."""

import itertools

import pytest

from editor.toolkit.appearance import Icons
from editor.window.panels.toolbar import TOOL_ICONS
from tests.editor.core.helpers import a_session

WINDOWS = [
    ((1024, 640), 1.0),
    ((1024, 600), 1.5),
    ((1024, 640), 1.5),
    ((1024, 640), 2.0),
    ((1440, 900), 1.0),
    ((1440, 900), 2.0),
    ((1440, 900), 3.0),
]


def buttons(gui):
    names = ("file.", "edit.", "tool.", "run.", "snap.", "view.grid", "physics")
    return {name: probe for name, probe in gui.session.probe.items() if name.startswith(names)}


def overlap(a, b):
    return (
        a.low[0] < b.high[0] - 1
        and b.low[0] < a.high[0] - 1
        and a.low[1] < b.high[1] - 1
        and b.low[1] < a.high[1] - 1
    )


@pytest.mark.parametrize(("size", "scale"), WINDOWS)
@pytest.mark.parametrize("mode", ["edit", "play", "two physics"])
def test_no_button_covers_another_or_leaves_the_window(make_gui, size, scale, mode):
    gui = make_gui(session=a_session(), size=size, scale=scale)
    if mode == "two physics":
        gui.session.viewer.other_physics = "jax2d"
    if mode == "play":
        gui.key("space")
        assert not gui.session.editing
    gui.frames(4)
    found = buttons(gui)
    wanted = "run.stop" if mode == "play" else "run.play_human"
    assert wanted in found
    for (name, a), (other, b) in itertools.combinations(found.items(), 2):
        assert not overlap(a, b), (name, other)
    for name, a in found.items():
        assert a.low[0] >= 0 and a.high[0] <= size[0], name


def test_what_has_room_has_words(make_gui):
    gui = make_gui(session=a_session(), size=(1440, 900))
    wide = gui.probe("tool.rectangle")
    gui = make_gui(session=a_session(), size=(1024, 640))
    narrow = gui.probe("tool.rectangle")
    assert wide.high[0] - wide.low[0] > 2 * (narrow.high[0] - narrow.low[0])


def test_files_stay_when_snapping_has_no_room(make_gui):
    gui = make_gui(session=a_session(), size=(1024, 600), scale=1.5)
    gui.frames(4)
    assert {"file.new", "file.open", "file.save", "edit.undo", "physics"} <= buttons(gui).keys()


def test_each_tool_has_a_sign_of_its_own():
    assert len(set(TOOL_ICONS.values())) == len(TOOL_ICONS)
    assert Icons.play not in TOOL_ICONS.values()
